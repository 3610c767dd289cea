"""How well volumes of one scan show the bone of a CT, measured in their files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import GeometryError
from ..evaluation.metrics import evaluate
from ..evaluation.quantities import BoneMetrics
from ..evaluation.visibility import SweepBeams, bone_truth
from ..geometry.volume import Volume
from ..io.volume.files import read_volume
from ..progress import Progress, part, report
from ..provenance.record import made_in_header, weighted_by


@dataclass(frozen=True, eq=False)
class _EvaluationOutput:
    """What was measured, by the names of the volumes."""

    results: dict[str, BoneMetrics]
    made: dict[str, dict[str, object]]  #: How each says that it was made
    headers: dict[str, Mapping[str, str]]  #: Fields of each
    own_bone: list[str]  #: Those that were weighted by the bone that is the yardstick
    frames: int | None  #: Of the sweep that decides which bone counts; None without one


def evaluated(
    paths: Mapping[str, Path],
    labels: Volume,
    beams: SweepBeams | None = None,
    mask: Volume | None = None,
    label_files: Sequence[Path] = (),
    progress: Progress | None = None,
) -> _EvaluationOutput:
    """Measure volumes, one in memory at a time, against labels in Reference that came from these files.

    Raises GeometryError, which names the volume, where none of the bone lies where it was measured.
    """
    truth = bone_truth(labels, beams, progress=part(progress, 0.0, 0.65))
    results: dict[str, BoneMetrics] = {}
    made: dict[str, dict[str, object]] = {}
    headers: dict[str, Mapping[str, str]] = {}
    own_bone: list[str] = []
    for number, (name, path) in enumerate(paths.items()):
        report(progress, 0.65 + 0.35 * number / len(paths), f"Measuring {path.name}")
        volume = read_volume(path)
        made[name], headers[name] = made_in_header(volume.fields), volume.fields
        own_bone += [name] if weighted_by(volume, label_files) else []
        try:
            results[name] = evaluate(volume, truth, mask)
        except GeometryError as error:
            raise GeometryError(f"{path}: {error}") from None
        if results[name].bone.area == 0:
            which = "no bone surface that the sweep reaches" if beams else "no bone surface"
            raise GeometryError(f"{path}: {which} lies where it was measured.", "Check {bone_transform} and the files.")
    return _EvaluationOutput(results, made, headers, own_bone, len(beams.image_to_reference) if beams else None)
