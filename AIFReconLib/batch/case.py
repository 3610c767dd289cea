"""One case from its row to a folder of results: reading, registration, reconstruction, coverage, metrics, previews.

The same as `aifrecon register`, `reconstruct`, `coverage` and `evaluate` one after the other, with the recording, the bone and what it is
measured against made once for all methods.
"""

from __future__ import annotations

import argparse
import json
import os
import time
import traceback
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .. import __version__
from ..compounding.methods.table import is_own_method, method_named
from ..compounding.state import BESIDE, Reconstruction
from ..errors import AIFReconError, BeamGeometryError, GeometryError, OutputError, RegistrationRefused
from ..evaluation.cases import OTHER_BONE, OWN_BONE
from ..evaluation.figures import require_matplotlib
from ..evaluation.metrics import evaluate
from ..evaluation.preview import preview
from ..evaluation.visibility import BoneTruth, SweepBeams, bone_truth
from ..geometry.labels import Labels
from ..geometry.volume import Volume
from ..guidance.coverage import Coverage, coverage
from ..io.disk.atomic import output_errors, write_text
from ..io.disk.workspace import workspace
from ..io.transform.files import write_transform
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import write_volume
from ..io.volume.label_files import read_labels
from ..message import listed, said
from ..registration.registration import Registration, as_report, register
from ..registration.segments import placed_labels
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined
from ..terminal.options import labels_from, place_from, required_labels
from ..terminal.recipe_options import load_method_here, recipe_from
from ..terminal.reconstruction_options import SIDE_OUTPUTS, bone_inputs, bone_source_from, grid_from
from ..terminal.remedies import in_columns
from ..terminal.sequence_options import of_each, sequence_from, sequence_inputs
from ..terminal.settings_options import with_provenance
from ..workflows.job import ReconstructionJob
from ..workflows.reconstruct import execute, planned, tracking_of
from .engine import own_memory
from .memory import OVER_PLAN
from .place import require_results
from .records import ALTERNATIVES, DONE, FAILED, LOST, RECORDS, RUNNING, Facts, Record, Row, made_of, read_record, stamp, write_record
from .table import Case, with_method

TRANSFORM, LABELS, REPORT = "CTToReference.tfm", "labels-as-scanned.nrrd", "report.json"


@dataclass(frozen=True, eq=False)
class CaseTask:
    """What a worker is given.

    Parameters
    ----------
    case : Case
    table_folder, output : Path
        Folders of the table, and of all results.
    run : str
        Name of this run of the command.
    version : str
        Of the program that sends it.
    """

    case: Case
    table_folder: Path
    output: Path
    run: str
    version: str = __version__


def carry_out(task: CaseTask) -> Record:
    """Compute a case and put its results into their folder, all of them or none; whatever goes wrong is said in the record.

    Notes
    -----
    A function of a worker: it may be ended in any place, and begun again by another.
    """
    started = time.perf_counter()
    case, output = task.case, task.output
    before = read_record(output, case.name)
    attempts = before.attempts + 1 if before is not None and before.run == task.run else 1
    record = Record(case.name, RUNNING, made_of(case, task.table_folder), run=task.run, attempts=attempts)
    try:
        if task.version != __version__:
            raise OutputError(f"The worker has AIFRecon {__version__}, and the table was read by {task.version}. Install the same on both.")
        write_record(output, record)
        record = _computed(case, output, record)
    except (OutputError, MemoryError) as error:
        record = replace(
            record,
            state=LOST,
            message=in_columns(error) if str(error) else "There was not enough memory. Give --memory more, or fewer --workers.",
        )
    except AIFReconError as error:
        record = replace(record, state=FAILED, message=in_columns(error))
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        record = replace(record, state=LOST, message=f"{where}{error.strerror or error}. Check that the file exists and may be used.")
    except Exception as error:
        # A mistake of ours in one case must not cost the others; what is needed to find it is kept
        told = traceback.format_exc(limit=-3)
        record = replace(record, state=FAILED, message=f"A mistake in AIFRecon, please report it: {type(error).__name__}: {error}\n{told}")
    record = replace(record, seconds=round(time.perf_counter() - started, 3))
    try:
        write_record(output, record)
    except OutputError as error:
        record = replace(record, state=LOST, message=in_columns(error))
    return record


def _computed(case: Case, output: Path, record: Record) -> Record:
    """The record of what is done, whose files now lie in the folder of the case."""
    with output_errors(output / case.name), workspace(output) as room:
        folder = room / case.name
        folder.mkdir()
        results = _Work(case, folder).results()
        outputs: Facts = {path.name: stamp(path) for path in sorted(folder.iterdir())}
        # Said before they are there: who ends the program now leaves results that the next run may replace
        write_record(output, replace(record, outputs=outputs))
        known = read_record(output, case.name)
        _replace_folder(folder, output / case.name, room / "before", () if known is None else known.outputs)
    return replace(record, state=DONE, results=results, outputs=outputs)


def _replace_folder(new: Path, target: Path, aside: Path, known: Collection[str]) -> None:
    """Put a folder of results in the place of another, which holds known results only; should that fail, one of them is there."""
    try:
        if os.path.lexists(target):
            os.rename(target, aside)
        # Where it can no longer be changed by others
        require_results(aside, known, target)
        os.rename(new, target)
    except BaseException:
        if os.path.lexists(aside) and not os.path.lexists(target):
            os.rename(aside, target)
        raise


class _Work:
    """What the steps of a case share."""

    def __init__(self, case: Case, folder: Path):
        self._case, self._folder = case, folder
        self._arguments = case.arguments
        each = of_each(self._arguments, self._arguments.sequences)
        self._sequence_files = [path for one in each for path in sequence_inputs(one)]
        self._parts = [sequence_from(one) for one in each]
        self._sequence: TrackedSequence = joined(self._parts)
        self._recipe = recipe_from(self._arguments)
        self._ct_to_reference = place_from(self._arguments)
        self._report: dict[str, Any] = {}
        self._numbers: Row = {}
        self._notes: list[str] = []
        self._given = labels_from(self._arguments)
        self._job = ReconstructionJob(self._sequence, self._recipe)

    def results(self) -> list[Row]:
        """Do all of it."""
        if self._arguments.register:
            self._register()
        labels = self._labels()
        if labels is not None:
            self._cover(labels)
        truth = self._truth(labels)
        if self._given is not None:
            self._notes += map(in_columns, self._given.notes)
        bone = bone_source_from(self._arguments, labels=self._given)
        self._job = ReconstructionJob(self._sequence, self._recipe, bone, grid_from(self._arguments))
        ct = read_ct(self._arguments.ct).placed_by(self._ct_to_reference) if self._arguments.ct else None
        rows = [self._of_method(method, truth, labels, ct) for method in self._case.methods]
        write_text(self._folder / REPORT, json.dumps(self._report, indent=1) + "\n")
        return rows

    def _register(self) -> None:
        arguments, labels = self._arguments, required_labels(self._arguments) if self._given is None else self._given
        found = register(
            self._parts, labels, self._ct_to_reference, per_segment=arguments.per_segment, level=arguments.level or 0, recipe=self._recipe
        )
        self._report["registration"] = as_report(found)
        if not (found.accepted or arguments.accept or arguments.level is not None):
            path = self._folder.parents[1] / RECORDS / f"{self._case.name}{ALTERNATIVES}"
            write_text(path, json.dumps(self._report, indent=1) + "\n")
            raise RegistrationRefused(f"No transform is written. {found.said} The report is {path}.", said(found.said))
        self._arguments = self._placed(found, labels)
        agreement = found.agreement
        self._numbers["registration_agreement"] = float(agreement.share)
        self._numbers["registration_median_distance_mm"] = float(agreement.median_distance)
        self._numbers["registration_moved_mm"] = None if found.moved is None else float(found.moved)
        if found.uncertain:
            self._notes.append(f"Not held by this sweep: {listed(found.uncertain, '; ')}.")

    def _placed(self, found: Registration, labels: Volume) -> argparse.Namespace:
        """The options with the place that was found, as if it had been given: by files, so that the numbers are those of the files."""
        write_transform(found.transform, self._folder / TRANSFORM)
        self._ct_to_reference = found.transform
        place: dict[str, object] = {"bone_transform": self._folder / TRANSFORM}
        if found.segments:
            moved = placed_labels(labels, found.segments.transforms)
            write_volume(moved, self._folder / LABELS)
            self._given = Labels(moved.array, moved.ijk_to_reference, {}, self._given.names if self._given else {})
            place = {"bone_labels": [self._folder / LABELS], "labels": None, "bone_transform": None}
        return argparse.Namespace(**{**vars(self._arguments), **place})

    def _labels(self) -> Volume | None:
        """The labels where they lie in Reference."""
        return None if self._given is None else self._given.placed_by(place_from(self._arguments))

    def _cover(self, labels: Volume) -> None:
        try:
            found: Coverage = coverage(self._parts, labels, recipe=self._recipe, thickness=self._arguments.beam_thickness)
        except (BeamGeometryError, GeometryError) as problem:
            self._notes.append(in_columns(problem))
            return
        self._report["coverage"] = found.to_dict()
        for name, share in (("sweep", found.all), ("sweep_interspinous", found.interspinous)):
            numbers = {**share.to_dict(), "reachable_mm2": round(100 * share.reachable_cm2, 1)}
            self._numbers |= {f"{name}_{key}": value for key, value in numbers.items() if key != "reachable_cm2"}

    def _truth(self, labels: Volume | None) -> BoneTruth | None:
        """What volumes are measured against."""
        arguments = self._arguments
        true = read_labels(arguments.bone).placed_by(self._ct_to_reference) if arguments.bone else labels
        if true is None:
            return None
        try:
            return bone_truth(true, SweepBeams.of_sequence(self._parts, self._recipe, arguments.beam_thickness))
        except (BeamGeometryError, GeometryError) as problem:
            self._notes.append(in_columns(problem))
            return None

    def _of_method(
        self,
        method: str | None,
        truth: BoneTruth | None,
        labels: Volume | None,
        ct: Volume | None,
    ) -> Row:
        """Reconstruct, write, measure and draw; the answer is the row."""
        arguments = with_method(self._arguments, method)
        if method is not None and is_own_method(method):
            load_method_here(method)
        beside = [name for name in BESIDE if getattr(arguments, name)]
        share = own_memory()
        memory = None if share is None else max(int(share / OVER_PLAN), 1)
        decided = planned(replace(self._job, recipe=recipe_from(arguments), beside=beside))
        # Looked for once for all methods
        self._job = replace(self._job, bone=decided.source)
        result = execute(decided, beside, memory).result
        files = [*self._sequence_files, *bone_inputs(arguments), arguments.importance_mask]
        result = with_provenance(result, arguments, files)
        width, weighs = result.bone.get("bone_sigma_mm"), method_named(result.method).needs_bone
        stem = result.method.replace(":", "-")
        volume = self._folder / f"{stem}.nrrd"
        result.intensity.write(volume)
        for name in SIDE_OUTPUTS:
            if getattr(arguments, name):
                getattr(result, name).write(self._folder / f"{stem}-{name}.nrrd")
        said_by_it = list(map(in_columns, result.said))
        tracking = [{"sequence": name, **one.to_dict()} for name, one in tracking_of(self._job, result).items()]
        self._report[result.method] = {"tracking": tracking, "notes": said_by_it}
        notes = [*self._notes, *said_by_it]
        return {
            "method": result.method,
            "frames": result.frames_inserted,
            "frames_skipped": sum(map(len, result.skipped.values())),
            "spacing_mm": " x ".join(f"{mm:.3g}" for mm in result.grid.spacing),
            "size": " x ".join(map(str, result.grid.size)),
            "hole_limit_mm": float(result.hole_limit),
            "bone_sigma_mm": width if isinstance(width, float) else None,
            "volume": f"{self._case.name}/{volume.name}",
            "preview": self._drawn(stem, result, labels, ct, notes),
            **self._numbers,
            **self._measured(result, truth, notes),
            "yardstick": None if truth is None else OWN_BONE if weighs and not arguments.bone else OTHER_BONE,
            "notes": " ".join(dict.fromkeys(map(str, notes))),
        }

    def _measured(self, result: Reconstruction, truth: BoneTruth | None, notes: list[str]) -> dict[str, float | None]:
        if truth is None:
            return {}
        try:
            metrics = evaluate(result.intensity, truth, result.mask)
        except GeometryError as problem:
            notes.append(in_columns(problem))
            return {}
        if metrics.bone.area == 0:
            notes.append("No bone surface that the sweep reaches lies where it was measured.")
            return {}
        return {name: None if value != value else float(value) for name, value in metrics.to_dict().items()}

    def _drawn(self, stem: str, result: Reconstruction, labels: Volume | None, ct: Volume | None, notes: list[str]) -> str:
        """The picture's path; empty where none is wanted, or can be drawn."""
        if not self._arguments.preview:
            return ""
        try:
            require_matplotlib()
        except OutputError as missing:
            notes.append(in_columns(missing))
            return ""
        title = f"{self._case.name}: {result.method}, {result.frames_inserted} frames"
        preview(result.intensity, result.mask, labels, ct, title, result.score).write(self._folder / f"{stem}.png")
        return f"{self._case.name}/{stem}.png"
