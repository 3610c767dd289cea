"""`aifrecon start-calibration`: a first calibration by a ruler."""

from __future__ import annotations

import numpy as np
import pytest

from AIFReconLib.calibration.measured import measured_calibration
from AIFReconLib.commands.parser import main
from AIFReconLib.geometry.transform_graph import TransformName
from AIFReconLib.geometry.transforms import pixel_spacing
from AIFReconLib.io.plus.calibration import write_calibrated
from AIFReconLib.io.plus.configuration import read_plus_configuration

GIVEN = ["--depth", "60", "40", "440", "--face-px", "320", "38", "--face-mm", "4", "0", "-118", "--right", "x", "--down=-z"]


@pytest.mark.parametrize(("right", "down"), [("x", "-z"), ("-y", "x"), ("+z", "y"), ("-x", "-y")])
def test_columns_and_rows_run_along_the_axes_that_are_named_from_the_face(right, down):
    matrix = measured_calibration(0.2, (300.0, 40.0), (4.0, 5.0, -118.0), right, down)
    np.testing.assert_allclose(matrix @ (300.0, 40.0, 0.0, 1.0), (4.0, 5.0, -118.0, 1.0))
    moved = matrix @ np.array([[310.0, 300.0], [40.0, 50.0], [0.0, 0.0], [1.0, 1.0]])
    for axis, point in zip((right, down), moved.T, strict=True):
        step = point[:3] - (4.0, 5.0, -118.0)
        assert step["xyz".index(axis[-1])] == pytest.approx(-2.0 if axis[0] == "-" else 2.0)
        assert np.count_nonzero(np.abs(step) > 1e-9) == 1
    assert np.linalg.det(matrix[:3, :3]) == pytest.approx(0.2**3)


def test_a_direction_between_axes_is_given_by_numbers():
    matrix = measured_calibration(0.2, (0.0, 0.0), (0.0, 0.0, 0.0), "0.9,0,-0.4", "0.1,1,0")
    np.testing.assert_allclose(matrix[:3, 0], 0.2 * np.array([0.9, 0.0, -0.4]) / np.hypot(0.9, 0.4))
    np.testing.assert_allclose(matrix[:3, :3].T @ matrix[:3, :3], 0.04 * np.eye(3), atol=1e-12)
    assert matrix[1, 1] > 0.19


def test_it_is_a_configuration_that_every_command_reads(tmp_path, capsys):
    path = tmp_path / "Probe.xml"
    assert main(["start-calibration", *GIVEN, "--tool", "stylus", "--output", str(path)]) == 0
    matrix = read_plus_configuration(path).transforms[TransformName("Image", "Stylus")].matrix
    np.testing.assert_allclose(pixel_spacing(matrix), 0.15)
    assert f"--config {path}" in capsys.readouterr().out
    assert read_plus_configuration(path).rough == (TransformName("Image", "Stylus"),)
    assert "ImageToStylus was measured by hand" in read_plus_configuration(path).warnings[-1]
    write_calibrated(path, path.with_name("exact.xml"), TransformName("Image", "Stylus"), matrix, "a test")
    assert read_plus_configuration(path.with_name("exact.xml")).rough == ()
