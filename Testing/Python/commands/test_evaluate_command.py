"""`aifrecon evaluate` as a user meets it."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from files import write_patient

from AIFReconLib import __version__
from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.volume import Volume, VoxelGrid
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.provenance.record import INPUTS, METHOD, SETTINGS, VERSION, unlike_inputs


@pytest.fixture
def case(tmp_path):
    """A patient with a ball of bone, and two volumes: one with a bright shell on it, one of noise alone."""
    patient = write_patient(tmp_path)
    grid = VoxelGrid.from_spacing((-12, -12, -12), (49, 49, 49), 0.5)
    k, j, i = np.indices(grid.shape)
    radius = np.sqrt(((np.stack([i, j, k]) - 24) ** 2).sum(axis=0)) * 0.5
    noise = np.random.default_rng(0).normal(50, 5, grid.shape)
    shell = noise + 150 * np.exp(-(((radius - 4.0) / 0.8) ** 2))
    for name, gray in (("shell", shell), ("noise", noise)):
        Volume(gray.astype(np.float32), grid.ijk_to_reference).write(tmp_path / f"{name}.nrrd")
    return patient


def command(case, *volumes, sweep=True, extra=()):
    folder = case.sweep.parent
    arguments = ["evaluate", *(folder / f"{name}.nrrd" for name in volumes), "--bone", case.labels, "--bone-transform", case.transform]
    if sweep:
        arguments += ["--sweep", case.sweep, "--config", case.config]
    return [str(argument) for argument in [*arguments, *extra]]


def rows_of(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_csv_holds_every_number_of_every_volume_and_whether_a_sweep_tells_which_bone_counts(case, tmp_path, capsys):
    output = tmp_path / "metrics.csv"
    assert main(command(case, "shell", "noise", extra=["--csv", output])) == 0
    shell, noise = rows_of(output)
    assert (shell["volume"], shell["reachability"]) == ("shell.nrrd", "sweep")
    assert float(shell["bone_coverage"]) > 0.9
    assert float(noise["bone_coverage"]) < 0.1
    assert float(shell["bone_cnr"]) > 5 * float(noise["bone_cnr"])
    assert abs(float(shell["bone_localization_bias"])) < 0.3, "the ball lies where its registration puts it"
    area = float(shell["bone_area"])
    assert main(command(case, "shell", sweep=False, extra=["--csv", output])) == 0
    assert "whether a beam met it or not. Give --sweep" in capsys.readouterr().out
    (row,) = rows_of(output)
    assert (row["reachability"], row["oblique_coverage"]) == ("unknown", "")
    assert area < float(row["bone_area"]) == pytest.approx(4 * np.pi * 16, rel=0.15), "with a sweep less bone counts"


def test_a_mask_decides_what_was_measured(case, tmp_path, capsys):
    grid = VoxelGrid.from_spacing((-12, -12, -12), (49, 49, 49), 0.5)
    Volume(np.zeros(grid.shape, dtype=np.uint8), grid.ijk_to_reference).write(tmp_path / "mask.nrrd")
    assert main(command(case, "shell", extra=["--mask", tmp_path / "mask.nrrd"])) == 0
    assert " 0.0% " in capsys.readouterr().out


def test_the_report_says_how_a_volume_was_made_and_of_which_it_is_not_known(case, tmp_path):
    page, shell, noise = tmp_path / "report.html", tmp_path / "shell.nrrd", tmp_path / "noise.nrrd"
    replace(read_volume(shell), fields={SETTINGS: '{"method": "aif", "alpha": 0.37}', VERSION: __version__}).write(shell)
    replace(read_volume(noise), fields={SETTINGS: '{"alpha": "many"'}).write(noise)
    assert main(command(case, "shell", "noise", extra=["--report", page])) == 0
    html = page.read_text("utf-8")
    assert "<td>0.37</td>" in html
    assert "Not known of noise.nrrd" in html
    for name in ("shell.nrrd", case.sweep.name, case.config.name, case.labels.name, case.transform.name, "6 frames"):
        assert name in html
    assert str(tmp_path) not in html


def of_cases(tmp_path, count):
    """Tables as this command writes them, of cases whose numbers differ."""
    for case in range(count):
        rows = [f"average.nrrd,sweep,{case}.5", f"weighted.nrrd,sweep,{2 * case}.75"]
        (tmp_path / f"P{case}").mkdir(parents=True)
        (tmp_path / f"P{case}" / "m.csv").write_text("\n".join(["volume,reachability,bone_cnr", *rows]) + "\n", "utf-8")
    return [str(tmp_path / f"P{case}" / "m.csv") for case in range(count)]


def test_tables_of_many_cases_give_means_and_paired_differences(tmp_path, capsys):
    outputs = ["--csv", str(tmp_path / "s.csv"), "--methods", str(tmp_path / "m.txt")]
    assert main(["evaluate", *of_cases(tmp_path, 5), *outputs]) == 0
    said = capsys.readouterr().out
    assert "5 cases: mean \N{PLUS-MINUS SIGN} standard deviation" in said
    assert "minus average.nrrd: mean of paired differences [95% confidence interval, bootstrap over cases]" in said
    assert "Of fewer than 10 cases such intervals are too narrow" in said
    [row] = [row for row in rows_of(tmp_path / "s.csv") if row["volume"] == "weighted.nrrd" and row["quantity"] == "bone_cnr"]
    assert (row["cases"], row["mean"], row["mean_difference"]) == ("5", "4.75", "2.25")
    assert "over 5 cases" in (tmp_path / "m.txt").read_text("utf-8")
    assert main(["evaluate", *of_cases(tmp_path / "few", 3)]) == 0
    said = capsys.readouterr().out
    assert "of fewer than 5 there is none" in said
    assert "[+" not in said


def test_a_volume_that_its_yardstick_weighted_is_told(case, tmp_path, capsys):
    inputs = f'[{{"name": "{case.labels.name}", "bytes": {case.labels.stat().st_size}}}]'
    for name, method in (("shell", "weighted"), ("noise", "average")):
        volume = read_volume(tmp_path / f"{name}.nrrd")
        replace(volume, fields={METHOD: method, INPUTS: inputs}).write(tmp_path / f"{name}.nrrd")
    assert main(command(case, "shell", "noise", extra=["--methods", tmp_path / "m.txt"])) == 0
    assert "Weighted by the bone that is also the yardstick: shell.nrrd. What is wrong" in capsys.readouterr().out
    assert "The bone that shell.nrrd was measured against had weighted its frames." in (tmp_path / "m.txt").read_text("utf-8")


def test_files_of_another_patient_and_a_place_that_is_left_out_are_told(case, tmp_path, capsys):
    def named(labels, size, *places, more=0):
        inputs = [{"name": labels.name, "bytes": size}, *({"name": place.name, "bytes": place.stat().st_size + more} for place in places)]
        shell = read_volume(tmp_path / "shell.nrrd")
        replace(shell, fields={METHOD: "weighted", SETTINGS: "{}", INPUTS: json.dumps(inputs)}).write(tmp_path / "made.nrrd")

    placed = ["evaluate", str(tmp_path / "made.nrrd"), "--bone", str(case.labels), "--bone-transform", str(case.transform)]
    size = case.labels.stat().st_size
    named(case.labels, size, case.transform)
    assert main(placed) == 0
    assert "WARNING" not in capsys.readouterr().out
    (doubt,) = unlike_inputs({"made.nrrd": read_volume(tmp_path / "made.nrrd").fields}, [case.labels, None])
    place, told = case.transform.stat().st_size, "which places the CT, and it is not given now."
    assert doubt == f"WARNING: made.nrrd was made with {case.transform.name} ({place} bytes), {told}"
    named(case.labels, size, case.transform, more=1)
    assert main(placed) == 0
    assert f"made with {case.transform.name} ({place + 1} bytes), {told}" in capsys.readouterr().out
    named(case.labels, size + 1, case.transform)
    assert main(placed) == 0
    assert f"WARNING: made.nrrd was made from another {case.labels.name} than is given." in capsys.readouterr().out
