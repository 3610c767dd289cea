"""A paragraph for the methods section of a paper: what was done, with all settings, and what to cite."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import cast

from .. import __version__
from ..compounding.methods.table import METHODS, built_in
from ..message import listed
from ..recipe.recipe import RULES
from .cases import DRAWS, LEVEL
from .quantities import HEADINGS, QUANTITIES

CITATION = (
    "B. Jiang, K. Xu, A. Moghekar, P. Kazanzides and E. Boctor, Insonification Angle-based Ultrasound Volume Reconstruction for Spine "
    "Intervention."
)
ITSELF = f"The AIFRecon contributors, AIFRecon {__version__}: insonification-angle-based ultrasound volume reconstruction, BSD-3-Clause."

OVER_CASES = (
    f"Numbers are mean and standard deviation over {{}} cases; differences are paired, with {LEVEL:.0%} confidence intervals by the "
    f"percentile bootstrap over cases ({DRAWS:,} draws)."
)

_LEFT_OUT = ("method", "frames", "inputs", "grid_to_reference", "gray_levels")
"""What is told apart, and settings that say where a box lies, and what the images' own levels are."""


def made_in_words(name: str, settings: Mapping[str, object]) -> str:
    """How a volume was made, by the settings in its header."""
    method = str(settings["method"])
    words = f" ({built_in(method).words})" if method in METHODS else ""
    values = (
        f"{key.removesuffix('_mm').replace('_', ' ')} {_value(key, value)}" for key, value in settings.items() if key not in _LEFT_OUT
    )
    made_from = [
        f"{settings['frames']} frames" if settings.get("frames") else "",
        listed(map(str, cast("list[str]", settings.get("inputs", [])))),
    ]
    whence = " of ".join(filter(None, made_from))
    return f"{name} by the method {method}{words}, {f'from {whence}, ' if whence else ''}with {listed(values)}"


def _value(key: str, value: object) -> str:
    numbers = value if isinstance(value, list | tuple) else [value]
    unit = "mm" if key.endswith("_mm") else RULES[key]["unit"] if key in RULES else ""
    return " x ".join(f"{n:g}" if isinstance(n, float) else str(n) for n in numbers) + (f" {unit}" if unit else "")


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
    known = listed((made_in_words(name, settings) for name, settings in made.items() if settings), "; ")
    unknown = listed(name for name, settings in made.items() if not settings)
    definitions = {QUANTITIES[key].label: QUANTITIES[key].definition for key in HEADINGS}
    parts = [
        f"Volumes were reconstructed from tracked 2D ultrasound with AIFRecon {__version__} [1, 2]: {known}." if known else "",
        f"How {unknown} was made is not known." if unknown else "",
        measured,
        *(f"{label}: {definition}" for label, definition in definitions.items()),
        f"The bone that {listed(own_bone)} was measured against had weighted its frames." if own_bone else "",
        OVER_CASES.format(cases) if cases > 1 else "",
    ]
    return " ".join(filter(None, parts)) + f"\n\n[1] {CITATION}\n[2] {ITSELF}\n"
