"""`--bone-frames` and `--bone-model`: bone from a network's predictions, recorded or made here."""

from __future__ import annotations

import argparse
from pathlib import Path

from ..bone.estimators import BoneEstimator, bone_from_frames
from ..bone.map import BoneMap
from ..bone.model import OnnxModel
from ..bone.recorded import RecordedPredictions
from ..errors import SettingsError
from ..imaging.beams import ProbeGeometry
from ..imaging.region import ImageRegion
from ..io.sequence.files import read_sequence
from ..machine.threads import usable_cores
from ..progress import Progress
from ..resolve import resolve_imaging
from ..sweep.frames import TrackedSequence
from ..sweep.poses import sweep_poses

SOURCES = ("bone_from_sweep", "bone_frames", "bone_model", "bone_image")
"""Options by which the frames themselves say where bone is."""


def add_seen_bone_options(source: argparse._ActionsContainer, group: argparse._ActionsContainer) -> None:
    """Declare them: one of `source`, and what belongs to it in `group`."""
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
    group.add_argument(
        "--bone-frames-px",
        type=float,
        nargs=4,
        metavar=("X", "Y", "W", "H"),
        help="rectangle of the frame that a prediction covers, where it has not the size of one",
    )


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
        raise SettingsError(f"--bone-transform places a CT, and {source} needs none. Leave out one of them.")
    if getattr(arguments, "speed_of_sound", None) is not None:
        raise SettingsError(f"{source} takes depths as the images show them. Leave out --speed-of-sound, or give --bone-labels.")


def seen_bone_inputs(arguments: argparse.Namespace) -> list[Path | None]:
    """The files that they name."""
    model = getattr(arguments, "bone_model", None)
    return [*(getattr(arguments, "bone_frames", None) or []), model, None if model is None else beside(model)]


def beside(model: Path) -> Path | None:
    """The description of a model, where there is one."""
    path = model.parent / f"{model.stem}.json"
    return path if path.is_file() else None


def seen_bone_from(
    arguments: argparse.Namespace,
    sequence: TrackedSequence,
    region: ImageRegion | None,
    probe: ProbeGeometry | None,
    progress: Progress | None = None,
) -> BoneMap | None:
    """The bone map that --bone-frames or --bone-model gives; None where neither is asked for."""
    estimator: BoneEstimator
    if getattr(arguments, "bone_frames", None):
        said = [read_sequence(path) for path in arguments.bone_frames]
        rectangle = tuple(arguments.bone_frames_px) if arguments.bone_frames_px else None
        estimator = RecordedPredictions(sequence, said, rectangle)
    elif getattr(arguments, "bone_model", None):
        estimator = OnnxModel(arguments.bone_model, usable_cores())
    else:
        return None
    poses = sweep_poses(sequence, arguments.image_to_reference, arguments.reference)
    poses.require_usable(sequence.name)
    return bone_from_frames(sequence, estimator, poses, resolve_imaging(sequence, poses, True, region, probe), progress)
