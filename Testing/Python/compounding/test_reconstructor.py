"""The distribution step: the engine is the plain loop, whatever the poses, pixels, voxels and chunks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_loop import gray, plain_loop
from sweeps import oblique_frames, sphere_bone, turned_grid

from AIFReconLib.compounding.evidence import ScanLines
from AIFReconLib.compounding.layout import PixelLayout
from AIFReconLib.compounding.methods.table import BONE_METHODS, METHODS
from AIFReconLib.compounding.reconstructor import Reconstructor
from AIFReconLib.errors import GeometryError, InsufficientMemoryError
from AIFReconLib.geometry.transforms import pixel_spacing
from AIFReconLib.geometry.volume import VoxelGrid
from AIFReconLib.imaging.beams import ProbeGeometry
from AIFReconLib.imaging.gray_levels import GrayLevels
from AIFReconLib.imaging.region import ClipRectangle, Fan, ImageRegion
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import TrackedFrame

SECTOR = ProbeGeometry("sector", (16.0, -6.0))
LINEAR = ProbeGeometry("linear")
FAN = ImageRegion(ClipRectangle((2, 1), (28, 22)), Fan((16.0, -6.0), (-40.0, 35.0), (7.0, 29.0)))
EVERYTHING = ImageRegion()


def bone_for(method):
    return sphere_bone() if method in BONE_METHODS else None


def reconstructor_of(method, grid=None, **settings):
    """With bone where the method needs it."""
    return Reconstructor(grid or turned_grid(), ReconstructionSettings(method=method, **settings), bone_for(method), probe=SECTOR)


def reconstruct_both(method, frames, grid, bone=None, probe=SECTOR, region=EVERYTHING, **options):
    """The library's result and the plain loop's, on the same frames."""
    wanted = ReconstructionSettings(hole_limit=0.0, method=method, output_type="float32", best_cosine=bone is not None, **options)
    reconstructor = Reconstructor(grid, wanted, bone, probe=probe, region=region)
    reconstructor.insert(frames)
    ours = reconstructor.finish()
    rows, columns = frames[0].image.shape
    spacing = pixel_spacing(frames[0].image_to_reference)
    on_grid = bone.on_grid(grid) if bone is not None else None
    maximum = np.iinfo(frames[0].image.dtype).max if frames[0].image.dtype.kind in "iu" else np.inf
    evidence = evidence_images(frames, region, probe, maximum, on_grid, grid) if method == "weighted" else None
    theirs = plain_loop(
        [(frame.image, frame.image_to_reference) for frame in frames],
        grid,
        method,
        mask=region.mask(columns, rows),
        directions=probe.directions(columns, rows, spacing),
        bone=on_grid,
        alpha=wanted.alpha,
        beta=wanted.beta,
        maximum=maximum,
        evidence=evidence,
        floor=wanted.weight_floor,
        gain=wanted.bone_gain,
    )
    return ours, theirs


def evidence_images(frames, region, probe, maximum, bone, grid):
    """What `ScanLines` judges of each frame, as images (reach, onset); it has tests of its own."""
    rows, columns = frames[0].image.shape
    layout = PixelLayout.build((columns, rows), pixel_spacing(frames[0].image_to_reference), region, probe)
    lines = ScanLines(layout, probe)
    mask = region.mask(columns, rows)
    images = []
    for frame in frames:
        expected = lines.expected(bone.map_probability, bone.ijk_to_map @ (grid.reference_to_ijk @ frame.image_to_reference))
        judged = lines.evidence(layout.values(frame.image), GrayLevels.as_recorded(float(maximum)), expected)
        images.append([np.zeros((rows, columns), np.float32) for _ in range(2)])
        images[-1][0][mask], images[-1][1][mask] = judged
    return images


@pytest.mark.parametrize("region", [EVERYTHING, FAN], ids=["full image", "clip and fan"])
@pytest.mark.parametrize("probe", [SECTOR, LINEAR], ids=["sector", "linear"])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_the_engine_gives_the_voxels_of_the_plain_loop_to_the_last_bit(method, probe, region, engine):
    kinds = (np.uint8, np.uint16, np.int16, np.float32)[: 3 if method == "weighted" else 4]
    for dtype in kinds if probe is LINEAR and region is FAN else kinds[:1]:
        frames = oblique_frames(dtype=dtype)
        ours, theirs = reconstruct_both(method, frames, turned_grid(), sphere_bone(), probe, region, engine=engine, alpha=0.5)
        np.testing.assert_array_equal(ours.hits.array, theirs.hits)
        np.testing.assert_array_equal(ours.intensity.array, theirs.intensity)
        np.testing.assert_array_equal(ours.score.array, theirs.score)
        assert theirs.cosine.max() > 0.9
        np.testing.assert_allclose(ours.cosine.array, theirs.cosine, atol=5e-4)


@settings(max_examples=25)
@given(
    method=st.sampled_from(METHODS),
    seed=st.integers(0, 10_000),
    spacing=st.tuples(st.floats(0.3, 2.5), st.floats(0.3, 2.5), st.floats(0.3, 2.5)),
    turn=st.tuples(*[st.floats(-90, 90)] * 3),
    pixel=st.tuples(st.floats(0.15, 1.2), st.floats(0.15, 1.2)),
)
def test_any_sweep_into_any_grid_gives_the_gray_levels_of_the_plain_loop(method, seed, spacing, turn, pixel):
    frames = oblique_frames(seed, count=3, shape=(15, 17), spacing=pixel)
    grid = turned_grid(spacing, (9, 8, 7), turn)
    ours, theirs = reconstruct_both(method, frames, grid, bone_for(method))
    np.testing.assert_array_equal(ours.hits.array, theirs.hits)
    np.testing.assert_array_equal(gray(ours.intensity.array), gray(theirs.intensity))


@pytest.mark.parametrize("method", METHODS)
def test_no_voxel_is_brighter_than_its_brightest_pixel_allows(method):
    """The bound of the method page: 1 for plain methods, 1 + alpha, 1 + alpha / beta, 1 + 3 gain for the others."""
    asked = {"alpha": 0.3, "beta": 0.2, "bone_gain": 1.5, "intensity_maximum": 1e9, "output_type": "float32", "hole_limit": 0.0}
    volumes = []
    for each in ("maximum", method):
        reconstructor = reconstructor_of(each, **(asked if each == method else {"output_type": "float32", "hole_limit": 0.0}))
        reconstructor.insert(oblique_frames())
        volumes.append(reconstructor.finish().intensity.array)
    bound = {"aif": 1.3, "aif-compensated": 1 + 0.3 / 0.2, "weighted": 1 + 3 * 1.5}.get(method, 1.0)
    assert (volumes[1] <= bound * volumes[0] * (1 + 1e-5)).all()


@pytest.mark.parametrize("interpolation", ["nearest", "linear"])
def test_an_image_without_a_finite_pixel_is_counted_as_such(interpolation):
    empty, good = oblique_frames(count=2, dtype=np.float32)
    empty.image[:] = np.nan
    reconstructor = Reconstructor(turned_grid(), ReconstructionSettings(method="average", interpolation=interpolation))
    reconstructor.insert([replace(empty, number=0), replace(good, number=1)])
    result = reconstructor.finish()
    assert result.frames_inserted == 1
    assert result.skipped == {"no pixel in the image is a finite number": [0]}


def test_frames_that_are_not_ok_are_counted_by_reason_and_change_nothing():
    frame = oblique_frames(count=1)[0]
    reconstructor = Reconstructor(turned_grid())
    reconstructor.insert(TrackedFrame(frame.image, frame.image_to_reference, status="ProbeToTracker OUT_OF_VIEW", number=4))
    reconstructor.insert(TrackedFrame(None, frame.image_to_reference, number=5))
    reconstructor.insert(TrackedFrame(frame.image, None, number=6))
    reconstructor.insert(TrackedFrame(frame.image, np.full((4, 4), np.nan), number=7))
    result = reconstructor.reconstruction()
    assert result.hits.array.max() == 0
    assert result.skipped == {"ProbeToTracker OUT_OF_VIEW": [4], "no image": [5], "no pose": [6], "image pose not finite": [7]}


@pytest.mark.parametrize(
    ("shape", "dtype", "said"),
    [((4, 5, 3), np.uint8, "4, 5, 3"), ((0, 5), np.uint8, "0, 5"), ((4, 5), np.complex64, "complex64")],
    ids=["color", "empty", "complex"],
)
@pytest.mark.parametrize("engine", ["numpy", "auto"])
def test_an_image_that_is_not_one_of_gray_pixels_is_refused_with_the_frame_number(shape, dtype, said, engine):
    reconstructor = Reconstructor(turned_grid(), ReconstructionSettings(engine=engine))
    with pytest.raises(GeometryError, match=rf"must be gray.*{said}.*frame 3"):
        reconstructor.insert(TrackedFrame(np.zeros(shape, dtype), np.eye(4), number=3))


def test_a_volume_that_does_not_fit_is_refused_before_anything_is_allocated():
    grid = VoxelGrid.from_spacing((0, 0, 0), (1290, 1290, 1290), 0.1)
    with pytest.raises(InsufficientMemoryError, match=r"A spacing of \S+ mm would fit"):
        Reconstructor(grid, ReconstructionSettings(method="aif"), sphere_bone(), probe=LINEAR)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [1, 2, 5])
def test_what_was_captured_is_the_volume_so_far_and_changes_neither_that_nor_the_rest(method, step):
    frames = oblique_frames(count=6)
    frames[3] = TrackedFrame(frames[3].image, frames[3].image_to_reference, status="ProbeToTracker OUT_OF_VIEW")
    looked_at, captured = reconstructor_of(method), []
    for start in range(0, len(frames), step):
        looked_at.insert(frames[start : start + step])
        captured.append(looked_at.capture())
        looked_at.reconstruction()
    for number, make in enumerate(captured):
        straight = reconstructor_of(method)
        straight.insert(frames[: step * (number + 1)])
        ours, expected = make(None), straight.finish()
        for part in ("intensity", "score", "hits", "mask"):
            np.testing.assert_array_equal(getattr(ours, part).array, getattr(expected, part).array)
        assert (ours.frames_inserted, ours.skipped) == (expected.frames_inserted, expected.skipped)
