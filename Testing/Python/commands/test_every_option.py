"""Options that no other test gives: each changes what the command prints or writes. That every option is given by a test is looked at."""

from __future__ import annotations

import re
import shlex
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import AIFReconLib
from AIFReconLib.commands.parser import COMMANDS, main, options_of
from AIFReconLib.recipe.recipe import RULES
from AIFReconLib.terminal.arguments import declared, spelling
from AIFReconLib.workflows.simulate import write_simulated_patient

TESTS = Path(__file__).resolve().parents[2]

BONE = "--bone-labels {labels} --bone-transform {place}"
SWEEP = "{sweep} --config {config}"
IMPORT = "import {folder}/frames.npy --transform ImageToTracker --spacing 1 1 --rate 10 --sure --quiet --output {out}/s.igs.mha"

OPTIONS = {
    "simulate --frames 9 --quiet --output {out}/p": (
        *("--seed 3", "--path freehand", "--gain 6", "--depth-gain 6", "--gray-curve 1.5"),
        *("--breathing 2", "--shifting 2", "--step 3"),
    ),
    f"reconstruct {SWEEP} --spacing 3 --output {{out}}/v.dcm": ("--dicom-study {folder}/study.dcm", "--score {out}/s.nrrd"),
    "bone-map {folder}/L3.obj --bone-space ras --quiet --output {out}/p.nrrd": ("--bone-space lps", "--bone-unit cm"),
    f"register {SWEEP} {BONE} --output {{out}}/t.tfm": ("--per-segment",),
    f"register {SWEEP} --bone-labels {{stranger}} --output {{out}}/t.tfm": ("--accept",),
    f"coverage {SWEEP} {BONE} --report {{out}}/c.json": ("--beam-thickness 9",),
    f"evaluate {{folder}}/volume.nrrd --sweep {SWEEP} {BONE}": ("--beam-thickness 9",),
    "evaluate {folder}/results.csv": ("--against weighted",),
    f"plan {BONE} --frames 25 --output {{out}}/p.json": ("--candidates wearable", f"--probe-like {SWEEP}"),
    f"paths {{folder}}/volume.nrrd --target 1-2 --sweep {SWEEP} {BONE} --output {{out}}/p.mrk.json": (
        "--margin 4",
        "--skin-map {out}/s.vtp",
    ),
    f"{IMPORT} --poses {{folder}}/poses.txt --quaternion-order xyzw": ("--quaternion-order wxyz", "--time-unit ms"),
    f"{IMPORT} --poses {{folder}}/columns.txt": ("--column-major",),
    f"{IMPORT} --transform ProbeToTracker --poses {{folder}}/matrices.txt --calibration {{folder}}/Image.txt": ("--calibration-unit cm",),
}
"""By a command, options of which each makes it do something else."""


REFUSED = {"--accept": 1, "--column-major": 2}
"""Exit codes without an option, where it is what lets the command go on."""


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """What the commands read, and what they printed and wrote without the option, by their words."""
    folder = tmp_path_factory.mktemp("files")
    patient = write_simulated_patient(folder / "patient", 0, "multi-angle", 72)
    stranger = write_simulated_patient(folder / "stranger", 5, "multi-angle", 9)
    words = {"sweep": patient.sequence, "config": patient.configuration, "labels": patient.labels, "place": patient.ct_to_reference}
    given = {"folder": folder, "stranger": stranger.labels, **words}
    made = f"reconstruct {SWEEP} {BONE} --spacing 2 --quiet --output {{folder}}/"
    assert run(f"{made}volume.nrrd", given)[0] == run(f"{made}study.dcm", given)[0] == 0
    (folder / "L3.obj").write_text("v 0 0 0\nv 30 0 0\nv 0 20 0\nv 0 0 25\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    rows = (f"P{n},{method},{cnr + n / 10},0.5,1000,bone,v.nrrd" for n in range(5) for method, cnr in (("average", 1.0), ("weighted", 3.0)))
    (folder / "results.csv").write_text("\n".join(["case,method,bone_cnr,bone_coverage,bone_area,yardstick,volume", *rows]) + "\n")
    np.save(folder / "frames.npy", np.random.default_rng(0).integers(0, 255, (8, 24, 32), np.uint8))
    turned = np.array([(0, -1, 0), (1, 0, 0), (0, 0, 1)])
    poses = [np.block([[turned, np.array([[x], [2 * x], [3.0]])], [np.zeros((1, 3)), np.ones((1, 1))]]) for x in np.linspace(0, 20, 8)]
    for name, matrices in (("matrices.txt", poses), ("columns.txt", [pose.T for pose in poses])):
        (folder / name).write_text("".join(" ".join(f"{each:g}" for each in pose.ravel()) + "\n" for pose in matrices))
    (folder / "poses.txt").write_text("time x y z q0 q1 q2 q3\n" + "".join(f"{n / 10:g} {n} {2 * n} 3 0.6 0 0 0.8\n" for n in range(8)))
    (folder / "Image.txt").write_text("1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n")
    return SimpleNamespace(given=given, plain={})


def run(words: str, given: dict) -> tuple:
    """The exit code of a command."""
    return (main(shlex.split(words.format(**given))),)


def outcome(words: str, given: dict, out: Path, capsys) -> tuple:
    """What a command answers, prints and writes; the name of its folder does not count."""
    out.mkdir()
    code = main(shlex.split(words.format(out=out, **given)))
    printed = "".join(capsys.readouterr()).replace(str(out), "")
    return code, printed, {path.relative_to(out): path.read_bytes() for path in sorted(out.rglob("*")) if path.is_file()}


@pytest.mark.parametrize(("command", "option"), [(command, option) for command, options in OPTIONS.items() for option in options])
def test_an_option_makes_a_difference(command, option, files, tmp_path, capsys):
    if command not in files.plain:
        files.plain[command] = outcome(command, files.given, tmp_path / "plain", capsys)
    code, printed, written = outcome(f"{command} {option}", files.given, tmp_path / "other", capsys)
    before, said, there = files.plain[command]
    assert code == 0, printed
    assert before == REFUSED.get(option, 0), said
    assert written != there or printed != said


def test_every_option_and_every_public_name_is_used_by_a_test():
    others = (path for name in ("Python", "Slicer") for path in (TESTS / name).rglob("*.py") if "house" not in path.parts)
    words = set(re.findall(r"[\w-]+", "\n".join(path.read_text("utf-8") for path in others)))
    unused = [
        f"{command} {spelled[-1]}"
        for command in COMMANDS
        for name, spelled in ((each.name, spelling(options_of(command), each.name)) for each in declared(options_of(command)))
        # Settings are tried by test_every_setting
        if name not in (*RULES, *options_of(command).WORDS) and not words & set(spelled)
    ]
    assert unused + [name for name in AIFReconLib.__all__ if name not in words] == []
