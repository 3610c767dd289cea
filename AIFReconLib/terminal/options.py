"""Arguments that several commands share beside those of a recipe; and outputs that must not replace inputs."""

from __future__ import annotations

import argparse
import contextlib
import sys
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import TypeAlias

from ..arrays import Matrix
from ..bone.ct.from_ct import labels_from_ct
from ..errors import AIFReconError, OutputError, SettingsError
from ..evaluation.visibility import BEAM_THICKNESS
from ..geometry.labels import Labels
from ..io.disk.atomic import check_writable
from ..io.disk.regular_files import files_in
from ..io.metafile.opening import data_files
from ..io.plus.configuration import read_plus_configuration
from ..io.sequence.files import recording_kind
from ..io.transform.files import read_transform
from ..io.volume.dicom_series import read_ct, series_files
from ..io.volume.files import sidecar_of, suffix_of
from ..io.volume.label_files import LABEL_SUFFIXES, doubts, read_labels
from ..io.volume.models import LPS, RAS, UNITS
from ..message import Sentence
from ..progress import Progress
from ..remedies import CHOOSE_LABELS
from .console import real_path
from .one_line_parser import FilesAction, OneLineParser

Commands: TypeAlias = "argparse._SubParsersAction[OneLineParser]"
"""What a command adds itself to."""


def add_placing_options(group: argparse._ActionsContainer) -> None:
    """How a CT is laid on a sweep, and when the answer is taken."""
    group.add_argument("--per-segment", action="store_true", help="let each label move on its own: the spine has bent since the CT")
    group.add_argument("--level", type=int, metavar="N", help="write the place N levels higher (negative: lower) than the best one")
    group.add_argument("--accept", action="store_true", help="write the best place even if it is ambiguous or does not agree")


def add_beam_option(group: argparse._ActionsContainer) -> None:
    """How wide beams are where the bone that they reach is looked for."""
    group.add_argument(
        "--beam-thickness",
        type=float,
        default=BEAM_THICKNESS,
        metavar="MM",
        help="width of the beams across the image plane (default: %(default)g)",
    )


LONGEST_NAME = 4096
"""Characters of a path, at most."""


def refuse_to_overwrite(arguments: argparse.Namespace, *outputs: str, more: Iterable[Path] = ()) -> None:
    """Stop before work begins when an output is a file that is read, or two outputs are one file.

    What any other option names is read, and so are the files that its reader opens beside it: see `_opened_with`.

    Parameters
    ----------
    arguments : Namespace
    outputs : str
        Names of the options that say what is written.
    more : iterable of Path
        What else is written.
    """
    inputs = [path for name, value in vars(arguments).items() if name not in outputs for path in _paths(value)]
    seen = {each: "an input" for path in inputs for file in [path, *_opened_with(path)] for each in _identities(file)}
    folders = {each for path in inputs if path.is_dir() for each in _identities(path)}
    for path in [*(path for name in outputs for path in _paths(getattr(arguments, name))), *more]:
        files = {each: file for file in [path, *_companions(path)] for each in _identities(file)}
        for each, file in files.items():
            within = file.exists() and any(folders & _identities(parent) for parent in real_path(file).parents)
            if each in seen or within or _is_slice_of(file, inputs):
                raise OutputError(f"{path} would overwrite {seen.get(each, 'an input')} ({file.name}). Choose another name.")
        seen |= dict.fromkeys(files, "another output")


def check_files(*paths: Path | None) -> None:
    """Return if all of these that are given can be written; to be asked before a long computation."""
    for path in filter(None, paths):
        check_writable(path)


def _paths(value: object) -> list[Path]:
    """The paths in the value of an option; a text is one where there is a file of that name, behind its NAME= too."""
    if isinstance(value, Path):
        return [value]
    if isinstance(value, str):
        return [path for word in {value, value.partition("=")[2]} if word and len(word) < LONGEST_NAME and (path := Path(word)).is_file()]
    if isinstance(value, dict):
        value = list(value.values())
    return [path for each in value for path in _paths(each)] if isinstance(value, list | tuple) else []


def _identities(path: Path) -> set[object]:
    """By what a file is known: its name without links and, where it is there, what the disk calls it under all its names."""
    names: set[object] = {as_compared(real_path(path))}
    with contextlib.suppress(OSError, ValueError):
        status = path.stat()
        if status.st_ino:
            names.add((status.st_dev, status.st_ino))
    return names


def _opened_with(path: Path) -> list[Path]:
    """What is read with a file: the rest of a recording, a header's data, what NIfTI has no room for, a network's description, a mask."""
    kind = None if path.is_dir() else recording_kind(path)
    files = [*([] if kind is None else kind.files(path)), *data_files(path)]
    if path.name.lower().endswith((".nii", ".nii.gz", ".onnx")):
        files.append(sidecar_of(path))
    try:
        mask = read_plus_configuration(path).importance_mask if path.suffix.lower() == ".xml" else None
    except AIFReconError:
        mask = None
    return [file for file in (*files, mask) if file is not None and file.is_file()]


def _is_slice_of(file: Path, inputs: list[Path]) -> bool:
    """Whether a file is there and belongs to the DICOM series of which an input is one file."""
    beside = [path for path in inputs if file.is_file() and path.is_file() and real_path(path).parent == real_path(file).parent]
    return any(real_path(file) in map(real_path, series_files(path)) for path in beside)


def as_compared(path: Path) -> str:
    """A name as the disk compares it: on Windows and macOS Sweep.mha is sweep.mha."""
    return str(path).casefold() if sys.platform in ("win32", "darwin") else str(path)


def _companions(path: Path) -> list[Path]:
    """What is written beside `path`: a .mhd header has its voxels in a .raw or .zraw file, NIfTI what its header has no room for."""
    if path.name.lower().endswith((".nii", ".nii.gz")):
        return [sidecar_of(real_path(path))]
    return [real_path(path).with_suffix(suffix) for suffix in (".raw", ".zraw")] if path.suffix.lower() == ".mhd" else []


# ---- bone of a CT


def add_labels_options(
    group: argparse._ActionsContainer, source: argparse._ActionsContainer | None = None, *names: str, several: bool = True
) -> None:
    """Where a CT's bone is: labels in files, or the CT itself; `names` stand for --bone-labels where it has others too.

    `source` is the group of what excludes labels, where there is such.
    """
    (source or group).add_argument(
        *(names or ("--bone-labels",)),
        dest="bone_labels",
        type=Path,
        action=FilesAction,
        belongs=looks_like_labels if several else lambda word: False,
        metavar="FILE",
        help="segmentation of the CT: a volume of labels, one for each bone; or a folder or several files of masks and models (.stl, .ply, "
        ".obj, .vtp, .vtk), named by their bone",
    )
    group.add_argument(
        "--labels",
        metavar="WHICH",
        help="which labels are bone, by numbers or names: 27-31, or L3,L4 (default: all but other organs)",
    )
    group.add_argument(
        "--ct",
        type=Path,
        metavar="CT",
        help="the CT, a volume or a folder of DICOM: without labels its bone is found in it",
    )
    group.add_argument("--bone-above", type=float, metavar="HU", help="what is bone in the CT (default: found in it)")
    group.add_argument(
        "--bone-space",
        choices=(RAS, LPS),
        help="what models are in that do not say it (default: told by the sweep)",
    )
    group.add_argument("--bone-unit", choices=UNITS, help="unit of models (default: mm, where their size is one that bone has)")


def looks_like_labels(word: str) -> bool:
    """Whether a word behind --bone-labels may be one more file of them."""
    path = Path(word)
    recording = any(mark in path.name.lower() for mark in (".igs.", ".seq."))
    return path.is_dir() or (not recording and suffix_of(path) in LABEL_SUFFIXES)


def names_labels(arguments: argparse.Namespace) -> bool:
    """Whether labels are given, or a CT in which they are found: one is only looked at where something else says where bone is."""
    others = ("bone_probability", "bone_from_sweep", "bone_frames", "bone_model", "bone_image")
    return bool(arguments.bone_labels or (getattr(arguments, "ct", None) and not any(getattr(arguments, name, None) for name in others)))


def labels_inputs(arguments: argparse.Namespace) -> list[Path]:
    """The files of labels and CT, those within folders one by one."""
    given = [*(arguments.bone_labels or []), *([arguments.ct] if getattr(arguments, "ct", None) else [])]
    return [file for path in given for file in (files_in(path) if path.is_dir() else [path])]


def labels_from(arguments: argparse.Namespace, progress: Progress | None = None) -> Labels | None:
    """The labels that the options name, or find in the CT, with notes that say what a user should know; None where they name none.

    Raises SettingsError when options do not go together.
    """
    chosen, ct, above = arguments.labels, getattr(arguments, "ct", None), getattr(arguments, "bone_above", None)
    if above is not None and (arguments.bone_labels or not ct):
        raise SettingsError("--bone-above says what is bone in a CT of which there are no labels. Give --ct alone, or leave it out.")
    if not names_labels(arguments):
        if chosen:
            raise SettingsError("--labels chooses among labels, and there are none. Give --bone-labels.")
        return None
    if not arguments.bone_labels:
        found = labels_from_ct(read_ct(arguments.ct), above, progress=progress)
        return found.chosen(chosen) if chosen else found
    labels = read_labels(arguments.bone_labels, chosen, space=arguments.bone_space, unit=arguments.bone_unit)
    more = [Sentence(f"WARNING: {doubt}", CHOOSE_LABELS) for doubt in doubts(labels, read_ct(ct) if ct else None)]
    return replace(labels, notes=(*labels.notes, *more))


def place_from(arguments: argparse.Namespace) -> Matrix | None:
    """The transform of --bone-transform; None where there is none."""
    return read_transform(arguments.bone_transform) if arguments.bone_transform else None


def required_labels(arguments: argparse.Namespace, progress: Progress | None = None) -> Labels:
    """The same where there must be some."""
    labels = labels_from(arguments, progress)
    if labels is None:
        raise SettingsError("The CT's bone is needed. Give --bone-labels, or --ct.")
    return labels
