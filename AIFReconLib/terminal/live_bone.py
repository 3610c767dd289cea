"""Bone that a live scan shows by itself: what `--bone-image`, `--bone-model` and `--bone-from-sweep` mean while frames come in."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..bone.echoes.surface import LEAST_A_FRAME
from ..bone.growing_bone import GrowingBone
from ..bone.network.model import OnnxModel
from ..bone.predicted_bone import BoneEstimator, EchoEstimator
from ..errors import SettingsError
from ..live.session.bone_watch import BoneWatch, predictions_beside
from ..live.session.session import LiveSession
from ..resolve import Imaging
from .reconstruction_options import seen_source
from .remedies import in_options


def add_streamed_bone_option(server: argparse._ActionsContainer) -> None:
    """Declare --bone-image."""
    server.add_argument(
        "--bone-image",
        metavar="DEVICE",
        help="no CT: name of an image device that sends a network's predictions with the time stamps of their images",
    )


def predictions_path(arguments: argparse.Namespace) -> Path | None:
    """Where predictions are recorded beside a recorded scan; None where they are not."""
    record: Path | None = arguments.record
    if record is None or not (arguments.bone_image or arguments.bone_model):
        return None
    return predictions_beside(record)


class LiveBone:
    """What looks for bone beside a session."""

    def __init__(self, arguments: argparse.Namespace):
        by_echoes = arguments.bone_from_sweep
        self.bone = GrowingBone(least_a_frame=LEAST_A_FRAME if by_echoes else 0.0, made={"bone_from_sweep": True} if by_echoes else {})
        self._device: str | None = arguments.bone_image
        # Refused before the scan, not in it
        self._model = OnnxModel(arguments.bone_model) if arguments.bone_model else None
        self._records = predictions_path(arguments) is not None
        self._scan: Path | None = None
        self._watch: BoneWatch | None = None
        self._frames = 0

    @classmethod
    def of(cls, arguments: argparse.Namespace) -> LiveBone | None:
        """What the options ask for; None where they ask for none.

        Raises SettingsError when options do not go together.
        """
        if arguments.bone_frames:
            raise SettingsError("--bone-frames belongs to a recorded sweep. Give --bone-image or --bone-model for a live scan.")
        source = seen_source(arguments)
        if source is None:
            return None
        others = ("bone_labels", "ct", "bone_probability", "bone_transform", "bone_model", "bone_from_sweep")
        both = next((name for name in others if arguments.bone_image and getattr(arguments, name)), None)
        if both is not None:
            raise SettingsError(f"--bone-image is a source of bone, and so is --{both.replace('_', '-')}. Leave out one.")
        if arguments.bone_image and arguments.bone_image == arguments.image:
            raise SettingsError(f"--bone-image and --image must be two devices; got {arguments.image!r} for both.")
        return cls(arguments)

    @contextmanager
    def beside(self, session: LiveSession) -> Iterator[None]:
        """Look for bone while the block runs."""
        record = predictions_beside(session.recorder.path) if self._records and session.recorder is not None else None
        self._watch = BoneWatch(session, self.bone, None if self._device else self._estimator, record)
        try:
            yield
        finally:
            self._watch.stop()
            self._frames, self._scan = session.statistics.frames_received, session.recorded

    def lines(self) -> list[str]:
        """How it went, for the summary."""
        if self._watch is None:
            return []
        state = self._watch.state
        done = "looked for in" if self._device is None else "predicted for"
        lines = [f"bone was {done} {state.frames} of {self._frames} frames"]
        if state.unmatched:
            lines.append(f"{state.unmatched} predictions belonged to no frame with a pose")
        if state.problem is not None:
            lines.append(in_options(state.problem))
        if self._watch.recorded is not None:
            lines.append(f"recorded what was said of bone to {self._watch.recorded}")
        if self._scan is not None:
            told = "--bone-from-sweep" if self._watch.recorded is None else f"--bone-frames {self._watch.recorded}"
            lines.append(f"to weight all frames by all that was found: aifrecon reconstruct {self._scan} {told}")
        return lines

    def _estimator(self, imaging: Imaging) -> BoneEstimator:
        return self._model or EchoEstimator(imaging)
