"""Where bone is: labels or a probability with their place, a network's predictions, or the sweep itself; and the map that comes of it."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..arrays import Matrix
from ..bone.estimators import bone_from_frames
from ..bone.from_sweep import bone_from_sweep
from ..bone.map import BoneMap
from ..bone.model import OnnxModel
from ..bone.recorded import RecordedPredictions
from ..errors import SettingsError
from ..io.sequence.files import read_sequence
from ..io.transform.files import read_transform
from ..io.volume.files import read_labels, read_volume
from ..machine.threads import usable_cores
from ..progress import Progress
from ..recipe.recipe import BoneSettings, Recipe
from ..registration.labeled_bone import LabeledBone
from ..sweep.frames import TrackedSequence
from .recipe_options import add_setting, add_settings

SOURCES = ("bone_from_sweep", "bone_frames", "bone_model", "bone_image")
"""Options by which the frames themselves say where bone is."""


def add_bone_options(parser: argparse.ArgumentParser) -> None:
    """Where bone is, and how it becomes a map."""
    bone = parser.add_argument_group(
        "bone", "a registered CT's segmentation, or a bone probability; methods that weight by incidence need one"
    )
    source = bone.add_mutually_exclusive_group()
    source.add_argument("--bone-labels", type=Path, metavar="VOLUME", help="segmentation of the CT; any label above 0 is bone")
    source.add_argument("--bone-probability", type=Path, metavar="VOLUME", help="ready bone probability, 0 to 1")
    add_setting(source, "bone_from_sweep")
    source.add_argument(
        "--bone-frames",
        type=Path,
        action="append",
        metavar="SEQUENCE",
        help="no CT: a sequence of a network's predictions for the frames, 8 bit or 0 to 1; of several sweeps once for each",
    )
    source.add_argument(
        "--bone-model", type=Path, metavar="FILE.onnx", help="no CT: a network that tells bone in a frame (needs onnxruntime)"
    )
    bone.add_argument(
        "--bone-transform",
        type=Path,
        metavar="FILE",
        help="transform CT -> Reference as Slicer saves it (.tfm, .txt, .h5); default: none needed",
    )
    add_width_options(bone)
    add_settings(bone, BoneSettings)


def add_width_options(group: argparse._ActionsContainer) -> None:
    """Smoothing of the bone map, in voxels or mm."""
    width = group.add_mutually_exclusive_group()
    for name in ("bone_sigma_voxels", "bone_sigma_mm"):
        add_setting(width, name)


def check_bone_options(arguments: argparse.Namespace) -> None:
    """Return if the options that say where bone is go together.

    Raises
    ------
    SettingsError
    """
    check_seen_bone(arguments)
    if arguments.bone_transform and not (arguments.bone_labels or arguments.bone_probability):
        raise SettingsError("--bone-transform places a bone input, and there is none. Give --bone-labels or --bone-probability.")


def seen_source(arguments: argparse.Namespace) -> str | None:
    """The option, as users write it, that lets the frames say where bone is; None where there is none."""
    return next((f"--{name.replace('_', '-')}" for name in SOURCES if getattr(arguments, name, None)), None)


def check_seen_bone(arguments: argparse.Namespace) -> None:
    """Return if these options go together with the others.

    Raises
    ------
    SettingsError
    """
    source = seen_source(arguments)
    if getattr(arguments, "bone_frames_px", None) and not getattr(arguments, "bone_frames", None):
        raise SettingsError("--bone-frames-px says what predictions cover, and there are none. Give --bone-frames.")
    if source is None:
        return
    if arguments.bone_transform:
        raise SettingsError("--bone-transform places a CT, and {source} needs none. Leave out one of them.", source=source)
    if getattr(arguments, "speed_of_sound", None) is not None:
        raise SettingsError(
            "{source} takes depths as the images show them. Leave out --speed-of-sound, or give --bone-labels.", source=source
        )


def seen_bone_inputs(arguments: argparse.Namespace) -> list[Path | None]:
    """The files that they name."""
    model = getattr(arguments, "bone_model", None)
    return [*(getattr(arguments, "bone_frames", None) or []), model, None if model is None else beside(model)]


def beside(model: Path) -> Path | None:
    """The description of a model, where there is one."""
    path = model.parent / f"{model.stem}.json"
    return path if path.is_file() else None


def labeled_bone_from(arguments: argparse.Namespace, sequence: TrackedSequence | None, recipe: Recipe) -> LabeledBone | None:
    """The labels that the options name, placed in Reference; None where they name none. A live scan has no sequence yet."""
    check_bone_options(arguments)
    if not arguments.bone_labels:
        return None
    return LabeledBone(read_labels(arguments.bone_labels), _place(arguments), sequence, recipe)


def _place(arguments: argparse.Namespace) -> Matrix | None:
    return read_transform(arguments.bone_transform) if arguments.bone_transform else None


def bone_from(
    arguments: argparse.Namespace,
    labeled: LabeledBone | None,
    sequence: TrackedSequence | None,
    recipe: Recipe,
    progress: Progress | None = None,
) -> BoneMap | None:
    """The bone map that the recipe's method gets of the labels of `labeled_bone_from`, or of what else the options name; None of nothing.

    A live scan has no sequence yet.
    """
    if labeled is not None:
        return labeled.map(recipe.method_for(True), progress)
    if arguments.bone_probability:
        return BoneMap.from_probability(read_volume(arguments.bone_probability), _place(arguments))
    if sequence is None:
        if recipe.bone_from_sweep:
            raise SettingsError("--bone-from-sweep looks at a recorded sweep. Give --bone-labels or --bone-probability.")
        return None
    if recipe.bone_from_sweep:
        return bone_from_sweep(sequence, recipe=recipe, progress=progress)
    if arguments.bone_frames:
        predicted = [read_sequence(path) for path in arguments.bone_frames]
        return bone_from_frames(sequence, RecordedPredictions(sequence, predicted, recipe.bone_frames_px), recipe=recipe, progress=progress)
    if arguments.bone_model:
        return bone_from_frames(sequence, OnnxModel(arguments.bone_model, usable_cores()), recipe=recipe, progress=progress)
    return None
