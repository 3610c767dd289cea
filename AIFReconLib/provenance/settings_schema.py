"""What settings say that were kept: names and values understood as those of a recipe, or refused with the name."""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..effective_settings import asked_imaging, imaging_fields
from ..errors import AIFReconError, FileFormatError, SettingsError
from ..imaging.region import ImageRegion
from ..recipe.recipe import KEPT, RULES, Recipe
from ..recipe.rules import expected
from ..sweep.configuration import NO_CONFIGURATION

OF_FAN = {name for name in KEPT if name.startswith("fan_")}


@dataclass(frozen=True)
class KeptSettings:
    """What a settings file, or a volume's header, says.

    Parameters
    ----------
    path : Path
    options : dict of str to object
        Settings by their names. Of a region they are the whole: what a configuration says is not asked any more.
    version : str
        Which wrote it; empty where that is not said.
    inputs : tuple of mappings
        Names and bytes of the files that a volume was made from.
    """

    path: Path
    options: dict[str, Any]
    version: str = ""
    inputs: tuple[Mapping[str, object], ...] = ()

    @property
    def recipe(self) -> Recipe:
        """All of them."""
        return Recipe(**self.options)


def understood(path: Path, table: dict[str, Any], version: str, inputs: tuple[Mapping[str, object], ...]) -> KeptSettings:
    """Names and values of a file as what they mean.

    Raises FileFormatError when a name is not known, or a value is not of its kind or out of its range.
    """
    for name in table:
        if name not in KEPT:
            raise _unknown(path, name)
    if OF_FAN & set(table) or "clip_px" in table:
        nothing = imaging_fields(ImageRegion())
        table = {"clip_px": nothing["clip_px"], **table} if OF_FAN & set(table) else {**nothing, **table}
    try:
        for name, value in table.items():
            if value is None:
                raise SettingsError(f"Input {name} must be {expected(RULES[name])}; got None.")
        recipe = Recipe(**table)
        # What is wrong with a box or a region is said now
        _, _ = recipe.grid, asked_imaging(recipe, NO_CONFIGURATION)
    except AIFReconError as error:
        raise FileFormatError(f"{path}: {error} Correct the file.") from None
    return KeptSettings(path, {name: getattr(recipe, name) for name in table}, version, inputs)


def _unknown(path: Path, name: str) -> FileFormatError:
    near = difflib.get_close_matches(name, KEPT, n=1)
    if near:
        return FileFormatError(f"{path}: there is no setting {name}, perhaps {near[0]} is meant. Correct it.")
    return FileFormatError(f"{path}: there is no setting {name}. Remove it; files and what is printed are given on the command line.")
