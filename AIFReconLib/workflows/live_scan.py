"""A live scan: a session, what looks for bone beside it, and the box around what was scouted."""

from __future__ import annotations

from ..bone.echoes.surface import LEAST_A_FRAME
from ..bone.growing_bone import GrowingBone
from ..bone.map import BoneMap
from ..bone.network.model import OnnxModel
from ..bone.predicted_bone import BoneEstimator, EchoEstimator
from ..effective_settings import Imaging
from ..geometry.volume import VoxelGrid
from ..live.session.bone_watch import BoneWatch, predictions_beside
from ..live.session.recording import Recorder
from ..live.session.session import LiveSession
from ..live.wire.sources import MessageSource
from ..progress import Progress
from ..registration.labeled_bone import LabeledBone
from .job import ScanJob

SCOUT_MARGIN = 5.0
"""mm added on each side of the box that was scouted."""


class LiveScan:
    """A scan that is ready to begin; what looks for bone goes on while a `with` block does.

    Parameters
    ----------
    job : ScanJob
    source : MessageSource
    progress : Progress or None
        Of the bone map.
    """

    def __init__(self, job: ScanJob, source: MessageSource, progress: Progress | None = None):
        self.labels, self.bone_to_reference = job.bone.labels, job.bone.to_reference
        self.labeled: LabeledBone | None = None
        self.growing: GrowingBone | None = None
        self.bone_watch: BoneWatch | None = None
        self._job = job
        if job.sees_bone:
            by_echoes = job.recipe.bone_from_sweep
            made: dict[str, object] = {"bone_from_sweep": True} if by_echoes else {}
            self.growing = GrowingBone(least_a_frame=LEAST_A_FRAME if by_echoes else 0.0, made=made)
        # Refused before the scan, not in it
        self._model = None if job.bone.model is None else OnnxModel(job.bone.model)
        self.session = LiveSession(
            source,
            job.recipe,
            self.growing or self.bone_map(progress),
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
        return self

    def __exit__(self, *_: object) -> None:
        """Look no further."""
        if self.bone_watch is not None:
            self.bone_watch.stop()

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

    def _estimator(self, imaging: Imaging) -> BoneEstimator:
        return self._model or EchoEstimator(imaging)
