"""One case from its row to a folder of results: reading, registration, reconstruction, coverage, metrics, previews.

The same as `aifrecon register`, `reconstruct`, `coverage` and `evaluate` one after the other, with the recording, the bone and what it is
measured against made once for all methods.
"""

from __future__ import annotations

import json
import os
import time
import traceback
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..compounding.methods.table import is_own_method, method_named
from ..compounding.state import BESIDE, Reconstruction
from ..errors import AIFReconError, BeamGeometryError, GeometryError, OutputError
from ..evaluation.figures import require_matplotlib
from ..evaluation.metrics import evaluate
from ..evaluation.preview import preview
from ..evaluation.quantities import OTHER_BONE, OWN_BONE, hardly_shown
from ..evaluation.visibility import BoneTruth, SweepBeams, bone_truth
from ..geometry.labels import Labels
from ..geometry.volume import Volume
from ..guidance.coverage import coverage
from ..io.disk.atomic import output_errors, write_text
from ..io.disk.workspace import workspace
from ..io.transform.files import write_transform
from ..io.volume.dicom_series import read_ct
from ..io.volume.files import write_volume
from ..io.volume.label_files import read_labels
from ..message import listed
from ..recipe.recipe import AUTOMATIC
from ..registration.agreement import Agreement
from ..registration.labeled_bone import LabeledBone
from ..registration.registration import as_report
from ..sweep.frames import TrackedSequence
from ..sweep.multi_sweep import joined
from ..terminal.arguments import load_method_here, with_values
from ..terminal.labels_options import labels_from, place_from, required_labels
from ..terminal.reconstruction_options import SIDE_OUTPUTS, bone_inputs, bone_source_from, grid_from, with_provenance
from ..terminal.remedies import in_columns
from ..terminal.sequence_options import sequence_inputs, sequences_from
from ..workflows.job import ReconstructionJob
from ..workflows.reconstruct import execute, planned, tracking_of
from ..workflows.register import RegistrationJob, register_job
from .engine import held_memory
from .memory import OVER_PLAN
from .place import require_results
from .records import ALTERNATIVES, DONE, FAILED, LOST, RECORDS, Facts, Record, Row, made_of, read_record, stamp, write_record
from .table import Case, with_method

TRANSFORM, LABELS, REPORT = "CTToReference.tfm", "labels-as-scanned.nrrd", "report.json"


UNTOLD = (BeamGeometryError, GeometryError)
"""Errors of what cannot be told of a sweep or a volume, which are notes beside the rest."""


def carry_out(case: Case, output: Path, memory: int | None = None) -> Record:
    """Compute a case and put its results into their folder, all of them or none; whatever goes wrong is said in the record.

    Parameters
    ----------
    case : Case
    output : Path
        Folder of all results.
    memory : int or None
        Bytes that this process may take. None: what is free.

    Notes
    -----
    A function of a worker: it may be ended in any place, and begun again by another.
    """
    started = time.perf_counter()
    record = Record(case.name, LOST, made_of(case))
    try:
        record = _computed(case, output, memory, record)
    except Exception as error:
        state, message = _what_went_wrong(error)
        record = replace(record, state=state, message=message)
    record = replace(record, seconds=round(time.perf_counter() - started, 3))
    try:
        write_record(output, record)
    except OutputError as error:
        record = replace(record, state=LOST, message=in_columns(error))
    return record


def _what_went_wrong(error: Exception) -> tuple[str, str]:
    """The state of a case that has ended so, and a message."""
    if isinstance(error, OutputError | MemoryError):
        return LOST, in_columns(error) or "There was not enough memory. Give --memory more, or fewer --workers."
    if isinstance(error, AIFReconError):
        return FAILED, in_columns(error)
    if isinstance(error, OSError):
        return LOST, f"{error.filename or 'A file'}: {error.strerror or error}. Check that the file exists and may be used."
    # A mistake of ours in one case must not cost the others; what is needed to find it is kept
    told = "".join(traceback.format_exception(error, limit=-3))
    return FAILED, f"A mistake in AIFRecon, please report it: {type(error).__name__}: {error}\n{told}"


def _computed(case: Case, output: Path, memory: int | None, record: Record) -> Record:
    """The record of what is done, whose files now lie in the folder of the case."""
    with output_errors(output / case.name), workspace(output) as room:
        folder = room / case.name
        folder.mkdir()
        results = _Work(case, folder, memory).results()
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


@contextmanager
def _noted(notes: list[str], *errors: type[AIFReconError]) -> Iterator[None]:
    """Within, such an error is a note, and what follows is left out."""
    try:
        yield
    except errors as problem:
        notes.append(in_columns(problem))


def _agreement_numbers(agreement: Agreement) -> Row:
    return {
        "registration_agreement": float(agreement.share),
        "registration_median_distance_mm": float(agreement.median_distance),
    }


class _Work:
    """What the steps of a case share."""

    def __init__(self, case: Case, folder: Path, memory: int | None):
        self._name, self._methods, self._memory, self._folder = case.name, case.methods, memory, folder
        self._arguments = case.arguments
        self._sequence_files = sequence_inputs(self._arguments, self._arguments.sweeps)
        self._parts = sequences_from(self._arguments, self._arguments.sweeps)
        self._sequence: TrackedSequence = joined(self._parts)
        self._recipe = self._arguments.recipe
        self._ct_to_reference = place_from(self._arguments)
        self._report: dict[str, Any] = {}
        self._numbers: Row = {}
        self._notes: list[str] = []
        self._given = labels_from(self._arguments)

    def results(self) -> list[Row]:
        """Do all of it."""
        if self._arguments.register:
            self._register()
        labels = None if self._given is None else self._given.placed_by(place_from(self._arguments))
        if labels is not None:
            self._cover(labels)
        truth = self._truth(labels)
        self._notes += map(in_columns, () if self._given is None else self._given.notes)
        bone = bone_source_from(self._arguments, labels=self._given)
        job = ReconstructionJob(self._sequence, self._recipe, bone, grid_from(self._arguments))
        ct = read_ct(self._arguments.ct).placed_by(self._ct_to_reference) if self._arguments.ct else None
        rows = []
        for method in self._methods:
            row, job = self._of_method(method, job, truth, labels, ct)
            rows.append(row)
        if isinstance(job.bone, LabeledBone):
            rows = [self._with_agreement(row, job.bone) for row in rows]
        write_text(self._folder / REPORT, json.dumps(self._report, indent=1) + "\n")
        return rows

    def _with_agreement(self, row: Row, bone: LabeledBone) -> Row:
        """The row of a method, with what the sweep says of the CT's place: whatever the method does, it is the yardstick."""
        comparison = bone.comparison()
        if comparison is None or comparison.agreement is None:
            return row
        agreement, notes = comparison.agreement, row["notes"]
        self._report["agreement"] = list(comparison.lines)
        if not agreement.enough:
            notes = " ".join([*map(in_columns, comparison.lines), str(notes)])
        return {**_agreement_numbers(agreement), **row, "notes": notes}

    def _register(self) -> None:
        """Find the CT's place, and go on as if it had been given: by files, so that the numbers are those of the files."""
        arguments, given = self._arguments, required_labels(self._arguments) if self._given is None else self._given
        place = self._parts, given, self._ct_to_reference, self._recipe
        done = register_job(RegistrationJob(*place, arguments.per_segment, arguments.level, arguments.accept))
        found = done.found
        self._report["registration"] = as_report(found)
        if not done.is_taken:
            path = self._folder.parents[1] / RECORDS / f"{self._name}{ALTERNATIVES}"
            write_text(path, json.dumps(self._report, indent=1) + "\n")
            done.require_taken(f" The report is {path}.")
        write_transform(found.transform, self._folder / TRANSFORM)
        self._given, self._ct_to_reference = done.labels, found.transform
        lies: dict[str, object] = {"bone_transform": self._folder / TRANSFORM}
        if found.segments:
            moved = done.placed
            write_volume(moved, self._folder / LABELS)
            self._given = Labels(moved.array, moved.ijk_to_reference, {}, given.names)
            lies = {"bone_labels": [self._folder / LABELS], "labels": None, "bone_transform": None}
        self._arguments = with_values(arguments, **lies)
        self._numbers |= {
            **_agreement_numbers(found.agreement),
            "registered": "yes",
            "registration_moved_mm": None if found.moved is None else float(found.moved),
        }
        if found.uncertain:
            self._notes.append(f"Not held by this sweep: {listed(found.uncertain, '; ')}.")

    def _cover(self, labels: Volume) -> None:
        with _noted(self._notes, *UNTOLD):
            found = coverage(self._parts, labels, recipe=self._recipe, thickness=self._arguments.beam_thickness)
            self._report["coverage"] = found.to_dict()
            for name, share in (("sweep", found.all), ("sweep_interspinous", found.interspinous)):
                numbers = {**share.to_dict(), "reachable_mm2": round(100 * share.reachable_cm2, 1)}
                self._numbers |= {f"{name}_{key}": value for key, value in numbers.items() if key != "reachable_cm2"}

    def _truth(self, labels: Volume | None) -> BoneTruth | None:
        """What volumes are measured against."""
        arguments = self._arguments
        true = read_labels(arguments.bone).placed_by(self._ct_to_reference) if arguments.bone else labels
        if true is not None:
            with _noted(self._notes, *UNTOLD):
                return bone_truth(true, SweepBeams.of_sequence(self._parts, self._recipe, arguments.beam_thickness))
        return None

    def _of_method(
        self, method: str | None, job: ReconstructionJob, truth: BoneTruth | None, labels: Volume | None, ct: Volume | None
    ) -> tuple[Row, ReconstructionJob]:
        """Reconstruct, write, measure and draw; the answer is the row, and the job with the bone that was found, once for all methods."""
        arguments = with_method(self._arguments, method)
        if method is not None and is_own_method(method):
            load_method_here(method)
        beside = [name for name in BESIDE if getattr(arguments, name)]
        memory = None if self._memory is None else max(int((self._memory - held_memory()) / OVER_PLAN), 1)
        decided = planned(replace(job, recipe=arguments.recipe, beside=beside))
        job = replace(job, bone=decided.source)
        result = execute(decided, beside, memory).result
        files = [*self._sequence_files, *bone_inputs(arguments), arguments.importance_mask]
        result = with_provenance(result, arguments, files)
        width, weighs = result.bone.get("bone_sigma_mm"), method_named(result.method).needs_bone
        stem = result.method.replace(":", "-")
        result.intensity.write(self._folder / f"{stem}.nrrd")
        for name in SIDE_OUTPUTS:
            if getattr(arguments, name):
                getattr(result, name).write(self._folder / f"{stem}-{name}.nrrd")
        said_by_it = list(map(in_columns, result.messages))
        tracking = [{"sequence": name, **one.to_dict()} for name, one in tracking_of(job, result).items()]
        self._report[result.method] = {"tracking": tracking, "notes": said_by_it}
        notes = [*self._notes, *said_by_it]
        row: Row = {
            "method": result.method,
            "frames": result.frames_inserted,
            "frames_skipped": sum(map(len, result.skipped.values())),
            "spacing_mm": " x ".join(f"{mm:.3g}" for mm in result.grid.spacing),
            "size": " x ".join(map(str, result.grid.size)),
            "hole_limit_mm": float(result.hole_limit),
            "bone_sigma_mm": width if isinstance(width, float) else None,
            "volume": f"{self._name}/{stem}.nrrd",
            "preview": self._drawn(stem, result, labels, ct, notes),
            **self._numbers,
            **self._measured(result, truth, notes),
            "yardstick": None if truth is None else OWN_BONE if weighs and width != AUTOMATIC and not arguments.bone else OTHER_BONE,
        }
        return {**row, "notes": " ".join(dict.fromkeys(map(str, notes)))}, job

    def _measured(self, result: Reconstruction, truth: BoneTruth | None, notes: list[str]) -> Row:
        if truth is not None:
            with _noted(notes, GeometryError):
                metrics = evaluate(result.intensity, truth, result.mask)
                if (doubt := hardly_shown([metrics])) and method_named(result.method).needs_bone:
                    notes.append(doubt)
                if metrics.bone.area:
                    return {name: None if value != value else float(value) for name, value in metrics.to_dict().items()}
                notes.append("No bone surface that the sweep reaches lies where it was measured.")
        return {}

    def _drawn(self, stem: str, result: Reconstruction, labels: Volume | None, ct: Volume | None, notes: list[str]) -> str:
        """The picture's path; empty where none is wanted, or can be drawn."""
        if self._arguments.preview:
            with _noted(notes, OutputError):
                require_matplotlib()
                title = f"{self._name}: {result.method}, {result.frames_inserted} frames"
                preview(result.intensity, result.mask, labels, ct, title, result.score).write(self._folder / f"{stem}.png")
                return f"{self._name}/{stem}.png"
        return ""
