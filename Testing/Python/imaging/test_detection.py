"""Recognizing the probe from images that were drawn with a known geometry, from real ones, and from what is neither."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
import SimpleITK as sitk
from scipy import ndimage

from AIFReconLib.effective_settings import resolve_imaging
from AIFReconLib.errors import BeamGeometryError
from AIFReconLib.geometry.transform_graph import TransformName, TransformSample
from AIFReconLib.imaging.beams import LINEAR, SECTOR
from AIFReconLib.imaging.detection import DetectedImaging, detect_imaging
from AIFReconLib.recipe.recipe import ReconstructionSettings
from AIFReconLib.sweep.frames import FrameRecord, TrackedSequence
from AIFReconLib.sweep.poses import sweep_poses

ROWS, COLUMNS = 240, 320
RNG_SEED = 5
ROW, COLUMN = np.mgrid[:ROWS, :COLUMNS]


@lru_cache
def speckle(frames: int) -> np.ndarray:
    """Fully developed speckle, (frames, rows, columns) float64."""
    rng = np.random.default_rng(RNG_SEED)
    stack = []
    for _ in range(frames):
        real, imaginary = (ndimage.gaussian_filter(rng.standard_normal((ROWS, COLUMNS)), 1.5) for _ in range(2))
        magnitude = np.hypot(real, imaginary)
        stack.append(90.0 * magnitude / magnitude.mean())
    return np.array(stack)


def images_of(inside: np.ndarray, frames: int = 4) -> np.ndarray:
    """Speckle where `inside` is True, black elsewhere, uint8."""
    return np.where(inside, np.clip(speckle(frames), 0, 255), 0).astype(np.uint8)


def sector(apex=(160.0, 10.0), angles=(-45.0, 45.0), radii=(0.0, 215.0), spacing=(1.0, 1.0)) -> np.ndarray:
    """Which pixels a sector covers."""
    x, y = (COLUMN - apex[0]) * spacing[0], (ROW - apex[1]) * spacing[1]
    radius, angle = np.hypot(x, y), np.degrees(np.arctan2(x, y))
    return (angle >= angles[0]) & (angle <= angles[1]) & (radius >= radii[0]) & (radius <= radii[1])


def rectangle(left=80, right=250, top=8, bottom=230) -> np.ndarray:
    """Which pixels a rectangle covers, its last column and row included."""
    return (left <= COLUMN) & (right >= COLUMN) & (top <= ROW) & (bottom >= ROW)


SECTORS = {
    "phased array": {},
    "narrow": {"angles": (-15.0, 15.0)},
    "very narrow": {"angles": (-8.0, 8.0)},
    "wide": {"angles": (-60.0, 60.0), "radii": (0.0, 170.0)},
    "off center": {"apex": (120.3, 5.7)},
    "steered": {"apex": (90.0, 10.0), "angles": (-10.0, 50.0)},
    "curvilinear": {"apex": (160.0, -80.0), "angles": (-30.0, 30.0), "radii": (95.0, 300.0)},
    "curvilinear, apex inside": {"apex": (155.0, 30.0), "angles": (-40.0, 40.0), "radii": (45.0, 190.0)},
    "off center curvilinear": {"apex": (181.5, -62.2), "angles": (-24.0, 31.0), "radii": (80.0, 270.0)},
    "wide pixels": {"apex": (160.0, 8.0), "spacing": (0.3, 0.2), "radii": (0.0, 44.0)},
    "tall pixels": {"apex": (160.0, 8.0), "spacing": (0.15, 0.3), "angles": (-20.0, 20.0), "radii": (0.0, 60.0)},
    "tall pixels, curvilinear": {"apex": (160.0, -40.0), "spacing": (0.15, 0.3), "angles": (-20.0, 20.0), "radii": (15.0, 80.0)},
    "cut by the bottom": {"radii": (0.0, 400.0), "angles": (-30.0, 30.0)},
    "cut by both sides": {"angles": (-60.0, 60.0), "radii": (0.0, 225.0)},
    "cut by one side": {"apex": (60.0, 8.0), "radii": (0.0, 220.0)},
    "cut by sides and bottom": {"angles": (-50.0, 50.0), "radii": (0.0, 600.0)},
    "curvilinear, cut by the bottom": {"apex": (160.0, -80.0), "angles": (-30.0, 30.0), "radii": (95.0, 600.0)},
}


def assert_found(found: DetectedImaging, apex=(160.0, 10.0), angles=(-45.0, 45.0), radii=(0.0, 215.0), spacing=(1.0, 1.0)) -> None:
    """Apex within 2 px, angles within half a degree, and nearly the same pixels."""
    assert found.probe.kind == SECTOR
    assert found.probe.apex_px is not None
    assert found.region.fan is not None
    assert np.hypot(*np.subtract(found.probe.apex_px, apex)) < 2.0
    np.testing.assert_allclose(found.region.fan.angles_deg, angles, atol=0.5)
    truth, mask = sector(apex, angles, radii, spacing), found.region.mask(COLUMNS, ROWS)
    assert (truth & mask).sum() > 0.97 * (truth | mask).sum()


@pytest.mark.parametrize("shape", SECTORS.values(), ids=SECTORS)
def test_a_sector_is_found_with_its_apex_and_angles(shape):
    assert_found(detect_imaging(images_of(sector(**shape)), shape.get("spacing", (1.0, 1.0))), **shape)


def test_a_sector_that_is_asked_for_is_found_by_the_size_of_its_pixels():
    spacing = (0.15, 0.3)
    images = images_of(sector((160.0, -40.0), (-20.0, 20.0), (60.0 * spacing[1], 260.0 * spacing[1]), spacing))
    records = [
        FrameRecord(0.1 * n, transforms={TransformName("Image", "Tracker"): TransformSample(np.diag([*spacing, 1, 1]))}) for n in range(4)
    ]
    sequence = TrackedSequence(images=images, records=records)
    imaging = resolve_imaging(sequence, sweep_poses(sequence, reference="Tracker"), True, ReconstructionSettings(probe=SECTOR))
    assert imaging.known_probe() == detect_imaging(images, spacing).probe
    assert imaging.region != detect_imaging(images).region


BOXES = {
    "centered": {},
    "at the left": {"left": 0, "right": 170, "top": 0},
    "at the right": {"left": 140, "right": 319, "bottom": 239},
    "narrow": {"left": 150, "right": 165},
    "shallow": {"top": 8, "bottom": 40, "left": 20, "right": 300},
}


@pytest.mark.parametrize("box", BOXES.values(), ids=BOXES)
def test_a_rectangle_is_a_linear_probe_with_its_pixels(box):
    found = detect_imaging(images_of(rectangle(**box)))
    assert found.probe.kind == LINEAR
    np.testing.assert_array_equal(found.region.mask(COLUMNS, ROWS), rectangle(**box))


def blob(seed: int, size: float) -> np.ndarray:
    noise = ndimage.gaussian_filter(np.random.default_rng(seed).standard_normal((ROWS, COLUMNS)), size)
    return noise > np.quantile(noise, 0.6)


NEITHER = {
    "circle": np.hypot(COLUMN - 160, ROW - 120) < 100,
    "ellipse": np.hypot((COLUMN - 160) / 1.4, ROW - 120) < 100,
    "dome": (np.hypot(COLUMN - 160, ROW - 180) < 120) & (ROW < 180),
    "bowl": (np.hypot(COLUMN - 160, ROW - 30) < 120) & (ROW > 30),
    "diamond": np.abs(COLUMN - 160) + np.abs(ROW - 120) < 100,
    "right triangle": (COLUMN > 50) & (COLUMN - 50 < ROW - 10) & (ROW < 220),
    "trapezoid, wide at the top": (ROW > 10) & (np.abs(COLUMN - 160) < 120 - 0.3 * (ROW - 10)) & (ROW < 220),
    "parallelogram": (COLUMN - 0.3 * ROW > 50) & (COLUMN - 0.3 * ROW < 170) & (ROW > 10) & (ROW < 220),
    "L": ((COLUMN > 50) & (COLUMN < 100) & (ROW > 20) & (ROW < 220)) | ((COLUMN > 50) & (COLUMN < 280) & (ROW > 170) & (ROW < 220)),
    "sector below a bar": sector((160.0, 10.0), (-25.0, 25.0), (0.0, 210.0)) | (ROW < 30),
    "upside down": sector()[::-1],
    "sideways": np.pad(sector()[:, 40:280].T, ((0, 0), (40, 40))),
    **{f"blob {seed}": blob(seed, (5, 15, 30, 50)[seed % 4]) for seed in range(12)},
}


CUT = {
    "phased array, a fifth left": ({}, 0.4, 0),
    "phased array, without its apex": ({}, 0.3, 80),
    "wide": (SECTORS["wide"], 0.36, 0),
    "curvilinear, its face left": (SECTORS["curvilinear"], 0.35, 0),
    "curvilinear, a slice of its face": (SECTORS["curvilinear"], 0.4, 0),
    "curvilinear, without its face": (SECTORS["curvilinear"], 0.25, 70),
    "curvilinear, apex inside": (SECTORS["curvilinear, apex inside"], 0.3, 0),
    "off center curvilinear": (SECTORS["off center curvilinear"], 0.35, 0),
    "curvilinear, cut by the bottom too": (SECTORS["curvilinear, cut by the bottom"], 0.3, 0),
    "cut by sides and bottom, corners left": (SECTORS["cut by sides and bottom"], 0.15, 79),
}
"""Sectors, the part of their width that is cut off at either side, and the row above which nothing is left."""


NOTHING = {
    "black": np.zeros((2, 50, 60), np.uint8),
    "no frames": np.zeros((0, 50, 60), np.uint8),
    "NaN": np.full((2, 50, 60), np.nan, np.float32),
    "negative": np.full((2, 50, 60), -5.0),
    "one pixel of light": np.pad(np.full((1, 1, 1), 9, np.uint8), ((0, 0), (20, 20), (20, 20))),
    "one pixel": np.full((2, 1, 1), 9, np.uint8),
    "nine pixels": np.full((2, 3, 3), 9, np.uint8),
    "white noise": np.random.default_rng(RNG_SEED).integers(0, 256, (3, ROWS, COLUMNS)).astype(np.uint8),
    "sparse noise": (np.random.default_rng(RNG_SEED).random((3, ROWS, COLUMNS)) < 1e-3) * np.uint8(255),
}


def cut(shape, part, top):
    """A sector of which a part of its width is cut off at either side, and all above a row."""
    inside = sector(**shape)
    columns = np.flatnonzero(inside.any(axis=0))
    lost = int(part * (columns[-1] - columns[0]))
    return inside & (columns[0] + lost <= COLUMN) & (columns[-1] - lost >= COLUMN) & (top <= ROW)


def window_in_gray():
    """A black window in a gray frame."""
    images = images_of(blob(1, 30) & rectangle(60, 260, 20, 220), frames=8)
    images[:, ~rectangle()] = 60
    return images


def not_told(name):
    """Images that do not show the probe."""
    if name in NOTHING:
        return NOTHING[name]
    if name == "a black window in a gray frame":
        return window_in_gray()
    whole = np.ones((ROWS, COLUMNS), bool)
    return images_of(cut(*CUT[name]) if name in CUT else NEITHER.get(name, whole))


@pytest.mark.parametrize("name", [*NEITHER, *CUT, *NOTHING, "a black window in a gray frame", "no black surround"])
def test_images_that_do_not_show_the_probe_are_refused_rather_than_guessed(name):
    with pytest.raises(BeamGeometryError, match="no black surround" if "surround" in name else "cannot be told from the images"):
        detect_imaging(not_told(name))


def test_a_sector_of_which_one_half_is_in_shadow_is_taken_to_be_as_wide_as_the_other_and_says_so():
    found = detect_imaging(images_of(sector() & (COLUMN > 160)), (0.3, 0.3))
    assert_found(found, radii=(0.0, 64.5), spacing=(0.3, 0.3))
    assert "its left side is dark" in found.description


@pytest.mark.parametrize(
    ("name", "box"),
    [
        ("SpinePhantomFreehand.igs.mha", (187, 631, 12, 601)),
        ("BoneUltrasound_L14.igs.mha", (176, 642, 1, 614)),
        ("NwirePhantomFreehand.igs.nrrd", None),
    ],
)
def test_a_real_linear_probe_is_found_with_its_pixels_and_wires_in_water_are_refused(real_data, name, box):
    images = sitk.GetArrayFromImage(sitk.ReadImage(str(real_data(name))))
    if box is None:
        # As components of one picture, which is how SimpleITK takes a "list" axis
        images = np.moveaxis(images, -1, 0) if images.shape[-1] == 97 else images
        with pytest.raises(BeamGeometryError):
            detect_imaging(images[::8])
        return
    found = detect_imaging(images, (0.085, 0.085))
    assert found.probe.kind == LINEAR
    np.testing.assert_allclose(found.region.clip.bounds(820, 616), box, atol=2)
