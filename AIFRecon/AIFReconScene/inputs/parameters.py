"""The choices of the panel, made from the library's own list of parameters, and the way back to its settings."""

import enum
from pathlib import Path
from typing import Any

from slicer.i18n import tr as _

from AIFReconLib.compounding.methods.table import METHODS, method_named, registered_methods
from AIFReconLib.errors import AIFReconError
from AIFReconLib.imaging.beams import LINEAR, SECTOR
from AIFReconLib.message import message_of
from AIFReconLib.recipe.recipe import AUTOMATIC, DEFAULT_SPACING, RULES, Recipe
from AIFReconLib.recipe.rules import WHOLE

COMPOSED = {
    *("orientation", "time_offset", "longest_gap", "probe", "apex_px", "clip_px", "fan_angles_deg", "fan_radius_px"),
    *("importance_mask", "bone_sigma_voxels"),
}
"""Settings that more or other fields of the panel stand for than one of their own name."""

PARAMETERS: dict[str, dict[str, Any]] = {name: dict(rule) for name, rule in RULES.items() if rule["label"] and name not in COMPOSED}
"""The rule of every setting that is one field of the panel, by its name in the library."""

PARAMETERS["spacing"]["default"] = DEFAULT_SPACING  # the panel shows a number where the library may be told nothing


AUTOMATIC_NUMBER = -0.5
"""Stands in the panel for a number that the library chooses where a word may be given: a step below 0, and shown as a word."""


class Choice(enum.Enum):
    """What can be chosen; saved in the scene by the member's name."""

    def label(self) -> str:
        """What the panel shows."""
        return _labels()[self]


class SettingChoice(enum.Enum):
    """One word of the library per member, saved in the scene by the member's name; "" leaves the choice to the library."""

    def label(self) -> str:
        """What the panel shows. The library's words are names and stay as they are in every language."""
        return _("automatic") if self.value in ("", "auto") else self.value


def _choices(name: str, setting: str, automatic: bool) -> Any:
    """A `SettingChoice`; Any, as no checker knows members that are made from the library's words."""
    words = PARAMETERS[setting]["choices"]
    members = {word.upper().replace("-", "_"): word for word in words}
    made: Any = SettingChoice
    return made(name, {"AUTOMATIC": "", **members} if automatic else members, module=__name__)


CHOICES: dict[str, Any] = {
    name: _choices("".join(map(str.capitalize, name.split("_"))), name, automatic=rule["default"] is None)
    for name, rule in PARAMETERS.items()
    if rule["choices"]
}
"""The words of every setting that is a choice."""

Method, HoleFilling, Interpolation = (CHOICES[name] for name in ("method", "holes", "interpolation"))


def rangeOf(name: str) -> tuple[float, float | None]:
    """The least and the largest number that the panel's field of a setting takes: with the digits that are shown, and for those that may be
    left open from 0 on, or from a step below it."""
    rule = PARAMETERS[name]
    if rule["word"] is not None:
        return AUTOMATIC_NUMBER, rule["maximum"]
    if rule["default"] is None:
        return 0, rule["maximum"]
    return max(rule["minimum"], 10.0 ** -rule["decimals"]) if rule["minimum"] else 0.0, rule["maximum"]


def defaultOf(name: str) -> Any:
    """What the panel's field of a setting shows at first."""
    rule = PARAMETERS[name]
    if name in CHOICES:
        return CHOICES[name](rule["default"] or "")
    if rule["word"] is not None:
        return AUTOMATIC_NUMBER
    return (0 if rule["kind"] == WHOLE else 0.0) if rule["default"] is None else rule["default"]


class ImageOrientation(SettingChoice):
    """How the pixels of a recording are stored, where its file does not say or says it wrongly."""

    AUTOMATIC = ""
    MF = "MF"
    MN = "MN"
    UF = "UF"
    UN = "UN"


class Region(Choice):
    """Where to reconstruct."""

    AROUND_SWEEP = "around the sweep"
    BOX = "box"
    LIKE_VOLUME = "like a volume"


class ProbeShape(Choice):
    """How the beams run."""

    AUTOMATIC = ""
    LINEAR = LINEAR
    SECTOR = SECTOR


class LiveSource(Choice):
    """Where live images come from."""

    OPENIGTLINK = "OpenIGTLink"
    SCENE = "scene"


class RegistrationStart(Choice):
    """Where the search for the CT's place begins."""

    WHERE_IT_IS = "where it is"
    ANYWHERE = "anywhere"
    EACH_ON_ITS_OWN = "each on its own"


class SigmaUnit(Choice):
    """Unit of the width of the bone map, or that it is chosen by how well CT and sweep agree."""

    AUTOMATIC = "automatic"
    VOXELS = "voxels"
    MM = "mm"


def _labels() -> dict:
    return {
        Region.AROUND_SWEEP: _("Around the whole sweep"),
        Region.BOX: _("Within a box"),
        Region.LIKE_VOLUME: _("On the voxels of a volume"),
        ProbeShape.AUTOMATIC: _("automatic"),
        ProbeShape.LINEAR: _("Linear"),
        ProbeShape.SECTOR: _("Sector, with this apex"),
        LiveSource.OPENIGTLINK: _("OpenIGTLink server (Plus)"),
        LiveSource.SCENE: _("Image in the scene"),
        RegistrationStart.WHERE_IT_IS: _("Near where the CT is now"),
        RegistrationStart.ANYWHERE: _("Anywhere"),
        RegistrationStart.EACH_ON_ITS_OWN: _("Near, then each vertebra on its own"),
        SigmaUnit.AUTOMATIC: _("automatic"),
        SigmaUnit.VOXELS: _("voxels"),
        SigmaUnit.MM: _("mm"),
    }


def methodOf(parameterNode) -> str:
    """The method that is chosen, one of the user's own among them; empty where the library chooses."""
    return parameterNode.ownMethod or parameterNode.method.value


def needsBone(method: str) -> bool:
    """Whether a method weights by where bone is; of one that is not known nothing is asked yet."""
    return method in (*METHODS, *registered_methods()) and method_named(method).needs_bone


def fileFrom(path: Path) -> Path | None:
    """A path parameter; None where it is empty."""
    return None if str(path) in ("", ".") else path


def camelCase(name: str) -> str:
    """The name of a parameter node's field for a setting's name: ``hole_limit`` is ``holeLimit``."""
    first, *others = name.split("_")
    return first + "".join(word.capitalize() for word in others)


def mending(error: AIFReconError, parameterNode) -> dict:
    """Choices that would mend an error, by the words for a button: the parameter, and the value that it has not now."""
    names = dict.fromkeys(name for name in message_of(error).settings if name in RULES)
    current = {name: getattr(parameterNode, camelCase(name), None) for name in names}
    return {
        f"{RULES[name]['label']} {value.label()}": (camelCase(name), value)
        for name, chosen in current.items()
        if isinstance(chosen, SettingChoice)
        for value in type(chosen)
        if value != chosen
    }


def settingsFrom(parameterNode) -> Recipe:
    """The recipe that the panel's parameters ask for; how a recording is read is `readingFrom`'s."""
    values = {}
    for name, rule in PARAMETERS.items():
        value = getattr(parameterNode, camelCase(name))
        if isinstance(value, SettingChoice):
            value = value.value or None
        elif rule["word"] is not None and value < rule["minimum"]:
            value = rule["word"]
        elif rule["default"] is None and value == 0:
            value = None
        values[name] = value
    # What the panel does not ask for now is left open
    width = {parameterNode.boneSigmaUnit: parameterNode.boneSigma} if parameterNode.boneSource.name == "CT" else {}
    if parameterNode.region == Region.LIKE_VOLUME:
        values["spacing"] = None
    return Recipe(
        **{**values, "method": methodOf(parameterNode) or None, **regionFrom(parameterNode)},
        motion=AUTOMATIC if parameterNode.takeOutMotion else "off",
        probe=parameterNode.probe.value or AUTOMATIC,
        apex_px=(parameterNode.apexColumn, parameterNode.apexRow) if parameterNode.probe == ProbeShape.SECTOR else None,
        importance_mask=fileFrom(parameterNode.importanceMaskPath),
        bone_sigma_voxels=width.get(SigmaUnit.VOXELS),
        bone_sigma_mm=width.get(SigmaUnit.MM),
        bone_from_sweep=parameterNode.boneSource.name == "ECHOES",
    )


def regionFrom(parameters) -> dict:
    """Clip rectangle and fan that the panel sets by hand, as settings; a size or radius of 0 leaves them open."""
    clip = parameters.clipColumn, parameters.clipRow, parameters.clipWidth, parameters.clipHeight
    fan = parameters.fanLastRadius > 0
    return {
        "clip_px": clip if 0 not in clip[2:] else None,
        "fan_angles_deg": (parameters.fanFirstAngle, parameters.fanLastAngle) if fan else None,
        "fan_radius_px": (parameters.fanFirstRadius, parameters.fanLastRadius) if fan else None,
    }


def readingFrom(parameterNode) -> dict:
    """How the panel wants a recording to be read: arguments of `AIFReconLogic.readRecording`."""
    return {
        "orientation": parameterNode.imageOrientation.value or None,
        "timeOffset": parameterNode.timeOffset,
        "longestGap": parameterNode.longestGap,
    }


def takeConfigured(parameterNode, browser) -> None:
    """Let the panel's spacing follow the Plus configuration that a sweep was loaded with, where that tells one within the range."""
    from ..sweep.sequenceNodes import recordOf

    asked = getattr(recordOf(browser).get("configuration"), "spacing", None)
    rule = PARAMETERS["spacing"]
    values = asked if isinstance(asked, tuple | list) else (asked,)
    if asked is not None and len(set(values)) == 1 and rule["minimum"] <= values[0] <= rule["maximum"]:
        parameterNode.spacing = float(values[0])
