"""The benchmark: what it measures against is right, and what it prints is what it found. How fast anything is, no test asserts."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from sweeps import oblique_frames, sphere_bone, turned_grid

from AIFReconLib.commands.benchmark import answer
from AIFReconLib.commands.parser import main
from AIFReconLib.compounding.methods.table import METHODS
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.geometry.transforms import image_plane_axes
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.recipe.recipe import ReconstructionSettings

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from benchmark import commands, speed
from benchmark.numba_yardstick import plain_aif

TESTING = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize("method", ["aif", "aif-compensated"])
def test_the_yardstick_gives_the_voxels_of_the_engines(method):
    frames, grid, bone = oblique_frames(), turned_grid(), sphere_bone()
    probe = ProbeGeometry("sector", (16.0, -6.0))
    reconstructor = Reconstructor(grid, ReconstructionSettings(method=method, output_type="float32", hole_limit=0.0), bone, probe=probe)
    reconstructor.insert(frames)
    placed = bone.on_grid(grid)
    value, weight, hits = np.zeros(grid.shape, np.float32), np.zeros(grid.shape, np.float32), np.zeros(grid.shape, np.uint32)
    for frame in frames:
        rows, columns = frame.image.shape
        x, y = (axis.astype(np.float32) for axis in image_plane_axes(frame.image_to_reference))
        beams = probe.directions(columns, rows, (0.4, 0.7))
        factors = np.float32(0.1), np.float32(0.1), np.float32(255), method == "aif-compensated"
        known = placed.probability, placed.directions_reference
        plain_aif(frame.image, grid.reference_to_ijk @ frame.image_to_reference, x, y, beams, *known, *factors, value, weight, hits)
    np.testing.assert_allclose(reconstructor.finish().intensity.array, value, rtol=1e-6)


def test_everything_is_measured(monkeypatch):
    monkeypatch.setattr(speed, "FILE_FRAMES", 2)
    result = speed.benchmark(2, 1, 4.0, voxels=8000)
    found = {timing.what.split(",")[0] for timing in result.timings}
    assert {"average", "weighted", "hole filling", "bone map from labels", "bone map onto a grid", "reading"} <= found


def test_commands_are_timed_with_nothing_compiled_and_after(monkeypatch):
    monkeypatch.setattr(commands, "FRAMES", 9)
    monkeypatch.setattr(commands, "LEAST_OF", 1)
    rows = commands.measure(None, ("--help", "info"))
    assert [name for name, *_ in rows] == ["`--help`", "`info`"]
    assert all(0.01 < seconds < 600 for _, *row in rows for seconds in row)
    assert commands.markdown(rows).count("\n") == 3


def test_a_command_that_fails_has_no_time(tmp_path):
    with pytest.raises(subprocess.CalledProcessError):
        commands.timed(["info", str(tmp_path / "none.mha")], tmp_path)


def test_what_a_process_takes_is_told():
    """In a process of its own: what starts another counts as much as itself takes."""
    program = "import sys, time; held = bytes([1]) * 500_000_000; time.sleep(0.1)"
    program = f"from benchmark import spine; import sys; print(*spine.taken_by([sys.executable, '-c', {program!r}]).values())"
    told = subprocess.run([sys.executable, "-c", program], cwd=TESTING, capture_output=True, text=True, check=True).stdout
    seconds, _, peak = map(float, told.split())
    assert seconds > 0.1
    # Other systems count in other units
    assert sys.platform != "linux" or 0.5 < peak < 0.7


SMALL = ("--size", "64", "48", "--frames", "2", "--repeats", "1", "--spacing", "4")


def test_the_command_answers_for_every_method(tmp_path, capsys):
    path = tmp_path / "b.json"
    assert main(["benchmark", *SMALL, "--json", str(path)]) == 0
    out, found = capsys.readouterr().out, json.loads(path.read_text())
    assert [method for method in METHODS if method not in out] == []
    assert "At 30 frames/s of 64 x 48 pixels, this machine " in out
    assert list(found["methods"]) == list(METHODS)
    assert all(of["frames_per_second"] * of["seconds_per_frame"] == pytest.approx(1) for of in found["methods"].values())


def test_the_answer_names_the_methods_of_each_kind_and_half_of_the_time_must_be_left():
    text = answer({"average": 0.2, "latest": 0.5, "aif": 0.8, "weighted": 1.01}, (640, 480), 30.0)
    assert "this machine keeps up with average, latest; just keeps up with aif; does not keep up with weighted." in text


def test_the_benchmarks_start_from_their_folder():
    folder = TESTING / "benchmark"
    done = subprocess.run([sys.executable, folder, "live", "--help"], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout.startswith("usage: python Testing/benchmark")) == (0, True), done.stderr
