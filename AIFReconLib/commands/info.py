"""`aifrecon info`: what sequences hold, what keeps them from being reconstructed, and what would be made of them."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from ..errors import SettingsError
from ..imaging.region import ClipRectangle
from ..inspection.sweep_drawing import draw_sweep
from ..io.disk.atomic import write_text
from ..message import columns
from ..progress import Progress, part
from ..terminal.arguments import Output, given_words, with_values
from ..terminal.console import ProgressBar, command_line
from ..terminal.labels_options import PlacedLabelsOptions, labels_from, place_from
from ..terminal.remedies import in_options
from ..terminal.sequence_options import SequencesOptions, SweepOptions, configured, sequences_from
from ..workflows.inspect import inspected

NOT_READY = 1
"""Exit code where a sequence cannot be reconstructed."""


class _InfoOptions(SequencesOptions):
    """Show frames, transforms, rate, pixel spacing and tracking of sequences, say in words what is missing, estimate from a sweep that
    goes to and fro whether images and poses are out of step, and say what reconstruct would make of it, with the command. Exit code 1:
    a sequence cannot be reconstructed as it is.

    Parameters
    ----------
    json
        print JSON instead of text (of several sequences: a list)
    drawing : FILE.svg
        also draw where the images of a sequence lie, by their poses
    """

    json: bool = False
    drawing: Output | None = None


def run(asked: _InfoOptions) -> int:
    """Read and report; the answer is the exit code."""
    each = [with_values(asked, sequences=(path,), config=[config] if config else []) for path, config in configured(asked, asked.sequences)]
    if asked.drawing and len(each) > 1:
        raise SettingsError("--drawing shows one sequence, and several are given. Give one.")
    texts, dicts, ready = [], [], True
    with ProgressBar() as progress:
        for number, one in enumerate(each):
            text, as_dict = _report(one, part(progress, number / len(each), (number + 1) / len(each)))
            texts.append(text)
            dicts.append(as_dict)
            ready &= bool(as_dict["ready"])
    print(json.dumps(dicts if len(dicts) > 1 else dicts[0], indent=2) if asked.json else "\n\n".join(texts))
    return 0 if ready else NOT_READY


def _report(asked: _InfoOptions, progress: Progress | None) -> tuple[str, dict[str, object]]:
    """What is to be said of one sequence, for a terminal and for JSON."""
    (sequence,), recipe = sequences_from(asked, asked.sequences), asked.recipe
    placed = place_from(asked)
    found = inspected(sequence, recipe, labels_from(asked, progress), placed, progress)
    diagnosis = replace(found.diagnosis, findings=tuple(map(in_options, found.diagnosis.findings)))
    text, as_dict, poses = diagnosis.to_text(), diagnosis.to_dict(), diagnosis.poses
    if asked.drawing and poses is not None and len(poses.usable):
        planes, reference = poses.image_to_reference[poses.usable], recipe.reference or "Reference"
        write_text(asked.drawing, draw_sweep(planes, sequence.frame_size, sequence.name, reference).to_svg())
        text += f"\ndrew {asked.drawing}: columns red, rows (into the body) green, first frames light"
    if found.problem is not None:
        problem = in_options(found.problem)
        return f"{text}\nCannot be reconstructed like this. {problem}", {**as_dict, "ready": False, "problem": problem}
    planned = found.planned
    if planned is None:
        return text, as_dict
    bone = [*map(in_options, found.bone)]
    first = [] if found.is_placed or placed is not None else [register_command(asked)]
    clip = None if sequence.configuration.imaged_region or planned.region.fan else planned.region.clip
    command = reconstruct_command(asked, clip, OF_REGISTER if first else None)
    facts = columns([("", f"{name}:", value) for name, value in planned.rows()], indent="")
    as_dict["plan"] = {**planned.to_dict(), "bone": bone, "first": first, "command": command}
    lines = [text, "", "As it is, reconstruct would make:", facts, *map(in_options, found.notes), *bone]
    if first:
        lines += ["", "First place the CT on the sweep:", f"  {first[0]}"]
    return "\n".join([*lines, "", "Then:" if first else "To do so:", f"  {command}"]), as_dict


OF_REGISTER = Path("CTToReference.tfm")


def reconstruct_command(asked: SequencesOptions, clip: ClipRectangle | None = None, bone_transform: Path | None = None) -> str:
    """The reconstruction of these files, with the rectangle that was recognized and the transform that was found."""
    if clip is not None and asked.clip_px is None:
        asked = with_values(asked, clip_px=(*clip.origin_px, *clip.size_px))
    if bone_transform is not None:
        asked = with_values(asked, bone_transform=bone_transform)
    name = asked.sequences[0].name.partition(".")[0]
    return _command("reconstruct", asked, f"{name}-volume.nrrd")


def register_command(asked: SequencesOptions) -> str:
    """The registration of these files."""
    return _command("register", with_values(asked, bone_transform=None), str(OF_REGISTER))


def _command(name: str, asked: SequencesOptions, output: str) -> str:
    words = given_words(asked, SweepOptions, PlacedLabelsOptions)
    return command_line([name, *map(str, asked.sequences), *words, "--output", output])
