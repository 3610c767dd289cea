"""Motion that is known, because the test made it: found from echoes and taken out; and a scan at rest is left alone."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from ray_echoes import ray_echoes, spine
from sweeps import laid_on, rigid

from AIFReconLib import TrackedSequence
from AIFReconLib.bone.echoes.found import SweepEchoes
from AIFReconLib.bone.field import BoneField
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample, TransformStatus
from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.inspection.motion_drawing import COLORS, draw_motion
from AIFReconLib.inspection.verdicts import Level, motion_verdict
from AIFReconLib.motion.motion import PatientMotion, motion_of, passes_in, taken_out
from AIFReconLib.motion.passes import Passes
from AIFReconLib.motion.solve import BoneInPlace, MotionCurve
from AIFReconLib.simulation.scan import BREATH, TrackingErrors, patient_motion
from AIFReconLib.sweep.frames import FrameRecord
from AIFReconLib.sweep.poses import sweep_poses

PASS_FRAMES, RATE, GAP = 150, 20.0, 2.0


def in_passes(echoes: SweepEchoes) -> tuple[SweepEchoes, Passes]:
    """Rays of one tilt are a pass along the spine, one after the other."""
    _, first, owners = np.unique(echoes.beams.round(6), axis=0, return_index=True, return_inverse=True)
    owners = np.argsort(np.argsort(first))[owners.ravel()]
    frames = owners * PASS_FRAMES + (echoes.points[:, 2] + 75).astype(int)
    count = int(owners.max()) + 1
    numbers = np.repeat(np.arange(count), PASS_FRAMES)
    times = np.arange(count * PASS_FRAMES) / RATE + GAP * numbers
    poses = np.tile(np.eye(4), (count * PASS_FRAMES, 1, 1))
    poses[frames, :3, 1] = echoes.beams
    across = np.cross(echoes.beams, [0.0, 0.0, 1.0])
    poses[frames, :3, 0] = across / np.linalg.norm(across, axis=1, keepdims=True)
    poses[frames, :3, 2] = [0.0, 0.0, 1.0]
    return replace(echoes, frames=frames), Passes(numbers, times, poses)


@pytest.fixture(scope="module")
def scan():
    return in_passes(ray_echoes(spine().bone_distance, pitch=1.2, noise=0.2))


@pytest.fixture(scope="module")
def bone():
    return BoneInPlace(BoneField.from_labels(spine().labels), np.eye(4))


def moved(scan, **errors) -> SweepEchoes:
    """The echoes of a patient who moves so."""
    echoes, passes = scan
    of = patient_motion(passes.times, TrackingErrors(**errors), 3)[echoes.frames]
    return replace(echoes, points=np.einsum("nij,nj->ni", of[:, :3, :3], echoes.points) + of[:, :3, 3])


def left(found: PatientMotion, shown: SweepEchoes, true: SweepEchoes, as_one: bool) -> float:
    """mm, root mean square, between where echoes came to lie and where they were at rest; laid on each other as one where that is asked."""
    here, there = found.curve.moved(shown).points, true.points
    return float(np.sqrt((((laid_on(here, there) if as_one else here) - there) ** 2).sum(axis=1).mean()))


def test_a_patient_at_rest_is_left_alone_and_said_to_have_lain_still(scan, bone):
    for field in (None, bone):
        found = motion_of(*scan, field)
        assert not found.applied
        assert re.fullmatch(r"The patient lay still: no pass shows the bone more than 0\.\d mm off\.", *found.lines)
        assert np.array_equal(found.curve.matrices, np.tile(np.eye(4), (len(scan[1].numbers), 1, 1)))


@pytest.mark.parametrize("mm", [1.5, 3.0])
def test_passes_that_moved_are_laid_on_each_other_and_on_the_ct(mm, scan, bone):
    shown = moved(scan, shifting=mm)
    crossed, placed = motion_of(shown, scan[1]), motion_of(shown, scan[1], bone)
    assert crossed.applied
    assert placed.applied
    assert left(crossed, shown, scan[0], True) < 0.5
    assert left(placed, shown, scan[0], False) < 0.4
    assert placed.lines[-1] == f"Mended: echoes lie {placed.after:.1f} mm apart, before {placed.before:.1f}."


def test_a_breath_is_told_by_its_size_and_time(scan):
    rest, times = MotionCurve.none(scan[1], scan[0]), MotionCurve.none(scan[1], scan[0]).knot_times
    wave = np.sin(2 * np.pi * times / BREATH)[:, None] * [0.0, 2.1, 0.0]
    found = PatientMotion(replace(rest, shifts=wave), 1.4, 0.3, True)
    assert found.breath == pytest.approx((2.1, BREATH), rel=0.1)
    drawn = [stroke.points for stroke in draw_motion(found).strokes if stroke.color == COLORS[1]]
    heights = np.concatenate([points[:, 1] for points in drawn])
    assert len(drawn) == len(scan[1])
    assert np.corrcoef(heights, found.shifts[:, 1])[0, 1] == pytest.approx(-1.0)
    assert found.lines == ("The patient breathed: 2.0 mm, every 3.7 s.", "Mended: echoes lie 0.3 mm apart, before 1.4.")


def test_one_pass_that_lies_off_is_named(scan):
    echoes, passes = scan
    shown = replace(echoes, points=echoes.points + np.where(passes.numbers[echoes.frames] == 2, 2.9, 0.0)[:, None] * [0.0, 1.0, 0.0])
    found = motion_of(shown, passes)
    assert found.lines[0].startswith("Pass 3 lies ")
    assert float(found.off[2]) == pytest.approx(2.9, abs=0.4)


def test_a_ct_that_lies_off_is_no_motion_of_the_patient(scan, bone):
    off = replace(bone, labels_to_reference=rigid(translation=(0.0, 3.0, 0.0)))
    assert not motion_of(*scan, off).applied


def test_a_calibration_that_is_off_is_no_motion_of_the_patient(scan, bone):
    echoes, passes = scan
    wrong = replace(MotionCurve.none(passes, echoes), calibration=rigid((1.0, 2.0, -1.0), (1.2, -0.8, 1.0)))
    shown = wrong.moved(echoes)
    for known in (None, bone):
        found = motion_of(shown, passes, known)
        assert found.is_calibration
        assert found.curve.calibration_off == pytest.approx(wrong.calibration_off, abs=0.5)
        assert found.lines[0].startswith("WARNING: The patient lay still, but the calibration is ")
        assert left(found, shown, echoes, as_one=known is None) < 0.3
        assert motion_verdict(found, taken_out=True).level is Level.LOOK
        # Without a CT nothing tells where all of it lies
        by = (found.curve.moved(shown).points - shown.points).mean(axis=0)
        assert (np.linalg.norm(by) < 1e-6) == (known is None)
    both = wrong.moved(moved(scan, breathing=3.0))
    found = motion_of(both, passes, bone)
    assert found.applied
    assert not found.is_calibration
    assert left(found, both, echoes, as_one=False) < 0.5


def test_frames_that_no_motion_explains_are_said_to_contradict_each_other(scan):
    rest = MotionCurve.none(scan[1], scan[0])
    assert PatientMotion(rest, 1.9, 1.9, False).lines[0].startswith("WARNING: Passes show the bone 1.9 mm apart, and no motion")
    assert PatientMotion(rest, 0.9, 0.9, False).lines == ("The patient lay still: no pass shows the bone more than 0.9 mm off.",)


def test_along_a_rod_nothing_is_moved_and_that_is_said():
    rng = np.random.default_rng(0)
    angle, z = rng.uniform(-1.2, 1.2, 6000), rng.uniform(-60, 60, 6000)
    around = np.stack([np.sin(angle), -np.cos(angle), np.zeros_like(z)], axis=1)
    points = 8.0 * around + z[:, None] * [0.0, 0.0, 1.0] + 0.1 * rng.standard_normal((6000, 3))
    numbers, frames = np.repeat(np.arange(4), 40), rng.integers(0, 160, 6000)
    passes = Passes(numbers, np.arange(160) / RATE + GAP * numbers, np.tile(np.eye(4), (160, 1, 1)))
    by = np.array([[0.0, 0.0, 0.0], [2.0, 1.0, 3.0], [-2.0, 0.0, -4.0], [1.0, -2.0, 2.0]])
    shown = SweepEchoes(points + by[numbers[frames]], -around, np.ones(6000, np.float32), frames)
    found = motion_of(shown, passes)
    assert found.applied
    assert np.abs(found.shifts[:, 2]).max() < 0.1
    assert "Along z of Reference the echoes do not hold it; there nothing is moved." in found.lines


# ---- passes


def _sequence(places, times):
    poses = np.tile(np.diag([0.3, 0.3, 0.3, 1.0]), (len(places), 1, 1))
    poses[:, 2, 3] = places
    return TrackedSequence.from_arrays(np.zeros((len(places), 8, 8), np.uint8), poses, times)


def test_passes_end_where_the_scan_stopped_where_the_probe_turned_and_where_a_file_ends():
    there_and_back = _sequence([*range(30), *range(30, 0, -1)], np.arange(60) / RATE)
    with_a_pause = _sequence(range(40), [*np.arange(20) / RATE, *(3.0 + np.arange(20) / RATE)])
    passes = passes_in([there_and_back, with_a_pause])
    assert len(passes) == 4
    assert np.flatnonzero(np.diff(passes.numbers)) == pytest.approx([29, 59, 79], abs=4)
    assert (np.diff(passes.times) > 0).all()


# ---- what is done to a recording


def test_the_motion_is_taken_out_of_what_leads_to_reference_and_of_nothing_else():
    rng = np.random.default_rng(1)
    image, tracker = TransformName("Image", "Probe"), TransformName("Probe", "Tracker")
    reference, stylus = TransformName("Reference", "Tracker"), TransformName("Stylus", "Tracker")
    records = []
    for n in range(30):
        poses = {name: TransformSample(rigid(20 * rng.standard_normal(3), rng.standard_normal(3))) for name in (tracker, stylus)}
        if n == 7:
            poses[tracker] = TransformSample(np.full((4, 4), np.nan), TransformStatus.MISSING)
        records.append(FrameRecord(n / RATE, transforms=poses))
    fixed = {image: TransformSample(np.diag([0.2, 0.2, 0.2, 1.0])), reference: TransformSample(rigid((5, 6, 7), (1, 2, 3)))}
    sweep = TrackedSequence(np.zeros((30, 4, 4), np.uint8), records, transforms=fixed)
    passes = passes_in([sweep])
    echoes = SweepEchoes(rng.standard_normal((60, 3)), np.tile([0.0, 1.0, 0.0], (60, 1)), np.ones(60, np.float32), np.arange(60) % 30)
    curve = MotionCurve.none(passes, echoes)
    curve = curve.stepped(rng.standard_normal(3 * (len(curve.turns) + len(curve.shifts)) + 6))
    mended = taken_out(sweep, PatientMotion(curve, 1.0, 0.2, True))
    before, after = sweep_poses(sweep), sweep_poses(mended)
    placed = [n for n in range(30) if n != 7]
    assert after.image_to_reference[placed] == pytest.approx((curve.matrices @ before.image_to_reference)[placed])
    assert after.problems == before.problems
    assert mended.records[3].transforms[stylus] == sweep.records[3].transforms[stylus]
    assert mended.notes == PatientMotion(curve, 1.0, 0.2, True).lines


def test_a_curve_moves_echoes_as_its_matrices_do_and_turns_about_the_middle_of_a_pass(scan):
    echoes, passes = scan
    rest = MotionCurve.none(passes, echoes)
    step = np.zeros(3 * (len(rest.turns) + len(rest.shifts)) + 6)
    step[2] = math.radians(10.0) * rest.lever
    turned = rest.stepped(step)
    first = passes.numbers[echoes.frames] == 0
    expected = transform_points(rigid((0, 0, 10)), echoes.points[first] - rest.centers[0]) + rest.centers[0]
    assert turned.moved(echoes).points[first] == pytest.approx(expected)
    assert np.array_equal(turned.moved(echoes).points[~first], echoes.points[~first])


# ---- the simulated patient


def test_a_simulated_patient_breathes_shifts_and_steps_as_asked():
    times = np.concatenate([np.arange(40) / RATE + 4.0 * n for n in range(5)])
    breathing = patient_motion(times, TrackingErrors(breathing=2.0))[:, :3, 3]
    assert np.linalg.norm(breathing, axis=1).max() == pytest.approx(2.0, abs=0.1)
    assert np.linalg.svd(breathing)[1][1] == pytest.approx(0.0, abs=1e-6)
    shifted = patient_motion(times, TrackingErrors(shifting=1.5))
    assert len(np.unique(shifted.round(9), axis=0)) == 5
    stepped = patient_motion(times, TrackingErrors(step=6.0))[:, :3, 3]
    assert np.linalg.norm(stepped[[0, -1]], axis=1) == pytest.approx([0.0, 6.0])
    assert np.flatnonzero(np.diff(stepped[:, 0])) == pytest.approx([99])
    assert np.array_equal(patient_motion(times, TrackingErrors()), np.tile(np.eye(4), (200, 1, 1)))
