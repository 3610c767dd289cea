"""Choices of the panel that do not go together, said before any work begins; the library would refuse them too."""

from slicer.i18n import tr as _

from AIFReconLib.compounding.methods.table import DEFAULT_METHOD_WITH_BONE, DEFAULT_METHOD_WITHOUT_BONE, method_named

from .boneSource import BoneSource
from .parameters import PARAMETERS, HoleFilling, Interpolation, fileFrom, methodOf, ownMethods


def contradiction(parameters, hasBone: bool) -> str:
    """The first contradiction among the parameters, in a sentence; empty where there is none; `hasBone`: where bone is, is told."""
    return (
        _ofMethod(parameters)
        or _ofSpeed(parameters, hasBone)
        or _ofHoles(parameters)
        or _ofFan(parameters)
        or _ofPixels(parameters, _methodOf(parameters, hasBone))
    )


def comparisonContradiction(parameters) -> str:
    """The first choice that only some of the compared methods can do, in a sentence; empty where there is none."""
    if parameters.interpolation == Interpolation.LINEAR:
        return _("Linear interpolation does not go with every method: choose nearest to compare them.")
    if fileFrom(parameters.importanceMaskPath) is not None:
        return _("An importance mask does not go with every method: leave the mask out to compare them.")
    return ""


def _methodOf(parameters, hasBone: bool) -> str:
    """The method that a reconstruction would take; a configuration's is not looked up, which refuses nothing."""
    return methodOf(parameters) or (DEFAULT_METHOD_WITH_BONE if hasBone else DEFAULT_METHOD_WITHOUT_BONE)


def _ofMethod(parameters) -> str:
    if parameters.ownMethod and parameters.ownMethod not in ownMethods():
        return _("{method} is not known: import {module} in the Python console, or choose another method.").format(
            method=parameters.ownMethod, module=parameters.ownMethod.partition(":")[0]
        )
    return ""


def _ofSpeed(parameters, hasBone: bool) -> str:
    rule = PARAMETERS["speed_of_sound"]
    if 0 < parameters.speedOfSound < rule["minimum"]:
        return _("The speed of sound must be off, or {low:g} to {high:g} m/s; it is {speed:g}.").format(
            low=rule["minimum"], high=rule["maximum"], speed=parameters.speedOfSound
        )
    if parameters.speedOfSound and hasBone and parameters.boneSource != BoneSource.CT:
        return _("Bone is looked for at the depths that the images show: leave the speed of sound off, or select bone of the CT.")
    return ""


def _ofHoles(parameters) -> str:
    if parameters.holeLimit == 0 and parameters.holes not in (HoleFilling.AUTOMATIC, HoleFilling.OFF):
        return _("Gaps are filled up to 0 mm: set “Fill gaps up to” above 0, or “Fill them by” to automatic.")
    return ""


def _ofFan(parameters) -> str:
    if parameters.fanLastRadius == 0:
        return ""
    if parameters.fanFirstAngle >= parameters.fanLastAngle or parameters.fanFirstRadius >= parameters.fanLastRadius:
        return _("The fan's second angle and radius must be larger than the first. Correct them, or set the last radius to 0.")
    return ""


def _ofPixels(parameters, method: str) -> str:
    chosen = method_named(method)
    if parameters.interpolation == Interpolation.LINEAR and (chosen.spread is None or parameters.bestCosine):
        wish = method if chosen.spread is None else _("the best cosine")
        return _("Linear interpolation does not go with {wish}: choose nearest, or another method.").format(wish=wish)
    mask = fileFrom(parameters.importanceMaskPath)
    if mask is None:
        return ""
    if not mask.is_file():
        return _("There is no file {path}.").format(path=mask)
    if not chosen.weighs_pixels or parameters.bestCosine:
        return _("An importance mask weights an average: choose method average, or no mask.")
    return ""
