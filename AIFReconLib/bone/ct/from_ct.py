"""The bone of a CT as labels: above a threshold that is found in it, without contrast, metal, the table and calcified vessels."""

from __future__ import annotations

import numpy as np
import scipy
from numpy.typing import ArrayLike

from ...arrays import Floats, Integers, Mask, Singles
from ...errors import GeometryError, SettingsError
from ...geometry.box import block_sums, box_around
from ...geometry.labels import Labels
from ...geometry.volume import Volume, as_volume
from ...machine.memory import LARGEST_GRID, require_memory
from ...progress import Progress, report
from .hounsfield import AIR, soft_tissue
from .vertebrae import in_vertebrae

FINEST = 0.6
"""mm. Voxels are averaged in whole blocks as long as they stay as fine as that twice over: noise goes, the surface stays."""

COARSE = 2.0
"""mm of the blocks by which body, table and contrast are told."""

SKIN = 4.0
"""mm below the outer air in which nothing is bone: the table that the patient lies on, wires and markers."""

OPENED = 5.0
"""mm. What is thinner than twice that is no part of the body."""

METAL, LEAST_METAL, BESIDE_METAL = 2500.0, 0.1, 2.0
"""HU of metal, cm3 from which it is told, mm around it that are not taken for bone."""

LEAST_CONTRAST, DENSEST_CONTRAST, UNEVEN, BRIGHTER = 0.5, 1100.0, 0.2, 1.3
"""Of contrast: its least volume in cm3, its largest mean in HU, how even it is (standard deviation above tissue), and by which factor a
shell around it would have to be brighter for it to be the inside of bone."""

LEAST_BONE, LEAST_SHARE = 3.0, 0.2
"""cm3 of a piece of bone, or the share of the largest piece where that is small. What is smaller is a calcified vessel or a speck."""

SMALLEST_FIND = 0.2
"""cm3 that the largest piece has at least, or there is no bone."""

BRIGHTEST, BRIGHTEST_WITHIN = 1500.0, 2.0
"""HU up to which, and mm within which, the densest voxel counts for where the surface is."""

CLOSED = 3.0
"""mm of openings in the cortex that are closed before its inside is filled."""

BYTES_PER_VOXEL = 24


def labels_from_ct(
    ct: Volume | ArrayLike,
    above: float | None = None,
    *,
    ijk_to_reference: ArrayLike | None = None,
    progress: Progress | None = None,
) -> Labels:
    """The bone of a CT, each vertebra with a label of its own where they can be told apart by shape, else one label.

    Parameters
    ----------
    ct : Volume, or [k, j, i] array_like
        Hounsfield units, in RAS: the labels' axes are taken as the patient's.
    above : float or None, HU
        What is bone. By default it is found in the CT, and the surface lies where a voxel is halfway between soft tissue and the densest
        bone beside it.
    ijk_to_reference : (4, 4) array_like, mm, or None
        Where the voxels of an array are; a `Volume` knows it.

    Returns
    -------
    Labels
        On the voxels of the CT, or on blocks of them where they are finer than 0.6 mm. Its notes say the threshold and what was left out.

    Raises
    ------
    GeometryError
        When values are no Hounsfield units, or there is no bone.
    SettingsError
        When the threshold is none of bone.
    InputTypeError
        When the CT is neither a volume nor an array with its matrix.

    Notes
    -----
    The threshold is 150 HU above the peak of soft tissue in the histogram, or six times its width where noise is strong. Of what is above
    it, that is not bone which lies within 4 mm of the outer air or outside the body (table), is above 2500 HU (metal), is even, thick and
    has no denser shell (contrast), or is a small piece by itself (calcified vessels, specks). Holes in the cortex up to 3 mm are closed and
    its inside filled.
    """
    volume = as_volume(ct, ijk_to_reference, "ct")
    if above is not None and not 50 <= above <= METAL:
        raise SettingsError(f"Input above must be 50 to {METAL:g} HU; got {above!r}.")
    require_memory(volume.grid.size, volume.spacing, BYTES_PER_VOXEL, most=LARGEST_GRID)
    report(progress, 0.0, "Looking for bone in the CT")
    work = _in_blocks(volume, np.maximum(np.floor(2 * FINEST / volume.spacing), 1).astype(int))
    values: Singles = work.array.astype(np.float32, copy=False)
    tissue, found = soft_tissue(values)
    threshold = found if above is None else float(above)
    notes = [f"Bone is what is above {threshold:g} HU" + (", found in the CT." if above is None else ".")]
    report(progress, 0.1, "Looking for bone in the CT")
    coarse = _Coarse(work, threshold, tissue)
    candidate = (values > threshold) & coarse.fine(coarse.deep())
    if not candidate.any():
        raise _no_bone(threshold, above)
    # All that follows concerns the box around what is dense
    box = box_around(candidate, np.ceil(8.0 / work.spacing[::-1]).astype(int))
    candidate, values, cubic = candidate[box], values[box], float(work.spacing.prod()) / 1000
    report(progress, 0.3, "Looking for bone in the CT")
    contrast = coarse.contrast()
    if contrast.any():
        candidate &= ~coarse.fine(contrast)[box]
        notes.append("Contrast medium was left out.")
    metal = values > METAL
    if np.count_nonzero(metal) * cubic >= LEAST_METAL:
        near = scipy.ndimage.distance_transform_edt(~metal, work.spacing[::-1]) <= BESIDE_METAL
        candidate &= ~near
        notes.append(f"Metal was left out ({np.count_nonzero(metal) * cubic:.1f} cm3): bone beside it is uncertain.")
    report(progress, 0.5, "Looking for bone in the CT")
    bone = _pieces(candidate, cubic)
    if bone is None:
        raise _no_bone(threshold, above)
    if above is None:
        _trim(bone, values, tissue, work.spacing)
        kept = _pieces(bone, cubic)
        bone = bone if kept is None else kept
    report(progress, 0.6, "Looking for bone in the CT")
    bone |= _cavities(bone, work.spacing)
    report(progress, 0.8, "Telling vertebrae apart")
    numbers, told = in_vertebrae(bone, work, box)
    array = np.zeros(work.shape, np.uint8)
    array[box] = numbers
    names = {n: f"vertebra {n}" for n in range(1, told + 1)} if told else {1: "bone"}
    if told:
        names |= {told + 1: "other bone"} if (numbers > told).any() else {}
        notes.append(f"{told} vertebrae were told apart by their shape; 1 is the uppermost.")
    else:
        notes.append("Vertebrae were not told apart, so bone moves as one piece and coverage is not told for each.")
    report(progress, 1.0, "Found the bone of the CT")
    return Labels(array, work.ijk_to_reference, {}, names, tuple(notes))


def _no_bone(threshold: float, above: float | None) -> GeometryError:
    given = "" if above is None else ", which was given"
    return GeometryError(f"There is no bone in the CT: nothing above {threshold:g} HU{given} is larger than {SMALLEST_FIND:g} cm3.")


def _in_blocks(volume: Volume, factors: Integers) -> Volume:
    """The means of whole blocks of so many voxels along i, j, k; float32."""
    array: Singles = volume.array.astype(np.float32, copy=False)
    if (factors == 1).all():
        return Volume(array, volume.ijk_to_reference)
    factors = np.minimum(factors, volume.grid.size)
    means = block_sums(array, factors[::-1], np.float32) / np.float32(factors.prod())
    to_volume = np.diag([*factors.astype(float), 1.0])
    to_volume[:3, 3] = (factors - 1) / 2
    return Volume(means, volume.ijk_to_reference @ to_volume)


class _Coarse:
    """The CT in blocks of some 2 mm, where shapes are told: body, table, contrast."""

    def __init__(self, work: Volume, threshold: float, tissue: float):
        self._factors = np.maximum(np.round(COARSE / work.spacing), 1).astype(int)
        blocks = _in_blocks(work, self._factors)
        self._values: Singles = blocks.array.astype(np.float32)
        self._spacing: Floats = blocks.spacing[::-1]
        self._shape, self._threshold, self._tissue = work.shape, threshold, tissue

    def fine(self, mask: Mask) -> Mask:
        """A mask of blocks on the voxels."""
        k, j, i = (int(n) for n in self._factors[::-1])
        wide = mask.repeat(k, 0).repeat(j, 1).repeat(i, 2)
        missing = [(0, max(want - have, 0)) for want, have in zip(self._shape, wide.shape)]
        out: Mask = np.pad(wide, missing, mode="edge")[: self._shape[0], : self._shape[1], : self._shape[2]]
        return out

    def deep(self) -> Mask:
        """Blocks of the body, some mm below its surface."""
        solid = self._values > AIR
        if solid.all():
            return solid
        inner = scipy.ndimage.distance_transform_edt(solid, self._spacing) > OPENED
        labels, count = scipy.ndimage.label(inner)
        if not count:
            return np.zeros_like(solid)
        body = labels == 1 + int(np.bincount(labels.ravel())[1:].argmax())
        body = solid & (scipy.ndimage.distance_transform_edt(~body, self._spacing) <= OPENED)
        for plane in body:
            scipy.ndimage.binary_fill_holes(plane, output=plane)
        if body.all():
            return body
        below: Mask = scipy.ndimage.distance_transform_edt(body, self._spacing) > SKIN
        return below

    def contrast(self) -> Mask:
        """Blocks of contrast medium, with a rim."""
        dense = self._values > self._threshold
        core = scipy.ndimage.binary_erosion(dense, np.ones((3, 3, 3), bool))
        labels, count = scipy.ndimage.label(core)
        found = np.zeros_like(core)
        if not count:
            return found
        brightest = scipy.ndimage.maximum_filter(self._values, 5)
        numbers = np.arange(1, count + 1)
        volume = np.bincount(labels.ravel(), minlength=count + 1)[1:] * self._spacing.prod() / 1000
        mean, spread, shell = (
            np.atleast_1d(of(values, labels, numbers))
            for of, values in (
                (scipy.ndimage.mean, self._values),
                (scipy.ndimage.standard_deviation, self._values),
                (scipy.ndimage.mean, brightest),
            )
        )
        above = mean - self._tissue
        is_contrast = (volume >= LEAST_CONTRAST) & (mean < DENSEST_CONTRAST) & (spread < UNEVEN * above)
        is_contrast &= shell - self._tissue < BRIGHTER * above
        found = np.isin(labels, numbers[is_contrast])
        return scipy.ndimage.binary_dilation(found, np.ones((3, 3, 3), bool), iterations=3, mask=dense | found) if found.any() else found


def _pieces(candidate: Mask, cubic: float) -> Mask | None:
    """The pieces that are large enough for bone; None where there is none. `cubic` is the cm3 of a voxel."""
    labels, _ = scipy.ndimage.label(candidate, np.ones((3, 3, 3), bool))
    volumes = np.bincount(labels.ravel()) * cubic
    volumes[0] = 0
    if volumes.max() < SMALLEST_FIND:
        return None
    kept: Mask = (volumes >= min(LEAST_BONE, LEAST_SHARE * volumes.max()))[labels]
    return kept


def _trim(bone: Mask, values: Singles, tissue: float, spacing: Floats) -> None:
    """Take off the voxels at the surface that are less than halfway from soft tissue to the densest bone beside them."""
    reach = 2 * np.maximum(np.round(BRIGHTEST_WITHIN / spacing[::-1]), 1).astype(int) + 1
    densest = np.minimum(scipy.ndimage.maximum_filter(np.where(bone, values, np.float32(tissue)), tuple(reach)), BRIGHTEST)
    less = values < (densest + tissue) / 2
    for _ in range(2):
        edge = bone & ~scipy.ndimage.binary_erosion(bone, border_value=1)
        bone &= ~(edge & less)


def _cavities(bone: Mask, spacing: Floats) -> Mask:
    """What lies within the cortex, also where that has small openings."""
    steps = spacing[::-1]
    padded = np.pad(bone, [(int(np.ceil(CLOSED / step)) + 1,) * 2 for step in steps])
    away = scipy.ndimage.distance_transform_edt(~padded, steps)
    closed = scipy.ndimage.distance_transform_edt(away <= CLOSED, steps) > CLOSED
    closed |= padded
    cavity = scipy.ndimage.binary_fill_holes(closed) & ~closed
    if cavity.any():
        cavity |= closed & (scipy.ndimage.distance_transform_edt(~cavity, steps) <= CLOSED + steps.max())
    cavity |= scipy.ndimage.binary_fill_holes(padded) & ~padded
    inner = tuple(slice(int(np.ceil(CLOSED / step)) + 1, -(int(np.ceil(CLOSED / step)) + 1)) for step in steps)
    found: Mask = cavity[inner]
    return found
