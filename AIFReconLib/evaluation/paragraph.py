"""A paragraph for the methods section of a paper: what was done, with all settings, and what to cite."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import cast

from .. import __version__
from ..compounding.methods.table import METHODS, method_named
from ..compounding.methods.weighted import WEIGHTED
from ..errors import FileFormatError
from ..io.metafile.opening import read_metafile
from ..message import listed
from ..provenance.record import made_in_header
from ..provenance.settings_files import VOLUME_SUFFIXES
from ..recipe.recipe import AUTOMATIC, RULES
from .cases import DRAWS, FEW, FEWEST, LEVEL
from .quantities import OBLIQUE, OF_SURFACE, OF_VOLUME

OF_THE_PAPER = ("aif", "aif-compensated")
"""Methods that `CITATION` is of."""

CITATION = (
    "B. Jiang, K. Xu, A. Moghekar, P. Kazanzides and E. Boctor, Insonification Angle-based Ultrasound Volume Reconstruction for Spine "
    "Intervention."
)
PROGRAM = f"AIFRecon {__version__}"
ITSELF = f"The AIFRecon contributors, {PROGRAM}: insonification-angle-based ultrasound volume reconstruction, BSD-3-Clause."

OVER_CASES = "Numbers are mean and standard deviation over {} cases; differences are paired"
INTERVALS = f"with {LEVEL:.0%} confidence intervals by the percentile bootstrap over cases ({DRAWS:,} draws{{}})"
NO_INTERVALS = f"of fewer than {FEWEST} cases without confidence intervals"
TOO_NARROW = f"; of fewer than {FEW} cases they are too narrow"

FILLED = "Gaps between frames, up to the hole limit, are filled from their neighbors and count in the numbers."

BRIGHTENS = {
    "bone_gain": "multiplies a pixel of sure bone by 1 + this x C, C from 1 to 3 the more obliquely the beam meets it",
    "alpha": "multiplies a pixel by 1 + this x the method's weight by angle and probability of bone",
}
"""What such a setting does to bone, and so to every number that compares bone with tissue."""

_FOUND = ("found", "frames", "inputs", "grid_to_reference", "grid_size", "gray_levels", "hole_limit", "bone_sigma_mm", "bone_belief")
"""What is found for each recording."""

_LEFT_OUT = ("method", "engine", "frames", "inputs", "grid_to_reference", "gray_levels", "found", "simulated")
"""What is told apart, or of no concern: where a box lies, the images' own levels, the engine."""


def made_in_words(name: str, settings: Mapping[str, object]) -> str:
    """How a volume was made, by the settings in its header."""
    method = str(settings["method"])
    words = f" ({method_named(method).words})" if method in METHODS else ""
    more = {**BRIGHTENS, **dict.fromkeys(cast("list[str]", settings.get("found", [])), "found")}
    told = {key: setting_in_words(key, value) for key, value in settings.items() if key not in _LEFT_OUT}
    values = (f"{words} ({more[key]})" if key in more else words for key, words in told.items())
    made_from = [
        f"{settings['frames']} frames" if settings.get("frames") else "",
        listed(map(str, cast("list[str]", settings.get("inputs", [])))),
    ]
    whence = " of ".join(filter(None, made_from))
    source = " [2]" if method in OF_THE_PAPER else ", of AIFRecon [1]" if method == WEIGHTED.name else ""
    return f"{name} by the method {method}{words}{source}, {f'from {whence}, ' if whence else ''}with {listed(values)}"


def setting_in_words(key: str, value: object) -> str:
    """A setting by its name, with its unit."""
    if key == "bone_sigma_mm" and value == AUTOMATIC:
        return "the bone of the sweep's own echoes"
    numbers = value if isinstance(value, list | tuple) else [value]
    unit = "mm" if key.endswith("_mm") else RULES[key]["unit"] if key in RULES else ""
    words = " x ".join(f"{n:g}" if isinstance(n, float) else str(n) for n in numbers)
    return " ".join(filter(None, [key.removesuffix("_mm").replace("_", " "), words, unit]))


def unlike_settings(volumes: Mapping[str, Mapping[str, Path]]) -> list[str]:
    """Settings with which a volume was not made in all cases, a phrase each; not what follows from a recording.

    `volumes` are files by the name of the volume, and by the case.
    """
    told = []
    for volume, paths in volumes.items():
        # Of many cases the headers alone
        files = {case: path for case, path in paths.items() if path.suffix.lower() in VOLUME_SUFFIXES and path.is_file()}
        made = {case: made_in_header(read_metafile(path, FileFormatError).fields) for case, path in files.items()}
        for key in dict.fromkeys(key for settings in made.values() for key in settings):
            cases: dict[str, list[str]] = {}
            for case, settings in made.items():
                value = settings.get(key)
                words = "" if key in _FOUND and value != AUTOMATIC else f"no {key}" if value is None else setting_in_words(key, value)
                cases.setdefault(words, []).append(case)
            if len(cases) > 1:
                told.append(f"{volume}: {listed(f'{words or key} in {listed(names)}' for words, names in cases.items())}")
    return told


def methods_paragraph(made: Mapping[str, Mapping[str, object]], measured: str, own_bone: Iterable[str], cases: int = 1) -> str:
    """The paragraph, and what it cites below it.

    Parameters
    ----------
    made : mapping of str to mapping
        The settings of each volume, as its header has them; volumes that do not say them are told to be unknown.
    measured : str
        What they were measured against, in a sentence.
    own_bone : iterable of str
        Volumes that were measured against the bone that weighted their frames.
    """
    intervals = NO_INTERVALS if cases < FEWEST else INTERVALS.format(TOO_NARROW if cases < FEW else "")
    if cases > 1:
        # Boxes differ with the patients
        made = {name: {key: value for key, value in each.items() if key != "grid_size"} for name, each in made.items()}
    known = listed((made_in_words(name, settings) for name, settings in made.items() if settings), "; ")
    unknown = listed(name for name, settings in made.items() if not settings)
    parts = [
        f"Volumes were reconstructed from tracked 2D ultrasound with {PROGRAM} [1], which follows [2]: {known}." if known else "",
        f"How {unknown} was made is not known." if unknown else "",
        FILLED if any(each.get("hole_limit") for each in made.values()) else "",
        "The recordings are simulated." if any(each.get("simulated") for each in made.values()) else "",
        measured,
        *(f"{each.label} ({key}): {each.definition}" for key, each in {**OF_SURFACE, **OF_VOLUME}.items()),
        f"{OBLIQUE[:1].upper()}{OBLIQUE[1:]}.",
        f"The bone that {listed(own_bone)} was measured against had weighted its frames." if own_bone else "",
        f"{OVER_CASES.format(cases)}, {intervals}." if cases > 1 else "",
    ]
    return " ".join(filter(None, parts)) + f"\n\n[1] {ITSELF}\n[2] {CITATION}\n"
