"""A CT's bone: where the options say that it is, and its labels."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

from ..arrays import Matrix
from ..bone.ct.from_ct import labels_from_ct
from ..errors import SettingsError
from ..geometry.labels import Labels
from ..io.disk.regular_files import files_in
from ..io.sequence.files import recording_kind
from ..io.transform.files import read_transform
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import suffix_of
from ..io.volume.label_files import LABEL_SUFFIXES, doubts, read_labels
from ..io.volume.models import LPS, RAS, UNITS
from ..message import Sentence
from ..progress import Progress
from ..remedies import CHOOSE_LABELS
from .arguments import Options, paths


def looks_like_labels(word: str) -> bool:
    """Whether a word behind --bone-labels may be one more file of them."""
    path = Path(word)
    recording = any(mark in path.name.lower() for mark in (".igs.", ".seq."))
    return (path.is_dir() and recording_kind(path) is None) or (not recording and suffix_of(path) in LABEL_SUFFIXES)


class LabelsOptions(Options):
    """bone: of the CT, by its labels or found in it

    Parameters
    ----------
    bone_labels : FILE
        segmentation of the CT: a volume of labels, one for each bone; or a folder or several files of masks and models (.stl, .ply, .obj,
        .vtp, .vtk), named by their bone
    labels : WHICH
        which labels are bone, by numbers or names: 27-31, or L3,L4 (default: all but other organs)
    ct : CT
        the CT, a volume or a folder of DICOM: without labels its bone is found in it
    bone_above : HU
        what is bone in the CT (default: found in it)
    bone_space
        what models are in that do not say it (default: told by the sweep)
    bone_unit
        unit of models (default: mm, where their size is one that bone has)
    """

    bone_labels: Annotated[list[Path], paths, looks_like_labels] = []
    labels: str | None = None
    ct: Path | None = None
    bone_above: float | None = None
    bone_space: Annotated[str, (RAS, LPS)] | None = None
    bone_unit: Annotated[str, tuple(UNITS)] | None = None


class PlacedLabelsOptions(LabelsOptions):
    """bone: of the CT, by its labels or found in it

    Parameters
    ----------
    bone_transform : FILE
        transform CT -> Reference as Slicer saves it (.tfm, .txt, .h5); default: none needed
    """

    bone_transform: Path | None = None


class PlacingOptions(Options):
    """placing: how a CT is laid on a sweep, and when the answer is taken

    Parameters
    ----------
    per_segment
        let each label move on its own: the spine has bent since the CT
    level : N
        write the place N levels higher (negative: lower) than the best one
    accept
        write the best place even if it is ambiguous or does not agree
    """

    per_segment: bool = False
    level: int | None = None
    accept: bool = False


def names_labels(asked: LabelsOptions) -> bool:
    """Whether labels are given, or a CT in which they are found: one is only looked at where something else says where bone is."""
    others = ("bone_probability", "bone_from_sweep", "bone_frames", "bone_model", "bone_image")
    return bool(asked.bone_labels or (asked.ct and not any(getattr(asked, name, None) for name in others)))


def labels_inputs(asked: LabelsOptions) -> list[Path]:
    """The files of labels and CT, those within folders one by one."""
    given = [*asked.bone_labels, *([asked.ct] if asked.ct else [])]
    return [file for path in given for file in (files_in(path) if path.is_dir() else [path])]


def labels_from(asked: LabelsOptions, progress: Progress | None = None) -> Labels | None:
    """The labels that the options name, or find in the CT, with notes that say what a user should know; None where they name none.

    Raises SettingsError when options do not go together.
    """
    chosen, ct, above = asked.labels, asked.ct, asked.bone_above
    if above is not None and (asked.bone_labels or not ct):
        raise SettingsError("--bone-above says what is bone in a CT of which there are no labels. Give --ct alone, or leave it out.")
    if not names_labels(asked):
        if chosen:
            raise SettingsError("--labels chooses among labels, and there are none. Give --bone-labels.")
        return None
    if not asked.bone_labels and ct:
        found = labels_from_ct(read_ct(ct), above, progress=progress)
        return found.chosen(chosen) if chosen else found
    labels = read_labels(asked.bone_labels, chosen, space=asked.bone_space, unit=asked.bone_unit)
    more = [Sentence(f"WARNING: {doubt}", CHOOSE_LABELS) for doubt in doubts(labels, read_ct(ct) if ct else None)]
    return replace(labels, notes=(*labels.notes, *more))


def place_from(asked: PlacedLabelsOptions) -> Matrix | None:
    """The transform of --bone-transform; None where there is none."""
    return read_transform(asked.bone_transform) if asked.bone_transform else None


def required_labels(asked: LabelsOptions, progress: Progress | None = None) -> Labels:
    """The same where there must be some."""
    labels = labels_from(asked, progress)
    if labels is None:
        raise SettingsError("The CT's bone is needed. Give --bone-labels, or --ct.")
    return labels
