"""Bone that a network's predictions show: frames of an oblique sweep over a plane that is known."""

from __future__ import annotations

import numpy as np
import pytest
from files import refused, write_patient_with_bone
from seen_planes import IMAGING, PlaneSweep, as_sequence

from AIFReconLib.bone.echoes.surface import bone_from_sweep
from AIFReconLib.bone.map import BoneMap
from AIFReconLib.bone.predicted_bone import EchoEstimator, PointsOfFrames, bone_from_frames
from AIFReconLib.bone.predictions import Prediction
from AIFReconLib.bone.recorded_predictions import RecordedPredictions
from AIFReconLib.commands.parser import main
from AIFReconLib.effective_settings import imaging_fields
from AIFReconLib.errors import GeometryError, SequenceFormatError
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.io.sequence.writer import write_sequence
from AIFReconLib.io.volume.files import read_volume
from AIFReconLib.recipe.recipe import Recipe, ReconstructionSettings
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.sweep.frames import TrackedFrame

SWEEP = PlaneSweep()


def bone_of(predictions, rectangle=None, times=None, sweep=SWEEP) -> BoneMap:
    said = RecordedPredictions(sweep.sequence, as_sequence(predictions, times), rectangle)
    return bone_from_frames(sweep.sequence, said, sweep.swept, IMAGING)


@pytest.fixture(scope="module")
def known() -> BoneMap:
    return bone_of(SWEEP.predictions())


def placed(bone, points):
    """Probability and direction at points in Reference."""
    grid = VoxelGrid.from_spacing(points.min(axis=0) - 1, np.ceil(np.ptp(points, axis=0) / 0.5).astype(int) + 5, 0.5)
    on_grid = bone.on_grid(grid)
    i, j, k = np.rint(transform_points(grid.reference_to_ijk, points)).astype(int).T
    return on_grid.probability[k, j, i], on_grid.directions_reference[k, j, i]


# Points of predictions


@pytest.mark.parametrize("spacing", [(0.5, 0.5), (0.3, 0.45), (0.6, 0.25)])
def test_points_of_predictions_lie_on_bone_in_the_middle_of_what_is_said(spacing):
    """Pixels that are wider than high, or higher than wide, in oblique frames."""
    sweep = PlaneSweep(spacing=spacing)
    points, said = PointsOfFrames(IMAGING), sweep.predictions()
    for number, pose in enumerate(sweep.poses):
        found = points.of(TrackedFrame(sweep.images[number], pose, number=number), Prediction(said[number]))
        assert len(found) > 20
        # The stretch that is said has its ends on whole pixels
        np.testing.assert_allclose((found.points - sweep.point) @ sweep.normal, 0.0, atol=0.5 * spacing[1])
        np.testing.assert_allclose(found.beams, np.tile(pose[:3, 1] / np.linalg.norm(pose[:3, 1]), (len(found), 1)), atol=1e-9)
        assert (found.frames == number).all()


def test_of_two_places_on_a_line_the_surer_counts_and_none_below_one_half():
    said = np.zeros((80, 60), np.float32)
    said[20:24, :30], said[50:54, :30], said[30:34, 30:] = 0.6, 0.9, 0.49
    found = PointsOfFrames(IMAGING).of(TrackedFrame(SWEEP.images[0], np.diag([0.5, 0.5, 0.5, 1.0])), Prediction(said))
    assert set(found.scores.round(3)) == {np.float32(0.9)}
    np.testing.assert_allclose(found.points[:-1, 1], 0.5 * 51.5, atol=0.1)
    assert found.points[:, 0].max() < 15.5


# The map


def test_the_ridge_lies_where_bone_is_to_half_a_millimeter(known):
    depths = np.arange(-5.0, 5.1, 0.5)
    profile = np.array([np.median(placed(known, SWEEP.on_plane(depth))[0]) for depth in depths])
    assert placed(known, SWEEP.on_plane())[0].min() > 0.7
    assert (depths * profile).sum() / profile.sum() == pytest.approx(0.0, abs=0.5)


@pytest.mark.parametrize("depth", [-1.5, 0.0, 1.5])
def test_bone_faces_away_from_the_sound_before_its_ridge_on_it_and_behind(known, depth):
    assert (placed(known, SWEEP.on_plane(depth))[1] @ SWEEP.normal).min() > 0.9


def test_frames_in_the_dark_do_not_speak_against_those_that_see():
    """Every second frame of the first half has lost contact and sees nothing: there bone is as probable as in the second half."""
    sweep = PlaneSweep(count=16, turn=0.0)
    said = sweep.predictions()
    said[:8:2] = 0.0
    sweep.images[:8:2] = np.random.default_rng(1).integers(0, 2, sweep.images[:8:2].shape)
    points = sweep.on_plane()
    first = (points - sweep.point) @ sweep.poses[0, :3, 2] < 0
    probability = placed(bone_of(said, sweep=sweep), points)[0]
    assert np.median(probability[first]) > 0.9 * np.median(probability[~first])


def test_gaps_between_frames_are_closed():
    sweep = PlaneSweep(count=5, turn=0.0)
    apart = sweep.poses.copy()
    apart[:, :3, 3] += 3.0 * (np.arange(5) - 2)[:, None] * (apart[0, :3, 2] / np.linalg.norm(apart[0, :3, 2]))
    sweep.poses[:] = apart
    sweep.__dict__["sequence"] = type(sweep.sequence).from_arrays(sweep.images, apart)
    assert placed(bone_of(sweep.predictions(), sweep=sweep), sweep.on_plane())[0].min() > 0.5


def test_frames_that_say_nothing_make_no_map():
    with pytest.raises(GeometryError, match="no frame shows bone"):
        bone_of(0 * SWEEP.predictions())


def test_the_rule_for_echoes_is_an_estimator_that_finds_what_a_sweep_shows():
    imaging = IMAGING.judging(SWEEP.sequence.images, None)
    bone = bone_from_frames(SWEEP.sequence, EchoEstimator(imaging), SWEEP.swept, imaging)
    whole = bone_from_sweep(SWEEP.sequence, Recipe(**imaging_fields(IMAGING.region, IMAGING.probe)))
    np.testing.assert_array_equal(bone.probability.array, whole.probability.array)
    assert np.median(placed(bone, SWEEP.on_plane())[0]) > 0.7


# Predictions beside the frames


@pytest.mark.parametrize(
    ("columns", "rows", "rectangle"),
    [
        (30, 40, (0.0, 0.0, 60.0, 80.0)),
        (90, 64, (0.0, 0.0, 60.0, 80.0)),
        (50, 60, (5.0, 12.0, 50.0, 60.0)),
        (25, 40, (5.0, 0.0, 50.0, 80.0)),
    ],
)
def test_predictions_of_another_size_lie_where_their_rectangle_does(known, columns, rows, rectangle):
    bone = bone_of(SWEEP.predictions(columns=columns, rows=rows, rectangle=rectangle), rectangle)
    points = SWEEP.on_plane()
    np.testing.assert_allclose(placed(bone, points)[0], placed(known, points)[0], atol=0.15)


def test_predictions_are_matched_by_time_whatever_their_order_and_missing_ones_are_counted(known):
    order = np.random.default_rng(3).permutation(12)
    said = bone_of(SWEEP.predictions()[order], times=5.0 + 0.1 * order)
    np.testing.assert_array_equal(said.probability.array, known.probability.array)
    assert "12 of 12 frames, matched by time" in said.notes[0]
    few = bone_of((255 * SWEEP.predictions()[2:]).astype(np.uint8), times=5.0 + 0.1 * np.arange(2, 12))
    assert "10 of 12 frames" in few.notes[0]
    assert "2 of 12 frames" in few.notes[1]


def test_a_missing_prediction_is_no_word_against_bone(known):
    """Frames without one take no part: the rest says of the surface what all said."""
    bone = bone_of(SWEEP.predictions()[::2], times=5.0 + 0.1 * np.arange(0, 12, 2))
    points = SWEEP.on_plane()
    np.testing.assert_allclose(placed(bone, points)[0], placed(known, points)[0], atol=0.2)


def test_an_estimator_may_have_nothing_to_say():
    class Silent:
        def estimate(self, frame):
            return None if frame.number else Prediction(SWEEP.predictions()[0])

        def notes(self):
            return ()

    assert "11 of 12 frames" in bone_from_frames(SWEEP.sequence, Silent(), SWEEP.swept, IMAGING).notes[-1]


def altered(change):
    said = SWEEP.predictions()
    change(said)
    return said


@pytest.mark.parametrize(
    ("predictions", "times", "rectangle", "error", "words"),
    [
        (SWEEP.predictions()[:, ::2], None, None, GeometryError, r"60 x 40 pixels do not fit frames of 60 x 80"),
        (SWEEP.predictions()[:7], None, None, GeometryError, "7 predictions for 12 frames"),
        (SWEEP.predictions()[:7], 100.0 + np.arange(7), None, GeometryError, "7 predictions for 12 frames"),
        (altered(lambda said: said.__setitem__((3, 5, 5), np.nan)), None, None, SequenceFormatError, "frame 3: .* got NaN"),
        (9 * SWEEP.predictions() - 4, None, None, SequenceFormatError, "got -4 to 5. Pass logits through a sigmoid"),
        (SWEEP.predictions().astype(np.uint16), None, None, SequenceFormatError, "8 bit, 0 to 255, or floating point, 0 to 1; got uint16"),
        (SWEEP.predictions(), None, (0.0, 0.0, 60.0, 0.0), GeometryError, "W and H above 0"),
    ],
)
def test_what_are_no_predictions_of_these_frames_is_refused(predictions, times, rectangle, error, words):
    with pytest.raises(error, match=words):
        bone_of(predictions, rectangle, times)


def test_of_several_sweeps_each_has_its_own():
    said = RecordedPredictions([SWEEP.sequence] * 2, [as_sequence(0 * SWEEP.predictions()), as_sequence(SWEEP.predictions())])
    frames = [type("Frame", (), {"number": number})() for number in (3, 15)]
    assert [float(said.estimate(frame).probability.max()) for frame in frames] == [0.0, 1.0]


# The command line


@pytest.fixture
def patient(tmp_path):
    return write_patient_with_bone(tmp_path / "inputs")


def predicted(patient, columns=40, rows=30, least=0):
    said = np.zeros((6, rows, columns), np.uint8)
    said[:, rows * 18 // 30 : rows * 21 // 30] = 255
    path = patient.sweep.with_name("bone.mha")
    write_sequence(as_sequence(said[least:], [record.timestamp for record in patient.sequence.records][least:]), path)
    return path


def test_the_command_gives_what_the_library_gives_and_says_what_it_matched(patient, tmp_path, capsys):
    path = predicted(patient, least=2)
    assert main([*patient.reconstruct, "--engine", "numpy", "--bone-frames", str(path), "--output", str(tmp_path / "v.nrrd")]) == 0
    sequence = read_sequence(patient.sweep, config=patient.config)
    bone = bone_from_frames(sequence, RecordedPredictions(sequence, read_sequence(path)))
    expected = reconstruct(sequence, ReconstructionSettings(method="weighted", engine="numpy"), bone)
    np.testing.assert_array_equal(read_volume(tmp_path / "v.nrrd").array, expected.intensity.array)
    assert "bone is predicted for 4 of 6 frames, matched by time" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (["--bone-frames-px", "0", "0", "9", "9"], "Give --bone-frames"),
        (["--bone-frames", "SAID", "--bone-from-sweep"], "not allowed with"),
        (["--bone-from-sweep", "--bone-labels", "L.nrrd"], "--bone-labels: not allowed with argument --bone-from-sweep"),
        (["--bone-from-sweep", "--bone-probability", "P.nrrd"], "--bone-probability: not allowed with argument --bone-from-sweep"),
        (["--bone-from-sweep", "--bone-transform", "T.tfm"], "--bone-from-sweep"),
        (["--bone-frames", "SAID", "--bone-transform", "T.tfm"], "--bone-frames needs none"),
        (["--bone-frames", "SAID", "--speed-of-sound", "1480"], "--bone-frames takes depths"),
        (["--bone-frames", "SAID", "--bone-frames", "SAID"], "got 2 for 1"),
        (["--bone-frames", "nowhere.mha"], "nowhere.mha"),
    ],
)
def test_what_does_not_go_together_is_refused(patient, tmp_path, capsys, more, words):
    said = str(predicted(patient))
    (tmp_path / "results").mkdir()
    command = [*patient.reconstruct, *(said if word == "SAID" else word for word in more), "--output", tmp_path / "results" / "v.nrrd"]
    assert words in refused(command, capsys, tmp_path / "results")
