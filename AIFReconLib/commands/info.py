"""`aifrecon info`: what sequences hold, what keeps them from being reconstructed, and what would be made of them."""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np

from ..bone.echoes.surface import default_bone
from ..compounding.methods.table import method_named
from ..errors import AIFReconError, SettingsError
from ..imaging.beams import LINEAR, SECTOR
from ..imaging.region import ClipRectangle
from ..inspection.diagnosis import diagnose
from ..inspection.sweep_drawing import draw_sweep
from ..io.disk.atomic import write_text
from ..message import columns
from ..progress import Progress, part
from ..registration.labeled_bone import LabeledBone
from ..terminal.console import ProgressBar, program, shell_words
from ..terminal.options import Commands, add_labels_options, labels_from, place_from, refuse_to_overwrite
from ..terminal.recipe_options import recipe_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import OF_A_RECORDING, add_sweep_options, of_each, sequence_from
from ..workflows.reconstruct import ReconstructionPlan, plan
from ..workflows.register import calibration_by

NOT_READY = 1
"""Exit code where a sequence cannot be reconstructed."""


def add_to(commands: Commands) -> None:
    """Declare the command."""
    parser = commands.add_parser(
        "info",
        description="Show frames, transforms, rate, pixel spacing and tracking of sequences, say in words what is missing, estimate from a "
        "sweep that goes to and fro whether images and poses are out of step, and say what reconstruct would make of it, with the command. "
        "Exit code 1: a sequence cannot be reconstructed as it is.",
    )
    parser.add_argument("sequences", type=Path, nargs="+", metavar="SEQUENCE", help="tracked frames, e.g. sweep.igs.mha; one or more")
    parser.add_argument("--json", action="store_true", help="print JSON instead of text (of several sequences: a list)")
    parser.add_argument("--drawing", type=Path, metavar="FILE.svg", help="also draw where the images of a sequence lie, by their poses")
    bone = parser.add_argument_group("bone", "where it will be asked for")
    add_labels_options(bone)
    bone.add_argument("--bone-transform", type=Path, metavar="FILE", help="transform CT -> Reference as Slicer saves it")
    add_sweep_options(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Read and report; the answer is the exit code."""
    each = of_each(arguments, arguments.sequences)
    refuse_to_overwrite(arguments, "drawing")
    if arguments.drawing and len(each) > 1:
        raise SettingsError("--drawing shows one sequence, and several are given. Give one.")
    texts, dicts, ready = [], [], True
    with ProgressBar() as progress:
        for number, one in enumerate(each):
            text, as_dict = _report(one, part(progress, number / len(each), (number + 1) / len(each)))
            texts.append(text)
            dicts.append(as_dict)
            ready &= bool(as_dict["ready"])
    print(json.dumps(dicts if len(dicts) > 1 else dicts[0], indent=2) if arguments.json else "\n\n".join(texts))
    return 0 if ready else NOT_READY


def _report(arguments: argparse.Namespace, progress: Progress | None) -> tuple[str, dict[str, object]]:
    """What is to be said of one sequence, for a terminal and for JSON."""
    sequence = sequence_from(arguments)
    recipe = recipe_from(arguments)
    labels = labels_from(arguments, progress)
    placed = place_from(arguments)
    has_bone = labels is not None
    told = recipe.probe if recipe.probe == LINEAR else SECTOR if recipe.apex_px else None
    report = diagnose(sequence, recipe.image_to_reference, recipe.reference, progress, told and f"{told} (as given)", has_bone)
    report = replace(report, findings=tuple(map(in_options, report.findings)))
    text, as_dict = report.to_text(), report.to_dict()
    poses = report.poses
    if arguments.drawing and poses is not None and len(poses.usable):
        planes, reference = poses.image_to_reference[poses.usable], recipe.reference or "Reference"
        write_text(arguments.drawing, draw_sweep(planes, sequence.frame_size, sequence.name, reference).to_svg())
        text += f"\ndrew {arguments.drawing}: columns red, rows (into the body) green, first frames light"
    if not report.ready:
        return text, as_dict
    unasked: tuple[str, ...] = ()
    try:
        if labels is None:
            # As the reconstruction will decide
            recipe, shown, unasked = default_bone(sequence, recipe, progress)
            has_bone, unasked = shown is not None, unasked if shown is None else shown.notes
        planned = plan(sequence, recipe, has_bone=has_bone, poses=report.poses)
    except AIFReconError as error:
        return f"{text}\nCannot be reconstructed like this. {in_options(error)}", {**as_dict, "ready": False, "problem": in_options(error)}
    bone, places = _bone(None if labels is None else LabeledBone(labels, placed, sequence, recipe), planned.method)
    if labels is not None and places:
        bone += map(in_options, calibration_by([sequence], labels, placed, recipe).lines)
    first = [] if places or placed is not None else [register_command(arguments)]
    clip = None if sequence.configuration.imaged_region or planned.region.fan else planned.region.clip
    command = reconstruct_command(arguments, clip, OF_REGISTER if first else None)
    facts = columns([("", f"{name}:", value) for name, value in _facts(planned)], indent="")
    as_dict["plan"] = {
        "method": planned.method,
        "size": list(planned.grid.size),
        "spacing_mm": [round(float(mm), 6) for mm in planned.grid.spacing],
        "ijk_to_reference": planned.grid.ijk_to_reference.tolist(),
        "memory_bytes": planned.memory,
        "hole_limit_mm": planned.hole_limit,
        "bone": bone,
        "first": first,
        "command": command,
    }
    lines = [text, "", "As it is, reconstruct would make:", facts, *map(in_options, (*planned.notes, *unasked)), *bone]
    if first:
        lines += ["", "First place the CT on the sweep:", f"  {first[0]}"]
    return "\n".join([*lines, "", "Then:" if first else "To do so:", f"  {command}"]), as_dict


def _bone(labeled: LabeledBone | None, method: str) -> tuple[list[str], bool]:
    """What is to be said of the bone, and whether it lies on the sweep, as far as that can be told."""
    if labeled is None:
        return [], True
    comparison = labeled.comparison()
    agreement = None if comparison is None else comparison.agreement
    lines = labeled.lines(method) if method_named(method).needs_bone else []
    return [*map(in_options, (*labeled.labels.notes, *lines))], agreement is None or agreement.enough


def _facts(planned: ReconstructionPlan) -> list[tuple[str, str]]:
    """The volume in words."""
    grid = planned.grid
    extent = " x ".join(f"{n * mm:.0f}" for n, mm in zip(grid.size, grid.spacing, strict=True))
    size, spacing = (" x ".join(f"{n:.4g}" for n in three) for three in (grid.size, grid.spacing))
    corner = ", ".join(f"{mm:.1f}" for mm in np.asarray(grid.origin))
    return [
        ("box", f"{extent} mm, first voxel at {corner} in Reference"),
        ("voxels", f"{size} of {spacing} mm, {grid.voxels / 1e6:.1f} million"),
        ("memory", f"{planned.memory / 2**20:.0f} MiB"),
        ("method", planned.method),
    ]


OF_REGISTER = Path("CTToReference.tfm")
OF_FILES = ("config", "bone_labels", "labels", "ct", "bone_above", "bone_space", "bone_unit", "image_to_reference", "reference")
OF_IMAGES = ("probe", "apex_px", "clip_px", "fan_angles_deg", "fan_radius_px")


def reconstruct_command(arguments: argparse.Namespace, clip: ClipRectangle | None = None, bone_transform: Path | None = None) -> str:
    """The reconstruction of these files, with the rectangle that was recognized and the transform that was found."""
    transform = bone_transform or arguments.bone_transform
    words = [*_words(arguments, clip), *([] if transform is None else ["--bone-transform", str(transform)])]
    name = _sequences(arguments)[0].name.partition(".")[0]
    return _line(["reconstruct", *words, "--output", f"{name}-volume.nrrd"])


def register_command(arguments: argparse.Namespace) -> str:
    """The registration of these files."""
    return _line(["register", *_words(arguments, None), "--output", str(OF_REGISTER)])


def _line(words: list[str]) -> str:
    return f"{program()} {shell_words(words)}"


def _sequences(arguments: argparse.Namespace) -> list[Path]:
    sequence = getattr(arguments, "sequence", None)
    return arguments.sequences if sequence is None else [sequence]


def _words(arguments: argparse.Namespace, clip: ClipRectangle | None) -> list[str]:
    """The sequences, and the options that say how to read them and where bone is."""
    words = list(map(str, _sequences(arguments)))
    given = {name: getattr(arguments, name, None) for name in (*OF_FILES, *OF_A_RECORDING, *OF_IMAGES)}
    if clip is not None and given["clip_px"] is None:
        given["clip_px"] = (*clip.origin_px, *clip.size_px)
    for option, value in given.items():
        values = value if isinstance(value, tuple | list) else [value]
        if value is not None:
            words += [f"--{option.replace('_', '-')}", *(f"{each:g}" if isinstance(each, float) else str(each) for each in values)]
    for name, file in (arguments.transform_sequence or {}).items():
        words += ["--transform-sequence", f"{name}={file}"]
    return words
