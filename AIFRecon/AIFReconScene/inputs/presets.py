"""Settings that go together, under a name that says what they are for."""

import enum

from slicer.i18n import tr as _

from .parameters import PARAMETERS, Method, SigmaUnit, camelCase, defaultOf


class Preset(enum.Enum):
    """What a user wants of a reconstruction."""

    FAST = "fast"
    STANDARD = "standard"
    FINE = "fine"
    PAPER = "paper"

    def label(self) -> str:
        """What the panel shows."""
        return {
            Preset.FAST: _("Fast look"),
            Preset.STANDARD: _("Standard"),
            Preset.FINE: _("Fine"),
            Preset.PAPER: _("As in the paper"),
        }[self]


_STANDARD: dict = {
    **{camelCase(name): defaultOf(name) for name, rule in PARAMETERS.items() if rule["preset"]},
    "ownMethod": "",
    "boneSigma": 10.0,
    "boneSigmaUnit": SigmaUnit.AUTOMATIC,
}
"""The defaults of everything that a preset sets."""

VALUES = {
    Preset.FAST: {**_STANDARD, "spacing": 1.0},
    Preset.STANDARD: _STANDARD,
    Preset.FINE: {**_STANDARD, "spacing": 0.3},
    Preset.PAPER: {**_STANDARD, "method": Method.AIF, "holeLimit": 0.0},
}
"""By preset, the parameters that it sets, by their names. The paper fills nothing in, and its alpha, beta and width are the defaults."""


def presetOf(parameters) -> Preset | None:
    """The preset that the parameters are; None where they are the user's own."""
    return next((preset for preset, values in VALUES.items() if all(_alike(getattr(parameters, k), v) for k, v in values.items())), None)


def choose(parameters, preset: Preset) -> None:
    """Set the parameters to a preset."""
    for name, value in VALUES[preset].items():
        setattr(parameters, name, value)


def _alike(one, other) -> bool:
    return abs(one - other) < 1e-6 if isinstance(other, float) else one == other
