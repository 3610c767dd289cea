"""What guidance tells of a recorded sweep does not depend on where the patient lies, and is a sentence where nothing can be told."""

from __future__ import annotations

import numpy as np
import pytest
from idle_session import IMAGES, RECIPE, sweep_at
from sweeps import rigid, two_vertebrae

from AIFReconLib.geometry.transforms import transform_points
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.guidance.guidance import FAR, NOT_IN_BOX, guidance_of_sweep
from AIFReconLib.guidance.probe import ProbePlacement

HOME, ELSEWHERE = np.eye(4), rigid((20.0, -30.0, 40.0), (300.0, 20.0, -50.0))


def told(probe, place=HOME, moved=HOME, **options):
    """Guidance of a few sagittal frames over two vertebrae, the patient being at `place`, the CT moved from there by `moved`."""
    sweep = sweep_at([place @ probe.pose(ProbePlacement(x, 0.0, 90.0, -30.0)) for x in (-6.0, 0.0, 6.0)])
    return guidance_of_sweep(sweep, two_vertebrae(), moved @ place, RECIPE, **options)


@pytest.fixture(scope="module")
def here(probe):
    return told(probe)


def test_a_patient_who_lies_elsewhere_is_told_the_same(probe, here):
    there = told(probe, ELSEWHERE)
    assert (there.levels == here.levels).mean() > 0.99
    np.testing.assert_allclose(there.colored.mesh.points_reference, here.colored.mesh.points_reference, atol=1e-4)
    assert [step.words for step in there.advice.seen.directions] == [step.words for step in here.advice.seen.directions]
    np.testing.assert_allclose(there.advice.move.image_to_reference, ELSEWHERE @ here.advice.move.image_to_reference, atol=1e-6)


def test_a_sweep_that_leaves_bone_out_gets_a_move_that_adds_some(here):
    assert here.problem is None
    assert here.advice.move.adds_cm2 > 0
    assert set(here.advice.seen.over) <= {1, 2}


def test_the_mesh_is_sent_once(here):
    first = here.seen()
    again = here.seen(first.surface)
    assert (again.mesh, again.after(first).mesh) == (None, here.colored.mesh)
    assert again.after(None).mesh is None


def test_a_probe_is_drawn_on_its_image_and_behind_its_face(here):
    shape = here.seen().move.probe
    points = transform_points(IMAGES.image_to_face, shape.points_image)
    plane, body = points[: len(points) - 8], points[-8:]
    assert {corner for polygon in shape.polygons for corner in polygon} == set(range(len(points)))
    np.testing.assert_allclose(plane[:, 2], 0.0, atol=1e-9)
    assert plane[:, 1].min() > -2.0
    assert (body[:, 1].max(), body[:, 1].min()) == pytest.approx((0.0, -55.0))
    assert shape.border[0] == shape.border[-1]


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"moved": rigid(translation=(300.0, 0.0, 0.0))}, FAR),
        ({"grid": VoxelGrid.from_spacing((200.0, 0.0, 0.0), (10, 10, 10), 1.0)}, NOT_IN_BOX),
    ],
)
def test_where_nothing_can_be_told_a_sentence_stands_and_no_color(probe, options, problem):
    guidance = told(probe, **options)
    assert (guidance.problem, guidance.advice) == (problem, None)
    assert guidance.levels.max() == 1
