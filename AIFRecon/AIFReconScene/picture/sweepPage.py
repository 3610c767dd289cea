"""What is to be known of a reconstruction, on a page or in a line: pictures, sweep, agreement of the CT, coverage, settings, software."""

import json
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import slicer
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError, OperationCanceled, SettingsError
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.inspection.verdicts import registration_verdict
from AIFReconLib.progress import part, report

from ..background import inBackground
from ..inputs.boneNodes import boneNames, isLabeled, nameOf
from ..inputs.inputs import Inputs
from ..panelWords import inPanelWords, withNames
from ..registration.ctRegistration import CTRegistration, rigidPlace
from ..transforms import ijkToRAS, matrixToWorld
from ..volumes.volumeNodes import OWN_FIELDS, SETTINGS_ATTRIBUTE, measuredOf, ultrasoundWindowOf
from .spinePicture import spinePicture
from .spineView import spineOf

VERSION_ATTRIBUTE = f"{OWN_FIELDS}version"


@dataclass(frozen=True)
class Told:
    """What is told of a reconstruction.

    Parameters
    ----------
    page : Report
    line : str
        The same in one line.
    """

    page: object
    line: str


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


def tell(parameters, tracking, progress=None, pictures: bool = True) -> Told:
    """The page and the line about the output, the chosen sweep and the chosen CT.

    Parameters
    ----------
    parameters : AIFReconParameterNode
    tracking : (str, TrackingReport)
        Of the sweep.
    progress : Progress or None
    pictures : bool
        Whether to draw them; the line needs none.

    Raises
    ------
    AIFReconError
        With what cannot be told and what to do.
    """
    from AIFReconLib.evaluation.report import Report, Section, software_versions

    missing = whyNotTell(parameters)
    if missing:
        raise SettingsError(f"{missing}")
    output, method = parameters.output, parameters.output.GetAttribute("AIFRecon.Method")
    _title, tracked = tracking
    report(progress, 0.0, "Drawing the pictures")
    drawn = [Section(_("Pictures"), said=_captions(parameters), pictures=tuple(_pictures(parameters)))] if pictures else []
    agreement, agreed = _agreement(parameters, part(progress, 0.2, 0.6))
    covered, coverage = _coverage(parameters, part(progress, 0.6, 1.0))
    rows = tuple((_capital(name), value) for name, value in tracked.rows())
    sections = [
        *drawn,
        Section(_("Sweep"), rows, tuple(inPanelWords(sentence) for sentence in tracked.findings())),
        *agreed,
        *coverage,
    ]
    page = Report(
        title=output.GetName(),
        date=f"{datetime.now():%Y-%m-%d %H:%M}",
        metrics={},
        frames=None,
        facts={_("Sweep"): parameters.sweep.GetName(), _("Voxels"): _voxels(output)},
        settings={method: _settings(output)},
        versions={**software_versions(), **_slicerVersion()},
        sections=tuple(sections),
    )
    words = [_("{used} of {frames} frames").format(used=tracked.used, frames=tracked.frames)]
    if tracked.median_speed is not None:
        words[-1] += _(" at {speed:.0f} mm/s").format(speed=tracked.median_speed)
    words += [*agreement, *covered, _voxels(output), f"AIFRecon {output.GetAttribute(VERSION_ATTRIBUTE) or page.versions['aifrecon']}"]
    research = _("Research use only: not for guiding a needle.")
    return Told(page, f"{output.GetName()}: {'; '.join(words)}. {research}")


def _slicerVersion() -> dict:
    version = getattr(slicer.app, "applicationVersion", None)
    return {"3D Slicer": str(version)} if version else {}


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _volumeOf(node) -> Volume:
    return Volume(slicer.util.arrayFromVolume(node), matrixToWorld(node) @ ijkToRAS(node))


def _voxels(node) -> str:
    spacing = " x ".join(f"{size:.3g}" for size in node.GetSpacing())
    return _("voxels of {spacing} mm").format(spacing=spacing)


def _pictures(parameters) -> list:
    """Cuts through the reconstruction and, where it was kept, the same through its plain echo; bone in 3D."""
    from AIFReconLib.evaluation.cuts import Scene, cut_pictures
    from AIFReconLib.inspection.raised import raised_bands

    output, plain = parameters.output, measuredOf(parameters.output)
    bone, ct = parameters.bone, parameters.ctVolume
    labels = None
    if bone is not None and isLabeled(bone):
        labels = Inputs.fromParameters(parameters).labels().placed_by(matrixToWorld(bone))
    shown, window = _volumeOf(output), ultrasoundWindowOf(output)
    beside: dict[str, Any] = {
        "window": window,
        "labels": labels,
        "ct": _volumeOf(ct) if ct is not None and ct.GetImageData() is not None else None,
    }
    bands = None if plain is None else Volume(raised_bands(shown, _volumeOf(plain)), shown.ijk_to_reference)
    kinds = [(output.GetAttribute("AIFRecon.Method"), Scene(shown, bands=bands, **beside))]
    if plain is not None:
        kinds.append((_("as measured"), Scene(_volumeOf(plain), **beside)))
    middle = kinds[0][1].middle()
    pictures = [(f"{caption}; {kind}", data) for kind, scene in kinds for caption, data in cut_pictures(scene, middle)]
    spine = spineOf(output)
    if spine is not None:
        pictures.append((_("Bone of the ultrasound, from behind; the CT's is translucent"), spinePicture(spine, bone)))
    return pictures


def _captions(parameters) -> tuple:
    said = [_("Orange: bone of the CT. Where nothing was scanned the CT is seen, darker.")]
    if measuredOf(parameters.output) is not None:
        said.append(
            _(
                "Violet: the method has made the picture brighter there than the echoes are on the mean; the stronger, the more. "
                "What was measured alone is shown as well."
            )
        )
    return tuple(said)


def _agreement(parameters, progress) -> tuple:
    """Words for the line, and a section, on how CT and sweep agree; nothing without labels."""
    from AIFReconLib.evaluation.report import Section

    bone, title = parameters.bone, _("CT and sweep")
    if bone is None or not isLabeled(bone):
        return (), [Section(title, said=(_("No segmentation was chosen: nothing says where bone should be."),))]
    try:
        agreement: Any = CTRegistration().check(parameters, progress).agreement
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return (), [Section(title, said=(inPanelWords(error),))]
    names = boneNames(bone, list(parameters.boneSegments) or None)
    rows = [
        (nameOf(label, names), f"{own.agreement:.0%}", f"{own.median_distance:.1f} mm", f"{own.echoes:,}")
        for label, own in sorted(agreement.per_label.items())
    ]
    table = ((_("Bone"), _("Echoes that agree"), _("Median distance"), _("Echoes")), *rows) if rows else ()
    warning = agreement.warning()
    said = (agreement.sentence(), *([withNames(warning, names)] if warning is not None else []))
    return (registration_verdict(agreement, names).finding,), [Section(title, said=said, table=table)]


def _coverage(parameters, progress) -> tuple:
    """Words for the line, and a section, on how much of each bone the sweep met; nothing without labels."""
    from AIFReconLib.evaluation.report import Section
    from AIFReconLib.guidance.coverage import coverage

    bone, title = parameters.bone, _("Bone hit by the beams")
    if bone is None or not isLabeled(bone):
        return (), []
    try:
        inputs, place = Inputs.fromParameters(parameters), rigidPlace(bone)
        sequence, labels, names = inputs.sequence(), inputs.labels(), boneNames(bone, list(parameters.boneSegments) or None)
        found = inBackground(lambda progress: coverage(sequence, labels, place, inputs.recipe, names=names, progress=progress), progress)
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return (), [Section(title, said=(inPanelWords(error),))]
    by_name = [(name if names else _("label {number}").format(number=name), share) for name, share in found.by_label.items()]
    shares = [*by_name, (_("all"), found.all)]
    rows = [(name, *map(_percent, (share.met, share.below_45_deg, share.expected_visibility))) for name, share in shares]
    headings = (_("Bone"), _("Hit"), _("Squarely, below 45°"), _("Expected to show"))
    words = ", ".join(f"{name}: {_percent(share.met)}" for name, share in by_name)
    said = (
        _(
            "Shares of the bone that some beam from the back could reach, its sides too; the light “Coverage” counts only what "
            "faces the back."
        ),
        *map(inPanelWords, found.notes),
    )
    return (_("bone hit, its sides included: {shares}").format(shares=words),), [Section(title, said=said, table=(headings, *rows))]


def _percent(share: float) -> str:
    return "\N{EN DASH}" if share != share else f"{share:.0%}"


def _settings(output):
    """The `Recipe` that a volume says it was made with."""
    from AIFReconLib.provenance.kept import understood

    return understood(Path(output.GetName()), json.loads(output.GetAttribute(SETTINGS_ATTRIBUTE)), "", ()).recipe
