"""What is to be known of a reconstruction, on a page or in a line: pictures, sweep, agreement of the CT, coverage, settings, software."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from ..arrays import Matrix
from ..errors import AIFReconError, OperationCanceled
from ..geometry.volume import Volume
from ..inspection.tracking_report import TrackingReport
from ..inspection.verdicts import registration_verdict
from ..message import Spelling, advised, as_argument
from ..progress import Progress, part, report
from ..recipe.recipe import AUTOMATIC, Recipe
from ..sweep.frames import TrackedSequence

if TYPE_CHECKING:
    from ..evaluation.report import Section
    from ..motion.motion import PatientMotion

DASH = "\N{EN DASH}"


@dataclass(frozen=True, eq=False)
class PageAbout:
    """A reconstruction and what it was made of."""

    name: str
    method: str
    settings: str  #: Those that it says it was made with, as JSON
    spacing: tuple[float, ...]  #: mm
    tracking: Mapping[str, TrackingReport]  #: Of each sweep, by its name
    sequence: TrackedSequence
    recipe: Recipe
    labels: Volume | None = None  #: Of the CT, in coordinates of their own
    labels_to_reference: Matrix | None = None
    names: Mapping[int, str] = field(default_factory=dict)  #: Of the labels
    problem: str = "No segmentation was chosen: nothing says where bone should be."  #: Why there are none
    version: str | None = None  #: Of the AIFRecon that made it, where it says
    program: Mapping[str, str] = field(default_factory=dict)  #: Names and versions of what shows it
    shown: Volume | None = None  #: What is drawn
    window: tuple[float, float] = (0.0, 255.0)  #: Gray levels shown black and white
    plain: Volume | None = None  #: The plain mean of the echoes, on the same voxels
    ct: Volume | None = None
    spine: bytes | None = None  #: A PNG file of the bone in 3D
    motion: PatientMotion | None = None  #: That was taken out of the sequence; where the settings say that it was, it is looked for


def tell(about: PageAbout, path: Path | None = None, words: Spelling = as_argument, progress: Progress | None = None) -> str:
    """Write the page, completely or not at all, where a path is given; the same comes back in one line.

    `words` say what to do about what is found. Raises AIFReconError with what cannot be told or written.
    """
    from ..evaluation.report import Report, Section, software_versions, write_report
    from ..inspection.motion_drawing import draw_motion
    from ..io.disk.atomic import check_writable
    from ..provenance.settings_schema import understood

    if path is not None:
        check_writable(path)
    made_with = understood(Path(about.name), json.loads(about.settings), "", ()).recipe
    about = _without_motion(about, made_with, part(progress, 0.0, 0.2))
    report(progress, 0.2, "Drawing the pictures")
    pictures = () if path is None else _pictures(about)
    sections = []
    for name, tracking in about.tracking.items():
        rows = tuple((row[:1].upper() + row[1:], value) for row, value in tracking.rows())
        title = "Sweep" if len(about.tracking) == 1 else f"Sweep {name}"
        sections.append(Section(title, rows, tuple(advised(sentence, words) for sentence in tracking.findings())))
    if about.motion is not None:
        drawn = (("How the patient moved against the reference", draw_motion(about.motion).to_svg().encode()),)
        sections.append(Section("Motion of the patient", lines=about.motion.lines, pictures=drawn))
    lines = []
    for section, of_line in (_agreement(about, words, part(progress, 0.3, 0.6)), _coverage(about, words, part(progress, 0.6, 1.0))):
        sections += [] if section is None else [section]
        lines += [of_line] if of_line else []
    versions = software_versions()
    voxels = f"voxels of {' x '.join(f'{size:.3g}' for size in about.spacing)} mm"
    speeds = [tracking.median_speed for tracking in about.tracking.values()]
    speed = " at " + ", ".join(f"{speed:.0f}" for speed in speeds if speed is not None) + " mm/s" if any(speeds) else ""
    used, all_ = (sum(getattr(tracking, name) for tracking in about.tracking.values()) for name in ("used", "frames"))
    frames, software = f"{used} of {all_} frames{speed}", f"AIFRecon {about.version or versions['aifrecon']}"
    line = f"{about.name}: {'; '.join([frames, *lines, voxels, software])}. Research use only: not for guiding a needle."
    if path is not None:
        page = Report(
            title=about.name,
            date=f"{datetime.now():%Y-%m-%d %H:%M}",
            metrics={},
            frames=None,
            summary=line,
            facts={"Sweep": ", ".join(about.tracking), "Voxels": voxels},
            settings={about.method: replace(made_with, method=about.method)},
            versions={**versions, **about.program},
            sections=(*pictures, *sections),
        )
        write_report(path, page)
    return line


def _without_motion(about: PageAbout, made_with: Recipe, progress: Progress | None) -> PageAbout:
    """The same with the sweep as it went into the volume."""
    from ..registration.labeled_bone import LabeledBone
    from ..workflows.job import ReconstructionJob
    from ..workflows.reconstruct import without_motion

    if about.motion is not None or made_with.motion != AUTOMATIC:
        return about
    bone = None if about.labels is None else LabeledBone(about.labels, about.labels_to_reference, about.sequence, about.recipe)
    job = ReconstructionJob(about.sequence, replace(about.recipe, motion=AUTOMATIC), bone)
    mended, motion = without_motion(job, progress)
    return replace(about, sequence=mended.sequence, motion=motion)


def _pictures(about: PageAbout) -> tuple[Section, ...]:
    """Cuts through the reconstruction and, where it was kept, the same through its plain echo; bone in 3D."""
    from ..evaluation.cuts import Scene, cut_pictures
    from ..evaluation.report import Section
    from ..inspection.enhancement_map import raised_bands

    if about.shown is None:
        return ()
    labels = None if about.labels is None or about.labels_to_reference is None else about.labels.placed_by(about.labels_to_reference)
    bands = None if about.plain is None else Volume(raised_bands(about.shown, about.plain), about.shown.ijk_to_reference)
    kinds = [(about.method, Scene(about.shown, about.window, labels, about.ct, bands))]
    lines = ["Orange: bone of the CT."] if labels is not None else []
    lines += ["Where nothing was scanned the CT is seen, darker."] if about.ct is not None else []
    if about.plain is not None:
        kinds.append(("as measured", Scene(about.plain, about.window, labels, about.ct)))
        lines.append(
            "Violet: the method has made the picture brighter there than the echoes are on the mean; the stronger, the more. What was "
            "measured alone is shown as well."
        )
    middle = kinds[0][1].middle()
    pictures = [(f"{caption}; {kind}", data) for kind, scene in kinds for caption, data in cut_pictures(scene, middle)]
    if about.spine is not None:
        pictures.append(("Bone of the ultrasound, from behind; the CT's is translucent", about.spine))
    return (Section("Pictures", lines=tuple(lines), pictures=tuple(pictures)),)


def _agreement(about: PageAbout, words: Spelling, progress: Progress | None) -> tuple[Section, str]:
    """How CT and sweep agree: a section, and words for the line."""
    from ..evaluation.report import Section
    from ..registration.comparison import compared

    title = "CT and sweep"
    if about.labels is None or about.labels_to_reference is None:
        return Section(title, lines=(about.problem,)), ""
    found = compared(about.sequence, about.labels, about.labels_to_reference, about.recipe, progress)
    agreement = found.agreement
    if agreement is None:
        return Section(title, lines=tuple(advised(line, words) for line in found.lines)), ""
    rows = [
        (about.names.get(label) or f"label {label}", f"{own.agreement:.0%}", f"{own.median_distance:.1f} mm")
        for label, own in sorted(agreement.per_label.items())
    ]
    table = (("Bone", "Echoes that agree", "Median distance"), *rows) if rows else ()
    warning = agreement.warning(about.names)
    lines = (agreement.sentence(), *(() if warning is None else (warning,)))
    return Section(title, lines=lines, table=table), registration_verdict(agreement, about.names).finding


def _coverage(about: PageAbout, words: Spelling, progress: Progress | None) -> tuple[Section | None, str]:
    """How much of each bone the sweep met: a section, and words for the line."""
    from ..evaluation.report import Section
    from ..guidance.coverage import coverage

    title, labels = "Bone hit by the beams", about.labels
    if labels is None:
        return None, ""
    try:
        found = coverage(about.sequence, labels, about.labels_to_reference, about.recipe, names=about.names, progress=progress)
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return Section(title, lines=(advised(error, words),)), ""
    by_name = [(name if about.names else f"label {name}", share) for name, share in found.by_label.items()]
    rows = [
        (name, *map(_percent, (share.met, share.below_45_deg, share.expected_visibility))) for name, share in [*by_name, ("all", found.all)]
    ]
    lines = (
        "Shares of the bone that some beam from the back could reach, its sides too. In Slicer the light “Coverage” counts only what faces "
        "the back.",
        *(advised(note, words) for note in found.notes),
    )
    of_line = ", ".join(f"{name}: {_percent(share.met)}" for name, share in by_name)
    table = (("Bone", "Hit", "Squarely, below 45°", "Expected to show"), *rows)
    return Section(title, lines=lines, table=table), f"bone hit, its sides included: {of_line}"


def _percent(share: float) -> str:
    return DASH if share != share else f"{share:.0%}"
