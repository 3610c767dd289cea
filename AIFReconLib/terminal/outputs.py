"""Outputs never replace inputs, nor each other."""

from __future__ import annotations

import contextlib
import json
import os
import sys
from collections.abc import Iterable
from pathlib import Path

from ..errors import AIFReconError, OutputError, SettingsError
from ..io.disk.atomic import check_writable, write_text
from ..io.metafile.opening import data_files
from ..io.plus.configuration import read_plus_configuration
from ..io.sequence.files import recording_kind
from ..io.volume.dicom_series import series_files
from ..io.volume.files import sidecar_of
from ..io.volume.surfaces import check_surface_path
from .arguments import Options, declared
from .remedies import in_options

LONGEST_NAME = 4096
"""Characters of a path, at most."""

TEXTS = (".csv", ".html", ".htm", ".json", ".txt", ".xml")
"""Kinds of files that only such a file may make way for."""


def check_picture(path: Path) -> None:
    """Return if a picture can be drawn to `path`."""
    from ..evaluation.figures import require_matplotlib

    if path.suffix.lower() != ".png":
        raise SettingsError(f"{path}: a preview is a PNG picture. Choose a name that ends with .png.")
    require_matplotlib()


CHECKS = {".png": check_picture, ".vtp": check_surface_path}
"""By how a command's help has the name of a file end: what returns if it can be written."""


def tell(first: str, lines: Iterable[object] = (), written: Iterable[Path | None] = ()) -> None:
    """Print what was found, a line each, and the files that were written."""
    print("\n  ".join([in_options(first), *map(in_options, lines), *(f"wrote {path}" for path in written if path)]))


def write_json(path: Path | None, facts: object) -> None:
    """Write a report, where one is asked for."""
    if path is not None:
        write_text(path, json.dumps(facts, indent=2) + "\n")


def check_outputs(asked: Options, more: Iterable[Path] = ()) -> None:
    """Stop before work begins when an output cannot be written, is a file that is read, or two outputs are one file.

    What any option names that is no output is read, and so are the files that its reader opens beside it: see `_opened_with`.

    Parameters
    ----------
    asked : Options
    more : iterable of Path
        What else is written.
    """
    options = [each for each in declared(type(asked)) if each.is_output]
    outputs = [each.name for each in options]
    inputs = [path for name, value in vars(asked).items() if name not in (*outputs, "log") for path in paths_in(value)]
    seen = {each: "an input" for path in inputs for file in [path, *_opened_with(path)] for each in _identities(file)}
    folders = {each for path in inputs if path.is_dir() for each in _identities(path)}
    written = [path for name in outputs for path in paths_in(getattr(asked, name))]
    for path in [*written, *more]:
        files = {each: file for file in [path, *_companions(path)] for each in _identities(file)}
        for each, file in files.items():
            within = file.exists() and any(folders & _identities(parent) for parent in real_path(file).parents)
            if each in seen or within or _is_slice_of(file, inputs):
                raise OutputError(f"{path} would overwrite {seen.get(each, 'an input')} ({file.name}). Choose another name.")
        seen |= dict.fromkeys(files, "another output")
    for each in options:
        for path in paths_in(getattr(asked, each.name)):
            wanted = Path(each.words.get("metavar", "")).suffix
            if wanted in CHECKS:
                CHECKS[wanted](path)
            if wanted in TEXTS and path.exists() and path.suffix.lower() not in TEXTS:
                raise OutputError(f"{path} is a file of another kind, and would be overwritten. Choose a name that ends with {wanted}.")
    for path in written:
        check_writable(path)


def paths_in(value: object) -> list[Path]:
    """The paths in the value of an option; a text is one where there is a file of that name, behind its NAME= too."""
    if isinstance(value, Path):
        return [value]
    if isinstance(value, str):
        return [path for word in {value, value.partition("=")[2]} if word and len(word) < LONGEST_NAME and (path := Path(word)).is_file()]
    return [path for each in value for path in paths_in(each)] if isinstance(value, list | tuple) else []


def _identities(path: Path) -> set[object]:
    """By what a file is known: its name without links and, where it is there, what the disk calls it under all its names."""
    names: set[object] = {real_path(path)}
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


def real_path(path: Path) -> Path:
    """The path without links, as the disk compares it: on Windows and macOS Sweep.mha is sweep.mha. One that leads in a circle stays."""
    real = os.path.realpath(path)
    return Path(real.casefold() if sys.platform in ("win32", "darwin") else real)


def _companions(path: Path) -> list[Path]:
    """What is written beside `path`: a .mhd header has its voxels in a .raw or .zraw file, NIfTI what its header has no room for."""
    if path.name.lower().endswith((".nii", ".nii.gz")):
        return [sidecar_of(real_path(path))]
    return [real_path(path).with_suffix(suffix) for suffix in (".raw", ".zraw")] if path.suffix.lower() == ".mhd" else []
