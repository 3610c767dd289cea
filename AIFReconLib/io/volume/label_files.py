"""Labels in the forms that exist: one file of many labels, a folder or several files of masks, surface models."""

from __future__ import annotations

import gzip
import re
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import scipy

from ...arrays import Floats, Mask
from ...errors import GeometryError, VolumeFormatError
from ...geometry.labels import SPACE_UNKNOWN, Labels
from ...geometry.solid import inside_of_surface
from ...geometry.transforms import LPS_FROM_RAS, transform_points
from ...geometry.volume import Volume, VoxelGrid
from ...message import listed, message_of
from ...remedies import CHOOSE_LABELS, TAKE_AS_CT
from ..disk.regular_files import files_in
from ..metafile.opening import NRRD_SUFFIXES, read_metafile
from .files import NIFTI_SUFFIXES, READABLE_SUFFIXES, label_volume, suffix_of
from .label_names import SOFT, bone_name, kind_of, mixed, name_by_code, out_of_order, some, with_known_names
from .models import MODEL_SUFFIXES, RAS, read_model

LABEL_SUFFIXES = (*READABLE_SUFFIXES, *MODEL_SUFFIXES)

MODEL_SPACING, MOST_MODEL_VOXELS = 0.5, 3e7
"""mm between the voxels that a model is filled with, and how many there are at most; larger ones get coarser voxels."""

MODEL_MARGIN = 20.0
"""mm of nothing around models, which the bone map reaches into."""

DEEPEST = 28.0
"""mm from the middle of a bone to its surface: 18 in vertebrae, 25 in a femur's head. What is thicker is hardly bone."""

LARGEST_SHARE = 0.25
"""Of a volume that is one bone's."""

LEAST_HU = 200.0
"""HU that the densest tenth of a bone exceeds."""


def read_labels(
    path: str | Path | Iterable[str | Path], labels: str | None = None, *, space: str | None = None, unit: str | None = None
) -> Labels:
    """The labels in one or more files, as whole numbers: 0 is background.

    Parameters
    ----------
    path : str or Path, or several
        A label volume, or a segmentation as Slicer saves it (.seg.nrrd); where its segments overlap, the result is 1 wherever any is.
        Several files, or a folder of them: masks of one bone each, whose names are the files' (``vertebrae_L3.nii.gz`` is L3), files of
        many labels, and surface models (.stl, .ply, .obj, .vtp, .vtk). What lies where another file has its bone already is left out; a
        note says so.
    labels : str or None
        Which are bone, by numbers and names: ``27-31`` or ``L3, L4``. By default all but those that their names, or the numbers of
        TotalSegmentator, VerSe, SPINEPS, TotalSpineSeg and SPIDER, tell to be none; a note says so.
    space : "ras", "lps" or None
        What the coordinates of models are in that do not say it themselves. By default LPS, as Slicer takes them; the labels then know
        that this is a guess.
    unit : "mm", "cm", "m", "in" or None
        Of models. By default mm, where their size is one that bone has.

    Raises
    ------
    VolumeFormatError
        As `read_volume`, when a voxel is not a whole number or is negative, when a folder holds no labels, or a model is not closed.
    GeometryError
        When none of the labels is of that name, or neither names nor numbers tell which are bone.
    """
    given = [Path(path)] if isinstance(path, str | Path) else [Path(one) for one in path]
    inside = {one: [file for file in files_in(one) if suffix_of(file) in LABEL_SUFFIXES] for one in given if one.is_dir()}
    files = [file for one in given for file in inside.get(one, [one])]
    for folder in (folder for folder, found in inside.items() if not found):
        raise VolumeFormatError(f"{folder}: it holds no labels. Give a folder of masks or models ({listed(LABEL_SUFFIXES)}).")
    if not files:
        raise VolumeFormatError("No file of labels was given. Name one, several or a folder.")
    if files == given and len(files) == 1 and suffix_of(files[0]) not in MODEL_SUFFIXES:
        found = _known(files[0], _labels_in(files[0]), labels)
    else:
        found = _masks(files, labels, space, unit)
    return replace(found, notes=(*found.notes, *out_of_order(found)))


def _known(file: Path, labels: Labels, choice: str | None) -> Labels:
    """The bones of one file of labels, its path in front of what is asked."""
    try:
        return with_known_names(labels, choice, str(file))
    except GeometryError as error:
        raise GeometryError(f"{file}: {message_of(error)}", error) from None


def read_label_names(path: str | Path) -> dict[int, str]:
    """What the labels in a file are called, by their numbers, where it says so: Slicer's segmentations (.seg.nrrd), and NIfTI files of
    TotalSegmentator. Else nothing.

    Raises VolumeFormatError when the file cannot be read.
    """
    path = Path(path)
    if suffix_of(path) in NIFTI_SUFFIXES:
        return _nifti_names(path)
    fields = read_metafile(path, VolumeFormatError).fields if suffix_of(path) in NRRD_SUFFIXES else {}
    segments = [key.removesuffix("_Name") for key in fields if re.fullmatch(r"Segment\d+_Name", key)]
    if any(fields.get(f"{segment}_Layer", "0").strip() != "0" for segment in segments):
        return {}  # of several layers `read_labels` keeps no numbers
    numbers = {segment: fields.get(f"{segment}_LabelValue", "").strip() for segment in segments}
    known = {segment: int(number) for segment, number in numbers.items() if re.fullmatch("[0-9]{1,20}", number)}
    return {number: name_by_code(fields[f"{each}_Name"], fields.get(f"{each}_Tags", "")) for each, number in known.items()}


def _nifti_names(path: Path) -> dict[int, str]:
    """The table of labels in the extension of a NIfTI header, between the header and the voxels, of a file that was read."""
    with gzip.open(path) if path.suffix.lower() == ".gz" else open(path, "rb") as file:
        found = re.findall(rb'<Label Key="(\d{1,9})"[^>]*><!\[CDATA\[([^\]]{1,200})\]\]>', file.read(1 << 17))
    return {int(number): name.decode("utf-8", "replace") for number, name in found}


@dataclass(frozen=True, eq=False)
class _Bone:
    """One bone of several: where it is, and its voxels on a grid."""

    name: str
    corners: Floats  #: (n, 3) points in Reference between which it lies, mm
    on: Callable[[VoxelGrid], Mask]
    grid: VoxelGrid | None = None  #: Of a mask


def _masks(files: list[Path], choice: str | None, space: str | None, unit: str | None) -> Labels:
    """Labels 1, 2, ... of masks, models and files of many labels, in the order of the files, single bones first."""
    notes: list[str] = []
    names = {file: file.name[: -len(suffix_of(file))].removesuffix(".seg") for file in files}
    no_bone = [] if choice else [file for file in files if kind_of(names[file]) == SOFT]
    if no_bone:
        notes.append(f"{len(no_bone)} files are no bone by their names and left out: {some([names[file] for file in no_bone])}.")
    guessed = False
    single: dict[Path, _Bone] = {}
    many: list[tuple[Path, Labels]] = []
    for file in (file for file in files if file not in no_bone):
        name = bone_name(names[file])
        if suffix_of(file) in MODEL_SUFFIXES:
            single[file], is_guess = _of_model(file, name, space, unit)
            guessed |= is_guess
            continue
        try:
            labels = _labels_in(file)
        except VolumeFormatError as error:
            if message_of(error).advice != TAKE_AS_CT:
                raise
            notes.append(f"{file.name} is no mask and left out: it holds negative values, as a CT does.")
            continue
        if len(labels.boxes) > 1:
            many.append((file, labels))
        elif labels.boxes:
            single[file] = _of_mask(labels, name, next(iter(labels.boxes)))
    if not choice and (unknown := mixed(names[file] for file in single)):
        told = f"{files[0].parent}: its files {some(unknown)} may be bone or not; their names do not tell."
        raise GeometryError(told, CHOOSE_LABELS)
    if len(many) == 1 and not single:
        found = _known(*many[0], choice)
        return replace(found, notes=(*notes, *found.notes))
    bones = list(single.items())
    for file, labels in many:
        known = labels if choice else _known(file, labels, None)
        notes += known.notes
        bones += [(file, _of_mask(known, known.names.get(number, f"{names[file]} {number}"), number)) for number in known.boxes]
    if not bones:
        raise VolumeFormatError(" ".join([f"{files[0].parent}: no mask of a bone has voxels above 0. Give the folder of bones.", *notes]))
    grid = _common_grid([bone for _, bone in bones])
    array = np.zeros(grid.shape, np.uint8 if len(bones) < 256 else np.uint16)
    called: dict[int, str] = {}
    twice: Counter[str] = Counter()
    for file, bone in bones:
        mask = bone.on(grid)
        if np.count_nonzero(array[mask]) * 2 > np.count_nonzero(mask):
            twice[file.name] += 1
        else:
            called[len(called) + 1] = bone.name
            array[mask & (array == 0)] = len(called)
    notes += [f"{count} bones of {name} lie where other files have theirs, and are left out." for name, count in twice.items()]
    if guessed:
        notes.append(f"{SPACE_UNKNOWN}LPS, as Slicer takes it.")
    found = Labels(array, grid.ijk_to_reference, {}, called, tuple(notes), guessed)
    return with_known_names(found, choice) if choice else found


def _labels_in(file: Path) -> Labels:
    """The labels in one file, with their names as far as it says them."""
    volume = label_volume(file)
    return Labels(volume.array, volume.ijk_to_reference, volume.fields, read_label_names(file))


def _of_mask(labels: Labels, name: str, number: int) -> _Bone:
    """One label of a file."""

    def on(grid: VoxelGrid) -> Mask:
        mask: Mask = labels.array == number
        if grid.matches(labels.grid):
            return mask
        to_mask = (labels.grid.reference_to_ijk @ grid.ijk_to_reference)[:3]
        turned = to_mask[::-1, [2, 1, 0]]
        moved: Mask = scipy.ndimage.affine_transform(mask.view(np.uint8), turned, to_mask[::-1, 3], grid.shape, order=0).view(bool)
        return moved

    return _Bone(name, labels[labels.boxes[number]].grid.corners(), on, labels.grid)


def _of_model(file: Path, name: str, space: str | None, unit: str | None) -> tuple[_Bone, bool]:
    """A model, and whether it is a guess what its coordinates are in."""
    model = read_model(file, unit)
    stated = model.space or space
    points = model.points if stated == RAS else transform_points(LPS_FROM_RAS, model.points)

    def on(grid: VoxelGrid) -> Mask:
        try:
            return inside_of_surface(points, model.triangles, grid)
        except GeometryError as error:
            raise VolumeFormatError(f"{file}: {error} Export the closed surface of the bone.") from error

    return _Bone(name, points[model.triangles.ravel()], on), stated is None


def _common_grid(bones: list[_Bone]) -> VoxelGrid:
    """Voxels for all bones: those of the masks where they are alike, else a box around all, along the axes of the first mask."""
    grids = [bone.grid for bone in bones if bone.grid is not None]
    if len(grids) == len(bones) and all(grid.matches(grids[0]) for grid in grids):
        return grids[0]
    axes = np.eye(3) if not grids else grids[0].ijk_to_reference[:3, :3] / grids[0].spacing
    ends = np.array([(np.min(at, axis=0), np.max(at, axis=0)) for at in (bone.corners @ axes for bone in bones)])
    low, high = ends[:, 0].min(axis=0) - MODEL_MARGIN, ends[:, 1].max(axis=0) + MODEL_MARGIN
    spacing = np.full(3, max(MODEL_SPACING, float(((high - low).prod() / MOST_MODEL_VOXELS) ** (1 / 3)))) if not grids else grids[0].spacing
    size = np.ceil((high - low) / spacing).astype(int) + 1
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = axes * spacing, axes @ low
    return VoxelGrid((int(size[0]), int(size[1]), int(size[2])), matrix)


def doubts(labels: Labels, ct: Volume | None = None) -> list[str]:
    """What speaks against labels being bone, a sentence each: they are too thick, fill too much, or are soft in the CT.

    That is in HU, in the frame of the labels.
    """
    found = []
    steps = np.maximum(np.round(2.0 / labels.spacing[::-1]), 1).astype(int)
    for number, box in labels.boxes.items():
        mask = labels.array[box] == number
        share = np.count_nonzero(mask) / labels.array.size
        coarse = np.pad(mask[tuple(slice(None, None, int(n)) for n in steps)], 1)
        depth = float(scipy.ndimage.distance_transform_edt(coarse, labels.spacing[::-1] * steps).max())
        dense = np.inf if ct is None else _dense(mask, box, labels, ct)
        if dense < LEAST_HU:
            found.append(f"{labels.called(number)} is soft in the CT: nine tenths of it are below {dense:.0f} HU. Is it bone?")
        elif depth > DEEPEST or share > LARGEST_SHARE:
            size = f"is {2 * depth:.0f} mm thick and fills {share:.0%} of the volume"
            found.append(f"{labels.called(number)} {size}. Is it bone?")
    return found


def _dense(mask: Mask, box: tuple[slice, ...], labels: Labels, ct: Volume) -> float:
    """The HU that nine tenths of a label's voxels are below; infinite where the CT does not reach it."""
    kji = np.argwhere(mask)
    kji = kji[:: max(len(kji) // 20000, 1)] + [part.start for part in box]
    ijk = np.rint(transform_points(ct.grid.reference_to_ijk @ labels.ijk_to_reference, kji[:, ::-1].astype(np.float64))).astype(int)
    ijk = ijk[((ijk >= 0) & (ijk < ct.grid.size)).all(axis=1)]
    return float(np.percentile(ct.array[ijk[:, 2], ijk[:, 1], ijk[:, 0]], 90)) if len(ijk) else np.inf
