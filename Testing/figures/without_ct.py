"""Figures and numbers of docs/without-ct.md: bone drawn from the sweep itself, beside its CT, and in two
real sweeps without one.

Run from anywhere: ``python Testing/figures/without_ct.py``. The recordings lie in AIFRECON_DATA_DIR, else in shared/data beside the
repository; the figures go to docs/images.
"""

from __future__ import annotations

import os
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import ndimage

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from study.calibration import PASSES, Patient
from study.real_bone_cases import RealBone

from AIFReconLib.bone.echoes.finder import BoneEchoFinder
from AIFReconLib.bone.echoes.surface import bone_from_sweep
from AIFReconLib.compounding.methods.average import AVERAGE
from AIFReconLib.compounding.methods.table import COMPARED_METHODS, method_named
from AIFReconLib.effective_settings import Imaging, imaging_fields
from AIFReconLib.evaluation.figures import Panel, draw_panels, own_looks, save_figure
from AIFReconLib.evaluation.lines import values_at
from AIFReconLib.geometry.transforms import pixel_spacing, transform_points
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.imaging.beams import LINEAR
from AIFReconLib.imaging.detection import detect_imaging
from AIFReconLib.io.sequence.files import read_sequence
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.registration.labeled_bone import LabeledBone
from AIFReconLib.sweep.poses import sweep_poses

REPOSITORY = Path(__file__).resolve().parents[2]
DATA = Path(os.environ.get("AIFRECON_DATA_DIR") or REPOSITORY.parent / "shared" / "data")
IMAGES = REPOSITORY / "docs" / "images"

RECORDINGS = {
    "bone": ("BoneUltrasound_L14.igs.mha", "BoneUltrasound_L14_config.xml", 0.3),
    "spine-phantom": ("SpinePhantomFreehand.igs.mha", "SpinePhantom_NN_MEAN.xml", 0.4),
}
ECHO_COLOR = "#ffb000"
AROUND = 10.0
"""mm before and behind an echo that its profile shows."""


def place(pose: np.ndarray, columns, rows) -> np.ndarray:
    """Points (..., 3) in Reference of pixels."""
    columns, rows = np.broadcast_arrays(columns, rows)
    return columns[..., None] * pose[:3, 0] + rows[..., None] * pose[:3, 1] + pose[:3, 3]


def profiles(volume: Volume, pose: np.ndarray, pixels: np.ndarray, spacing: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Intensity down the beam through each echo of a linear probe, (echoes, samples), and the samples' distance from it in mm."""
    offsets = np.arange(-AROUND, AROUND + 0.05, 0.1)
    return values_at(volume, place(pose, pixels[:, :1], pixels[:, 1:] + offsets / spacing[1]), np.nan), offsets


def measure(values: np.ndarray, offsets: np.ndarray) -> tuple[float, float, float]:
    """Medians over echoes: peak, and contrast to the 3 to 8 mm before and to those behind (ratios)."""
    peak = np.nanmax(values[:, np.abs(offsets) <= 1.5], axis=1)
    before = np.nanmean(values[:, (offsets >= -8) & (offsets <= -3)], axis=1)
    behind = np.nanmean(values[:, (offsets >= 3) & (offsets <= 8)], axis=1)
    level, before_it, behind_it = (float(np.nanmedian(each)) for each in (peak, peak / np.maximum(before, 1), peak / np.maximum(behind, 1)))
    return level, before_it, behind_it


def panel_of(name: str, values: np.ndarray, size: tuple[float, float], most: float = 255.0) -> Panel:
    """A picture of so many mm, NaN where nothing was scanned."""
    return Panel(name, values, size, ("", "", "", ""), (0.0, most))


@own_looks()
def study(name: str) -> None:
    """Reconstruct one recording with every method, print the numbers, write the figure."""
    file, configuration, spacing = RECORDINGS[name]
    sequence = read_sequence(DATA / file, config=DATA / configuration)
    poses = sweep_poses(sequence)
    pixel = pixel_spacing(poses.image_to_reference[poses.usable[0]])
    detected = detect_imaging(sequence.images, pixel)
    imaging = Imaging(detected.region, detected.probe)
    looked = imaging_fields(detected.region, detected.probe)
    bone = bone_from_sweep(sequence, Recipe(**looked))
    results, plain = {}, {}
    for method in COMPARED_METHODS:
        recipe = Recipe(method=method, spacing=spacing, hole_limit=1.2, bone_direction="surface", **looked)
        told = bone if method_named(method).needs_bone else None
        results[method] = reconstruct(sequence, recipe, told)
        if told:  # without the brightening of bone: what remains is the weighting
            plain[f"{method}, plain"] = reconstruct(sequence, replace(recipe, alpha=0.0, bone_gain=0.0), told)
    middle = int(poses.usable[len(poses.usable) // 2])
    pose = poses.image_to_reference[middle]
    echoes = BoneEchoFinder(sequence.frame_size, pixel, imaging).find(sequence.images[middle])
    inner = echoes.pixels[2:-2]
    print(f"{name}: {len(inner)} echoes in frame {middle}")
    for method, result in (results | plain).items():
        peak, before, behind = measure(*profiles(result.intensity, pose, inner, pixel))
        print(f"  {method:25} peak {peak:5.1f}  to tissue before {before:4.2f}  to shadow behind {behind:5.2f}")

    assert imaging.region.clip is not None, "the recordings have a border"
    left, right, top, bottom = imaging.region.clip.bounds(*sequence.frame_size)
    in_plane = place(pose, np.arange(left, right + 1, 3)[None, :], np.arange(top, bottom + 1, 3)[:, None])
    box = ((right - left) * pixel[0], (bottom - top) * pixel[1])
    first, last = poses.image_to_reference[poses.usable[0]], poses.image_to_reference[poses.usable[-1]]
    column = (left + right) / 2
    ends = [place(p, column, np.arange(top, bottom + 1, 3)) for p in (first, last)]
    travel = float(np.linalg.norm(ends[1] - ends[0], axis=-1).mean())
    share = np.linspace(0, 1, max(round(travel / 0.25), 2))[None, :, None]
    along = ends[0][:, None] * (1 - share) + ends[1][:, None] * share
    cuts = [("frame", in_plane, box)] + ([("along the sweep", along, (travel, box[1]))] if travel > 10 else [])
    rows = []
    for label, points, size in cuts:
        row = [panel_of("bone from the sweep", values_at(bone.probability, points), size, 1.0)]
        for method, result in results.items():
            seen = values_at(result.mask, points) >= 0.5
            row.append(panel_of(method, np.where(seen, values_at(result.intensity, points), np.nan), size))
        rows.append([replace(row[0], side=label), *row[1:]])
    rows[0].append(panel_of("echoes of one frame", sequence.images[middle][top : bottom + 1, left : right + 1].astype(float), box))
    figure = draw_panels(rows, 1.5 / box[0], f"{file}, without a CT", "blue: not scanned")
    dots = (echoes.pixels - (left, top)) * pixel
    figure.axes[len(rows[0]) - 1].plot(*dots.T, ".", color=ECHO_COLOR, ms=0.8)
    save_figure(IMAGES / f"without-ct-{name}.png", figure)


@own_looks()
def beside_a_ct() -> None:
    """A real bone and a patient of real shape: average, `weighted` without the CT, and with it."""
    bone, patient = RealBone.found(), Patient.scanned(0)
    scanned, placed = patient.case(tuple(range(PASSES))).sequence, patient.labels.placed_by(patient.ct_to_reference)
    cases = {
        "real bone (fibula)": (bone.sequence, Recipe(probe=LINEAR, spacing=0.5), bone.labels, 2),
        "real shape, simulated": (scanned, Recipe(spacing=0.7), placed, 0),
    }
    rows = []
    for name, (sequence, recipe, labels, axis) in cases.items():
        volumes = {
            "average": reconstruct(sequence, replace(recipe, method=AVERAGE.name)),
            "weighted, without a CT": reconstruct(sequence, recipe, bone_from_sweep(sequence, recipe)),
            "weighted, with its CT": reconstruct(sequence, recipe, LabeledBone(labels, None, sequence, recipe)),
        }
        row = []
        for title, result in volumes.items():
            shown = result.mask.array != 0
            solid = values_at(replace(labels, array=(labels.array > 0).astype(np.uint8)), grid_points(result.grid)) > 0.5
            rim = solid & ~ndimage.binary_erosion(solid) & shown
            plane = int(np.argmax(rim.sum(axis=tuple(n for n in range(3) if n != axis))))
            picture = np.where(shown, result.intensity.array, np.nan).take(plane, axis)
            height, width = np.delete(result.grid.spacing[::-1], axis) * picture.shape
            if height > width:  # the long way lies across the page
                picture, height, width = picture.T, width, height
            row.append(panel_of(title, picture[::-1], (width, height)))
        rows.append([replace(row[0], side=name), *row[1:]])
    scale = 3.0 / max(panel.size[0] for row in rows for panel in row)
    save_figure(IMAGES / "without-ct-beside.png", draw_panels(rows, scale, "With a CT and without", "blue: not scanned"))


def grid_points(grid) -> np.ndarray:
    """Where the voxels are, (k, j, i, 3)."""
    return transform_points(grid.ijk_to_reference, np.moveaxis(np.indices(grid.shape)[::-1], 0, -1))


if __name__ == "__main__":
    beside_a_ct()
    for recording in RECORDINGS:
        study(recording)
