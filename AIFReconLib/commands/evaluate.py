"""`aifrecon evaluate`: how clearly, sharply and completely volumes show bone."""

from __future__ import annotations

import os
from collections.abc import Iterable
from datetime import date
from pathlib import Path
from typing import Annotated, ClassVar

from ..errors import SettingsError
from ..evaluation.cases import FEW, FEWEST, LEVEL, CaseNumbers
from ..evaluation.figures import ComparisonFigure, require_matplotlib
from ..evaluation.paragraph import methods_paragraph, unlike_settings
from ..evaluation.preview import middle_of_bone
from ..evaluation.quantities import BoneMetrics, achieved, hardly_shown, metrics_csv, table, what_counted
from ..evaluation.report import Report, file_sizes, software_versions, write_report
from ..evaluation.visibility import BEAM_THICKNESS, SweepBeams
from ..io.disk.atomic import write_text
from ..io.sequence.files import read_sequence
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import read_volume
from ..message import columns, listed
from ..progress import part
from ..provenance.record import made_in_header, unlike_inputs
from ..provenance.settings_files import made_with
from ..sweep.multi_sweep import joined
from ..terminal.arguments import Names, Options, Output, Spellings, positive
from ..terminal.console import ProgressBar
from ..terminal.labels_options import PlacedLabelsOptions, labels_inputs, place_from, required_labels
from ..terminal.remedies import in_options
from ..terminal.sequence_options import ImageOptions, TrackingOptions, configured
from ..workflows.evaluate import evaluated

OWN = (
    "Weighted by the bone that is also the yardstick: {}. What is wrong with that bone, or with its place, does not show. Another "
    "segmentation (--bone, or the column bone of batch) tells more."
)


class _EvaluateOptions(PlacedLabelsOptions, TrackingOptions, ImageOptions):
    """Measure volumes against the surface of a registered segmentation: contrast and contrast-to-noise ratio (CNR) of bone, its thickness
    and place, the share of the surface that is visible, also of oblique bone and at the interspinous gaps, noise and speckle.

    Parameters
    ----------
    volumes : VOLUME
        reconstructed volumes, one row each; or tables of many cases (.csv), as this command and batch write them
    bone_labels : FILE
        true segmentation of the CT, a volume, a folder of masks or a model; may be given several times
    mask : VOLUME
        0 where nothing was measured (default: where a volume is 0)
    csv : FILE.csv
        also write every number here
    against : NAME
        of many cases: what others are compared with (default: average, else the first)
    methods : FILE.txt
        also write a paragraph for the methods section of a paper
    report : FILE.html
        also write a page with numbers, definitions and provenance
    sweep : SEQUENCE
        frames that the volumes were made from, which decide which bone counts; without, all bone in the volume does
    beam_thickness : MM
        width of the beams across the image plane

    Examples
    --------
      aifrecon evaluate average.nrrd weighted.nrrd --bone lumbar.nrrd --bone-transform CTToReference.tfm \\
          --sweep sweep.igs.mha --config PlusDeviceSet.xml --csv metrics.csv --ct ct.nrrd --report report.html
      aifrecon evaluate results/results.csv --against average --csv summary.csv

    Volumes are to be compared under one sweep: it decides which bone counts. To compare sweeps, give the one that saw more for both.
    """

    volumes: tuple[Path, ...]
    bone_labels: list[Path] = []
    mask: Path | None = None
    csv: Output | None = None
    against: str | None = None
    methods: Output | None = None
    report: Output | None = None
    sweep: tuple[Path, ...] = ()
    beam_thickness: Annotated[float, positive] = BEAM_THICKNESS

    WORDS: ClassVar[Names] = ("volumes",)
    SPELLED: ClassVar[Spellings] = {**Options.SPELLED, "bone_labels": ("--bone", "--bone-labels")}


def run(asked: _EvaluateOptions) -> None:
    """Read, measure, print, write."""
    are_tables = {path.suffix.lower() == ".csv" for path in asked.volumes}
    if len(are_tables) > 1 or (True in are_tables and (asked.report or labels_inputs(asked) or asked.sweep)):
        raise SettingsError("Tables (.csv) hold numbers of many cases. Give them without volumes, --bone, --ct, --sweep and --report.")
    if True in are_tables:
        _over_cases(asked)
        return
    of_sweep = [*asked.sweep, *asked.config]
    inputs = [*asked.volumes, *labels_inputs(asked), asked.bone_transform, asked.mask, *of_sweep]
    outputs = [path for path in (asked.csv, asked.report, asked.methods) if path]
    if asked.config and not asked.sweep:
        raise SettingsError("--config describes a sweep, and there is none. Give --sweep SEQUENCE.")
    if asked.ct and asked.report:
        require_matplotlib()
    figure = None
    with ProgressBar() as progress:
        beams = _beams(asked) if asked.sweep else None
        to_reference, paths = place_from(asked), unique_names(asked.volumes)
        given = required_labels(asked, part(progress, 0.0, 0.05)).told_by(read_volume(asked.volumes[0]).grid, to_reference)
        labels = given.placed_by(to_reference)
        mask = read_volume(asked.mask) if asked.mask else None
        found = evaluated(paths, labels, beams, mask, labels_inputs(asked), part(progress, 0.05, 0.9))
        if asked.ct and asked.report:
            progress(0.9, "Drawing")
            ct, shown = read_ct(asked.ct).placed_by(to_reference), {name: read_volume(path) for name, path in paths.items()}
            first = next(iter(shown.values()))
            center = middle_of_bone(first, first.array != 0, labels)
            figure = ComparisonFigure(shown, center, ct, labels, mask).png()
    results, frames, own_bone = found.results, found.frames, found.own_bone
    # Before anything is printed, which can fail: whoever reads it may go away
    if asked.csv:
        write_text(asked.csv, metrics_csv(results, frames, own_bone))
    if asked.report:
        write_report(asked.report, _report(asked, results, frames, inputs, figure))
    if asked.methods:
        counted = what_counted(next(iter(results.values())), frames)
        told = f"They were measured against {_bone(asked)} (registration: {_place(asked)}). Numbers are {counted}."
        write_text(asked.methods, methods_paragraph(found.made, told, own_bone))
    print(columns(table(results)))
    print(f"\n  {achieved(results, frames)}")
    print(f"\n  {what_counted(next(iter(results.values())), frames)}." + ("" if beams else " Give --sweep to count only what it reached."))
    if own_bone:
        print(f"  {OWN.format(listed(own_bone))}")
    if mask is None:
        print("  Measured where a volume is not 0. batch and the panel measure where frames entered or gaps were filled, as with --mask.")
    doubts = unlike_inputs(found.headers, [*labels_inputs(asked), asked.bone_transform, *asked.sweep])
    doubts += [doubt for doubt in [hardly_shown(results.values())] if doubt]
    for line in (*doubts, *map(in_options, given.notes), *(f"wrote {path}" for path in outputs)):
        print(f"  {line}")


def _over_cases(asked: _EvaluateOptions) -> None:
    """The same of tables of many cases: means, spreads and paired differences."""
    found = CaseNumbers.read(unique_names(asked.volumes))
    against = found.reference(asked.against)
    means, differences = found.tables(against)
    cases = len({case for rows in found.numbers.values() for case in rows})
    if cases < 2:
        raise SettingsError("The tables hold one case. Give those of several, or the volumes themselves.")
    print(f"{cases} cases: mean \N{PLUS-MINUS SIGN} standard deviation\n{columns(means)}")
    print(f"\nminus {against}: mean of paired differences [{LEVEL:.0%} confidence interval, bootstrap over cases]\n{columns(differences)}")
    if cases < FEW:
        print(f"\n  Of fewer than {FEW} cases such intervals are too narrow, and of fewer than {FEWEST} there is none.")
    if found.own_bone:
        print(f"\n  {OWN.format(listed(sorted(found.own_bone)))}")
    unlike = unlike_settings(found.volumes)
    doubts = [f"WARNING: Settings differ. {each[:1].upper()}{each[1:]}." for each in unlike]
    print(*(f"\n  {line}" for line in (*found.notes, *doubts)), sep="", end="\n" * bool(found.notes or doubts))
    if asked.csv:
        write_text(asked.csv, found.csv(against))
    if asked.methods:
        firsts = {name: next(iter(paths.items())) for name, paths in found.volumes.items()}
        made = {name: made_in_header(read_volume(path).fields) if path.is_file() else {} for name, (_, path) in firsts.items()}
        first = listed(dict.fromkeys(case for case, _ in firsts.values()))
        settings = f"Settings are those of {first}: what was found may differ from case to case." if any(made.values()) else ""
        told = " ".join([settings, *(f"Not alike in all cases: {each}." for each in unlike), found.registration_in_words()])
        write_text(asked.methods, methods_paragraph(made, told.strip(), sorted(found.own_bone), cases))
    for path in filter(None, (asked.csv, asked.methods)):
        print(f"  wrote {path}")


def _bone(asked: _EvaluateOptions) -> str:
    return listed(path.name for path in asked.bone_labels or filter(None, [asked.ct]))


def _place(asked: _EvaluateOptions) -> str:
    return asked.bone_transform.name if asked.bone_transform else "none needed"


def unique_names(paths: Iterable[Path]) -> dict[str, Path]:
    """Files by their names; those of one name with their folders, as far as these differ."""
    files = list(dict.fromkeys(paths))
    alike = {path.name: [other.absolute().parent for other in files if other.name == path.name] for path in files}

    def called(path: Path) -> str:
        try:
            return path.absolute().relative_to(os.path.commonpath(alike[path.name])).as_posix()
        except ValueError:  # they lie on two drives of Windows
            return path.absolute().as_posix()

    return {called(path): path for path in files}


def _beams(asked: _EvaluateOptions) -> SweepBeams:
    sequence = joined(read_sequence(path, config=config) for path, config in configured(asked, asked.sweep))
    return SweepBeams.of_sequence(sequence, asked.recipe, asked.beam_thickness)


def _report(
    asked: _EvaluateOptions, results: dict[str, BoneMetrics], frames: int | None, inputs: list[Path | None], figure: bytes | None
) -> Report:
    facts = {
        "Bone": _bone(asked),
        "Registration": _place(asked),
    }
    facts["Measured"] = f"where {asked.mask.name} is not 0" if asked.mask else "where a volume is not 0"
    if frames is not None:
        facts["Sweep"] = f"{', '.join(path.name for path in asked.sweep)}, {frames} frames with a pose"
        facts["Beam"] = f"{asked.beam_thickness:g} mm across the image plane"
    return Report(
        title="How well volumes show bone",
        date=date.today().isoformat(),
        metrics=results,
        frames=frames,
        inputs=file_sizes(inputs),
        facts=facts,
        settings={name: made for name, path in unique_names(asked.volumes).items() if (made := made_with(path)) is not None},
        versions=software_versions(),
        figure_png=figure,
        figure_caption="Cuts through the middle of the bone that shows: the CT with its segmentation outlined, and the volumes."
        + (" Blue: not scanned." if asked.mask else ""),
    )
