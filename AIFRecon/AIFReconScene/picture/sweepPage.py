"""A page about a reconstruction, or a line: nodes to arrays; the worker writes it."""

import slicer
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError, OperationCanceled
from AIFReconLib.progress import part
from AIFReconLib.worker.page import PageAbout, tell

from ..inputs.boneNodes import boneNames, isLabeled
from ..inputs.inputs import Inputs
from ..panelWords import asControl, inPanelWords
from ..registration.ctRegistration import rigidPlace
from ..volumes.volumeNodes import OWN_FIELDS, SETTINGS_ATTRIBUTE, measuredOf, ultrasoundWindowOf, volumeOf
from ..work import inWorker
from .spinePicture import spinePicture
from .spineView import spineOf

VERSION_ATTRIBUTE = f"{OWN_FIELDS}version"


def whyNotTell(parameters) -> str:
    """What is missing before there is something to tell; empty: nothing."""
    if parameters.output is None or parameters.output.GetImageData() is None:
        return _("Reconstruct a volume first, or select one as output.")
    if parameters.output.GetAttribute(SETTINGS_ATTRIBUTE) is None:
        return _("{name} does not say how it was made: select a volume that AIFRecon reconstructed.").format(
            name=parameters.output.GetName()
        )
    if parameters.sweep is None:
        return _("Select the sweep that it was made from.")
    return ""


def tellOf(parameters, tracking, path=None, progress=None) -> str:
    """One line about the output, the chosen sweep, whose `TrackingReport` is given, and the chosen CT; to a path, a page is written too.

    `whyNotTell` of the parameters is empty. An AIFReconError says what cannot be told.
    """
    output, bone, inputs = parameters.output, parameters.bone, Inputs.fromParameters(parameters)
    version = getattr(slicer.app, "applicationVersion", None)
    about = PageAbout(
        name=output.GetName(),
        method=output.GetAttribute("AIFRecon.Method"),
        settings=output.GetAttribute(SETTINGS_ATTRIBUTE),
        spacing=output.GetSpacing(),
        tracking={parameters.sweep.GetName(): tracking},
        sequence=inputs.sequence(),
        recipe=inputs.recipe,
        version=output.GetAttribute(VERSION_ATTRIBUTE),
        program={"3D Slicer": str(version)} if version else {},
        **({} if path is None else _pictured(output, parameters.ctVolume, bone)),
        **_boneOf(inputs, bone, part(progress, 0.0, 0.1)),
    )
    return inWorker(tell, about, path, asControl(), progress=part(progress, 0.1, 1.0))


def _boneOf(inputs, bone, progress) -> dict:
    if bone is None or not isLabeled(bone):
        return {}
    try:
        place, labels = rigidPlace(bone), inputs.labels(progress)
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return {"problem": inPanelWords(error)}
    return {"labels": labels, "labels_to_reference": place, "names": boneNames(bone, list(inputs.boneSegments) or None)}


def _pictured(output, ct, bone) -> dict:
    plain, spine = measuredOf(output), spineOf(output)
    return {
        "shown": volumeOf(output),
        "window": ultrasoundWindowOf(output),
        "plain": None if plain is None else volumeOf(plain),
        "ct": volumeOf(ct) if ct is not None and ct.GetImageData() is not None else None,
        "spine": None if spine is None else spinePicture(spine, bone),
    }
