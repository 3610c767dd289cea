"""Options that no other test gives: each changes what the command prints or writes. That every option is given by a test is looked at."""

from __future__ import annotations

import re
import shlex
import socket
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from AIFReconLib.commands.parser import COMMANDS, main, options_of
from AIFReconLib.recipe.recipe import RULES
from AIFReconLib.terminal.arguments import declared, spelling
from AIFReconLib.workflows.simulate import write_simulated_patient

TESTS = Path(__file__).resolve().parents[2]

BONE = "--bone-labels {labels} --bone-transform {place}"
SWEEP = "{sweep} --config {config}"
IMPORT = "import {folder}/frames.npy --transform ImageToTracker --spacing 1 1 --sure --quiet --output {out}/s.igs.mha"

OPTIONS = {
    "simulate --frames 9 --quiet --output {out}/p": (
        *("--seed 3", "--path freehand", "--gain 6", "--depth-gain 6", "--gray-curve 1.5"),
        *("--breathing 2", "--shifting 2", "--step 3"),
    ),
    f"reconstruct {SWEEP} --spacing 3 --output {{out}}/v.dcm": ("--dicom-study {folder}/study.dcm",),
    "bone-map {folder}/L3.stl --bone-space ras --quiet --output {out}/p.nrrd": ("--bone-space lps", "--bone-unit cm"),
    "start-calibration --depth 60 40 440 --face-px 9 9 --face-mm 4 0 -118 --right x --down=-z --output {out}/c.xml": ("--pixel 0.2",),
    f"register {SWEEP} {BONE} --output {{out}}/t.tfm": ("--per-segment",),
    f"register {SWEEP} --bone-labels {{stranger}} --output {{out}}/t.tfm": ("--accept",),
    f"coverage {SWEEP} {BONE} --report {{out}}/c.json": ("--beam-thickness 9",),
    f"evaluate {{folder}}/volume.nrrd --sweep {SWEEP} {BONE}": ("--beam-thickness 9",),
    "evaluate {folder}/results.csv": ("--against weighted",),
    f"plan {BONE} --frames 20 --output {{out}}/p.json": ("--candidates wearable", f"--probe-like {SWEEP}"),
    f"paths {{folder}}/volume.nrrd --target L2-L3 --sweep {SWEEP} {BONE} --output {{out}}/p.mrk.json": (
        "--margin 4",
        "--skin-map {out}/s.vtp",
    ),
    f"{IMPORT} --poses {{folder}}/poses.txt --columns 'time x y z q q q q'": ("--quaternion-order wxyz", "--time-unit ms"),
    f"{IMPORT} --poses {{folder}}/matrices.txt": ("--column-major",),
    f"{IMPORT} --poses {{folder}}/matrices.txt --calibration {{folder}}/ImageToProbe.txt": ("--calibration-unit cm",),
}
"""By a command, options of which each makes it do something else."""


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
    corners = np.array([(0, 0, 0), (30, 0, 0), (0, 20, 0), (0, 0, 25)])
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners[list(each)]) + "endloop\nendfacet\n"
        for each in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
    )
    (folder / "L3.stl").write_text(f"solid L3\n{facets}endsolid L3\n")
    rows = (f"P{n},{method},{cnr + n / 10}" for n in range(5) for method, cnr in (("average", 1.0), ("weighted", 3.0)))
    (folder / "results.csv").write_text("\n".join(["case,method,bone_cnr", *rows]) + "\n")
    np.save(folder / "frames.npy", np.random.default_rng(0).integers(0, 255, (8, 24, 32), np.uint8))
    turned = np.array([(0, -1, 0), (1, 0, 0), (0, 0, 1)])
    poses = [np.block([[turned, np.array([[x], [2 * x], [3.0]])], [np.zeros((1, 3)), np.ones((1, 1))]]) for x in np.linspace(0, 20, 8)]
    (folder / "matrices.txt").write_text("".join(" ".join(f"{each:g}" for each in pose.ravel()) + "\n" for pose in poses))
    (folder / "poses.txt").write_text("".join(f"{n / 10:g} {n} {2 * n} 3 0.6 0 0 0.8\n" for n in range(8)))
    (folder / "ImageToProbe.txt").write_text("1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n")
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
    assert before == (1 if option == "--accept" else 0), said
    assert written != there or printed != said
