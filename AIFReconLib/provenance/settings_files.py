"""Settings files (JSON, TOML), and volumes that say how they were made: both say what `--settings` repeats."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from .. import __version__
from ..errors import FileFormatError, OutputError
from ..io.disk.atomic import check_writable, write_text
from ..io.disk.tables import JSON, TOML, parse_table, read_table
from ..io.metafile.opening import METAIMAGE_SUFFIXES, NRRD_SUFFIXES, read_metafile
from ..recipe.recipe import Recipe
from .record import SETTINGS, VERSION, inputs_in
from .settings_schema import KeptSettings, understood

VOLUME_SUFFIXES = (*NRRD_SUFFIXES, *METAIMAGE_SUFFIXES)
WRITTEN_BY = "version"
"""Key of a settings file for the version that wrote it."""

_MEND = "Correct it, or have it written anew."


def read_settings(path: str | Path) -> KeptSettings:
    """The settings in a file.

    Raises FileFormatError when it cannot be read, or a setting is not known or not of its kind; names file, key and remedy.

    Parameters
    ----------
    path : str or Path
        .json or .toml, as `write_settings` writes them; or a volume (.nrrd, .nhdr, .mha, .mhd) that says how it was made.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    inputs: tuple[Mapping[str, object], ...] = ()
    if suffix in VOLUME_SUFFIXES:
        header = read_metafile(path, FileFormatError).fields
        if SETTINGS not in header:
            raise FileFormatError(
                f"{path}: this volume does not say how it was made. Give one that AIFRecon wrote, or a settings file (.json, .toml)."
            )
        table = {WRITTEN_BY: header.get(VERSION, ""), **_named(path, parse_table(path, header[SETTINGS], JSON, FileFormatError, _MEND))}
        inputs = tuple(inputs_in(header))
    elif suffix in (JSON, TOML):
        table = _named(path, read_table(path, FileFormatError, _MEND))
    else:
        raise FileFormatError(
            f"{path}: settings are read from .json, .toml, {', '.join(VOLUME_SUFFIXES)}. Give such a file; others have no room for "
            "settings."
        )
    version = table.pop(WRITTEN_BY, "")
    return understood(path, {key.replace("-", "_"): value for key, value in table.items()}, str(version), inputs)


def made_with(path: Path) -> Recipe | None:
    """The settings that a volume was reconstructed with; None where its file does not say so, or not as it is understood here."""
    try:
        return read_settings(path).recipe
    except FileFormatError:
        return None


def write_settings(settings: Mapping[str, object], path: str | Path) -> None:
    """Write settings, as `kept_settings` returns them, completely or not at all.

    Raises OutputError when the suffix is another, or the file cannot be written.

    Parameters
    ----------
    settings : mapping
    path : str or Path
        .json or .toml.
    """
    table = {WRITTEN_BY: __version__, **{name: settings[name] for name in sorted(settings)}}
    if _writable_suffix(path) == JSON:
        lines = [f"  {json.dumps(name)}: {json.dumps(value)}" for name, value in table.items()]
        write_text(path, "{\n" + ",\n".join(lines) + "\n}\n")
    else:
        # What JSON has for these values TOML has too, but for one character that it wants escaped
        lines = [f"{name} = {json.dumps(value, ensure_ascii=False)}\n" for name, value in table.items()]
        write_text(path, "".join(lines).replace("\x7f", "\\u007f"))


def check_settings_path(path: str | Path) -> None:
    """Return if settings can be written to `path`; to be asked before a long computation.

    Raises OutputError otherwise.
    """
    _writable_suffix(path)
    check_writable(path)


def _writable_suffix(path: str | Path) -> str:
    suffix = Path(path).suffix.lower()
    if suffix not in (JSON, TOML):
        raise OutputError(f"Cannot write {path}: settings are written as .json or .toml. Choose another name.")
    return suffix


def _named(path: Path, table: object) -> dict[str, object]:
    if not isinstance(table, dict):
        raise FileFormatError(f'{path}: settings are names and values, as {{"alpha": 0.1}}. Correct the file.')
    return table
