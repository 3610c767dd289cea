"""A live scan: a session, what looks for bone beside it, and the box around what was scouted."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..bone.echoes.surface import LEAST_A_FRAME
from ..bone.field import BoneField
from ..bone.growing_bone import GrowingBone
from ..bone.map import BoneMap
from ..bone.network.model import OnnxModel
from ..bone.predicted_bone import BoneEstimator, EchoEstimator
from ..compounding.state import Reconstruction
from ..effective_settings import Imaging, takes_out_motion
from ..geometry.volume import Volume, VoxelGrid
from ..live.pairing.placement import UNCONFIRMED
from ..live.session.bone_watch import BoneWatch, predictions_beside
from ..live.session.motion_watch import MotionWatch
from ..live.session.recording import Recorder
from ..live.session.session import LiveSession
from ..live.wire.sources import QueueSource, StreamStatistics
from ..message import Sentence, Spelling, advised, as_argument
from ..motion.solve import BoneInPlace
from ..progress import Progress
from ..recipe.recipe import AUTOMATIC
from ..registration.labeled_bone import LabeledBone
from .job import ScanJob

TRUST_THE_POSE = "or give {trust_image_pose} if it sends no image without a valid pose."

SCOUT_MARGIN = 5.0
"""mm added on each side of the box that was scouted."""


class LiveScan:
    """A scan that is ready to begin; what looks for bone goes on while a `with` block does.

    Parameters
    ----------
    job : ScanJob
    source : QueueSource
    progress : Progress or None
        Of the bone map.
    """

    def __init__(self, job: ScanJob, source: QueueSource, progress: Progress | None = None):
        self.labels, self.bone_to_reference = job.bone.labels, job.bone.to_reference
        self.labeled: LabeledBone | None = None
        self.growing: GrowingBone | None = None
        self.bone_watch: BoneWatch | None = None
        self.motion_watch: MotionWatch | None = None
        self._field: tuple[Volume, BoneField] | None = None
        self._job = job
        if job.sees_bone:
            by_echoes = job.recipe.bone_from_sweep
            made: dict[str, object] = {"bone_from_sweep": True} if by_echoes else {}
            self.growing = GrowingBone(least_a_frame=LEAST_A_FRAME if by_echoes else 0.0, made=made)
        # Refused before the scan, not in it
        self._model = None if job.bone.model is None else OnnxModel(job.bone.model)
        bone = self.growing or self.bone_map(progress)
        asked = replace(job.recipe, method=job.recipe.method_for(bone is not None))
        self._takes_out_motion = takes_out_motion(asked)
        self.session = LiveSession(
            source,
            replace(job.recipe, motion=AUTOMATIC) if self._takes_out_motion else job.recipe,
            bone,
            job.grid,
            configuration=job.configuration,
            synchronizer=job.synchronizer,
            record=None if job.record is None else Recorder(job.record, job.takes_up),
            frame_limit=job.frame_limit,
            predictions_device=job.bone.device,
        )

    def __enter__(self) -> LiveScan:
        """Begin to look for bone in the frames, where they say where that is."""
        if self.growing is not None:
            recorder, by_echoes = self.session.recorder, self._job.recipe.bone_from_sweep
            # What a network says is recorded beside the scan
            beside = None if recorder is None or by_echoes else predictions_beside(recorder.path)
            estimator = None if self._job.bone.device else self._estimator
            self.bone_watch = BoneWatch(self.session, self.growing, estimator, beside)
        if self._takes_out_motion:
            self.motion_watch = MotionWatch(self.session, self._bone_in_place, self.growing)
            self.session.at_end = self._lay_last
        return self

    def __exit__(self, *_: object) -> None:
        """Look no further."""
        for watch in (self.bone_watch, self.motion_watch):
            if watch is not None:
                watch.stop()

    def _lay_last(self, progress: Progress | None) -> None:
        """When no frame comes any more, lay the last pass on the others."""
        if self.bone_watch is not None:
            self.bone_watch.stop()
        if self.motion_watch is not None:
            self.motion_watch.lay_last(progress)

    def _bone_in_place(self) -> BoneInPlace | None:
        """The bone of the CT where it lies now."""
        if self.labels is None:
            return None
        if self._field is None or self._field[0] is not self.labels:
            self._field = self.labels, BoneField.from_labels(self.labels)
        return BoneInPlace(self._field[1], np.eye(4) if self.bone_to_reference is None else self.bone_to_reference)

    def bone_map(self, progress: Progress | None = None) -> BoneMap | None:
        """The map of the CT where it lies now."""
        if self.labels is not None:
            self.labeled = LabeledBone(self.labels, self.bone_to_reference, None, self._job.recipe)
            return self.labeled.map(self._job.recipe.method_for(True), progress)
        probability = self._job.bone.probability
        return None if probability is None else BoneMap.from_probability(probability, self.bone_to_reference)

    def use_scouted_box(self) -> VoxelGrid:
        """Reconstruct in the box around what was seen so far, which is returned.

        Raises AIFReconError where it cannot be told yet.
        """
        grid = self.session.grid_from_scout(margin=SCOUT_MARGIN)
        self.session.use_grid(grid)
        return grid

    # ---- what became of it

    @property
    def recording_line(self) -> str | None:
        """What was recorded, or why not all of it; None where nothing was to be."""
        recorder, path = self.session.recorder, self.session.recorded
        if recorder is None or recorder.failure or path is None:
            return self.session.recording_failure
        recorded = f"recorded {recorder.frames} frames to {path}"
        more = " ".join(filter(None, (recorder.loss, recorder.note)))
        return f"{recorded}. {more}" if more else recorded

    def why_nothing(self, stream: StreamStatistics, words: Spelling = as_argument) -> str:
        """Why there is no volume: the most frequent reason first; `words` say what to do about it."""
        statistics, error = self.session.statistics, self.session.error
        if error is not None:
            return f"The reconstruction could not begin: {advised(error, words)}"
        if not statistics.frames_received:
            return "No frame was received, so there is no volume."
        reasons = "; ".join(f"{reason}: {count}" for reason, count in sorted(statistics.skipped.items(), key=lambda item: -item[1]))
        refused = [f"Messages were refused: {reason}" for reason in stream.refusals.values()]
        # What troubles the stream says what to do itself
        advice = [statistics.trouble, *refused] if statistics.trouble or refused else ["Check the tracking, then scan again."]
        if UNCONFIRMED in statistics.skipped:
            advice = [*filter(None, advice[:-1]), Sentence("Let the server send the transforms of its tools,", TRUST_THE_POSE)]
        nothing = f"Not one of {statistics.frames_received} frames entered a volume ({reasons})."
        return " ".join(advised(each, words) for each in filter(None, [nothing, *advice]))

    def what_else(self, stream: StreamStatistics, result: Reconstruction) -> list[str]:
        """What happened besides the reconstruction."""
        statistics = self.session.statistics
        lines = [f"skipped: {count}: {reason}" for reason, count in statistics.skipped.items() if reason not in result.skipped]
        lines += [statistics.note] if statistics.note else []
        if stream.refused:
            lines.append(f"{stream.refused} messages were refused: {' '.join(stream.refusals.values())}")
        left_out = {
            "messages were damaged on the way, and": stream.damaged,
            "messages came faster than this computer took them, and were": max(statistics.dropped - stream.late, 0),
            "images were sent again after a reconnection, and": statistics.repeated,
            "images came from other devices, and were": statistics.other_images,
        }
        return [*lines, *(f"{count} {what} left out" for what, count in left_out.items() if count)]

    def _estimator(self, imaging: Imaging) -> BoneEstimator:
        return self._model or EchoEstimator(imaging)
