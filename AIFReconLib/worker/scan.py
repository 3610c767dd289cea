"""A live scan in the worker: session, watches and recording, and what a window shows of them."""

from __future__ import annotations

import logging
import time
from collections.abc import Sequence
from concurrent.futures import Future, wait
from dataclasses import replace

import numpy as np

from ..arrays import Floats, Matrix
from ..bone.echoes.found import FEWEST, SweepEchoes
from ..bone.field import BoneField
from ..compounding.state import Reconstruction
from ..errors import BeamGeometryError, GeometryError
from ..evaluation.visibility import SweepBeams
from ..geometry.volume import Volume
from ..guidance.guidance import Guidance
from ..live.session.agreement_watch import AgreementWatch
from ..live.session.guidance_watch import GuidanceWatch
from ..live.session.resumed_recording import unfinished_frames
from ..live.session.session import SCOUTING
from ..live.wire.client import OpenIGTLinkClient
from ..live.wire.messages import StreamMessage
from ..live.wire.sources import QueueSource
from ..machine.threads import usable_cores
from ..message import message_of
from ..progress import Progress, part, report
from ..registration.live import SECONDS
from ..workflows.job import ScanJob
from ..workflows.live_scan import LiveScan
from .scanning import Seen, shown_of

logger = logging.getLogger(__name__)

SNAP_EVERY = 0.5
"""s between two snapshots of the volume: each has holes filled, which takes cores from insertion."""

LOOK_EVERY = 0.05
"""s between two looks at what is being prepared."""


class Scan(LiveScan):
    """A scan that goes on from its making to `finish` or `close`.

    Raises AIFReconError with what is missing or wrong; nothing is left running.

    Parameters
    ----------
    progress : Progress or None
        Of what is made before the first frame is received: the bone map, the network, compiled code, the surface of bone.
    """

    def __init__(self, job: ScanJob, progress: Progress | None = None):
        configuration = job.configuration
        self._given = None if job.server is not None else QueueSource()
        # One core stays with the windows, unless the configuration says how many threads insert
        threads = configuration.threads or max(usable_cores() - 1, 1)
        job = replace(job, configuration=replace(configuration, threads=threads))
        super().__init__(job, self._given or OpenIGTLinkClient(*job.server or ("", 0)), part(progress, 0.0, 0.5))
        self._spans: list[tuple[int, int | None]] = [(0, None)]
        self._poses: list[Matrix] = []
        self._noted = -1
        self._snapshot: Future[Reconstruction | None] | None = None
        self._shown_frames = -1
        self._snapshot_error: str | None = None
        self._agreement: AgreementWatch | None = None
        self._guidance: GuidanceWatch | None = None
        self._told: Guidance | None = None
        self._snapped = 0.0
        recorder = self.session.recorder
        try:
            if self.labels is not None and self.bone_to_reference is not None:
                self._agreement = AgreementWatch(self.session, BoneField.from_labels(self.labels), self.bone_to_reference)
            self.__enter__()
            self.guide(job.guidance)
            while self._guidance is not None and not self._guidance.prepared.wait(LOOK_EVERY):
                report(progress, 0.6, "Finding the surface of bone")
            while not self.session.prepare(LOOK_EVERY):
                report(progress, 0.7, "Preparing the scan")
            if recorder is not None and recorder.frames:
                self.session.earlier = unfinished_frames(recorder.path, configuration, job.spans)
                self._spans = list(job.spans)
                if self._spans[-1][1] is not None:
                    self.session.pause()
            self.session.start()
        except BaseException:
            self.close()
            raise

    # ---- what the window asks for

    def look(self, frame: int = -1, surface: int | None = None) -> Seen:
        """What is new.

        Parameters
        ----------
        frame : int
            Number of the frame that is shown: another comes along.
        surface : int or None
            Number of the mesh of bone that is shown: another comes along with guidance.
        """
        session, statistics = self.session, self.session.statistics
        self._note_poses()
        result = self._new_volume(statistics.inserted)
        watch = self._agreement
        agreement = None if watch is None else watch.agreement
        problems = [None if watch is None else watch.problem]
        problems += [self._snapshot_error, *self._recording_problems()]
        latest = session.latest
        guidance = None if self._guidance is None else self._guidance.state
        is_told, self._told = guidance is self._told, guidance
        return Seen(
            statistics=statistics,
            grid=session.grid,
            scouted=session.scouted,
            spans=tuple(self._spans),
            frame=latest if latest is not None and latest.number != frame and latest.status == "OK" else None,
            result=None if result is None else shown_of(result),
            guidance=None if guidance is None or is_told else guidance.seen(surface),
            has_fallen=watch is not None and watch.has_fallen,
            compared=-1 if watch is None else watch.looked_at,
            agreement="" if agreement is None else f"Last {SECONDS:.0f} s: {agreement.sentence()}",
            bone_lines=(
                *(() if self.bone_watch is None else self.bone_watch.lines(statistics.frames_received)),
                *(() if self.motion_watch is None else self.motion_watch.lines),
            ),
            problems=tuple(problem for problem in problems if problem),
            record=None if session.recorder is None else session.recorder.path,
        )

    def put(self, message: StreamMessage, replaced: int = 0) -> None:
        """Take an image that the window has from elsewhere; so many others were replaced before it could take them."""
        if self._given is not None:
            self._given.replaced = replaced
            self._given.put(message)

    def pause(self, paused: bool) -> None:
        """Insert nothing for a while, or go on."""
        (self.session.pause if paused else self.session.resume)()
        first, stop = self._spans[-1]
        if paused and stop is None:
            self._spans[-1] = first, self._recorded()
        elif not paused and stop is not None:
            self._spans.append((self._recorded(), None))

    def reset(self) -> None:
        """Empty the volume and go on."""
        self.session.reset()
        self._poses.clear()
        self._spans = [(self._recorded(), self._spans[-1][1] and self._recorded())]

    def guide(self, wanted: bool) -> None:
        """Tell from now on what is met of the labels, else of the bone that frames show, and where to look next; or do so no longer."""
        if wanted and self._guidance is None and self.labels is not None and self.bone_to_reference is not None:
            self._guidance = GuidanceWatch(self.session, self.labels, self.bone_to_reference, self._job.unseen)
        elif wanted and self._guidance is None and self.labels is None and self.growing is not None:
            self._guidance = GuidanceWatch(self.session, self.growing, unseen=self._job.unseen)
        elif not wanted and self._guidance is not None:
            ended, self._guidance = self._guidance, None
            ended.stop(wait_for_it=False)

    def place(self, bone_to_reference: Matrix, labels: Volume | None = None) -> None:
        """The CT lies elsewhere now, or has other labels."""
        self.bone_to_reference, before = bone_to_reference, self._agreement
        if labels is not None:
            self.labels = labels
            self._agreement = AgreementWatch(self.session, BoneField.from_labels(labels), bone_to_reference)
            if before is not None:
                before.stop(wait_for_it=False)
        elif before is not None:
            before.place(bone_to_reference)
        if self._guidance is not None:
            self._guidance.place(bone_to_reference, labels)

    def follow_bone(self, bone_to_reference: Matrix, progress: Progress | None = None) -> bool:
        """Weight by the bone where it lies now; True where a volume is growing already, which keeps the weights that it began with.

        Where the frames themselves say where bone is, the place of the CT changes nothing.
        """
        self.bone_to_reference = bone_to_reference
        if self.growing is not None:
            return False
        bone = self.bone_map(progress)
        if bone is not None:
            self.session.use_bone(bone)
        return self.session.grid is not None and self.session.statistics.phase != SCOUTING

    def echoes(self) -> SweepEchoes:
        """The bone echoes so far, to place the CT by.

        Raises GeometryError when the scan has shown too little bone.
        """
        echoes = SweepEchoes.joined(()) if self._agreement is None else self._agreement.echoes()
        if len(echoes) < FEWEST:
            raise GeometryError(
                f"The scan has shown {len(echoes)} bone echoes so far; {FEWEST} are needed to place the CT. Scan the bone some seconds "
                "longer, then press “Place CT on sweep” again."
            )
        return echoes

    def finish(self, progress: Progress | None = None) -> Seen:
        """End the scan: the final volume, and where everything was recorded. A cancel ends the scan all the same."""
        self._stop_watches()
        result = self.session.finish(progress)
        if result is not None and not result.frames_inserted:
            result = None
        # With the score, which tells what was seen
        shown = None if result is None else shown_of(result, ("score",))
        problems = tuple(self._recording_problems())
        return Seen(
            self.session.statistics,
            result=shown,
            problems=problems,
            recorded=self.session.recorded,
            predictions=None if self.bone_watch is None else self.bone_watch.recorded,
            skin=self._skin(),
        )

    def close(self) -> None:
        """End the scan, its recording finished."""
        self._stop_watches()
        self.session.at_end = None
        self.session.stop()

    # ---- parts

    def _new_volume(self, inserted: int) -> Reconstruction | None:
        """The volume, where one was made since it was last asked for; and where frames have entered since, another is begun."""
        made = None
        if self._snapshot is not None and self._snapshot.done():
            error, self._snapshot_error = self._snapshot.exception(), None
            if error is None:
                made = self._snapshot.result()
            else:
                self._snapshot_error = message_of(error)
                logger.error("A snapshot of a live scan could not be made", exc_info=error)
            self._snapshot = None
        if self._snapshot is None and inserted != self._shown_frames and time.monotonic() - self._snapped >= SNAP_EVERY:
            self._snapped, self._shown_frames = time.monotonic(), inserted
            self._snapshot = self.session.pool.submit(self.session.snapshot)
        return made

    def _note_poses(self) -> None:
        """Remember where the probe was in the frames that have come since: its face was on the skin."""
        for frame in tuple(self.session.recent):
            if frame.number > self._noted and frame.status == "OK" and frame.image_to_reference is not None:
                self._poses.append(frame.image_to_reference)
                self._noted = frame.number

    def _skin(self) -> Floats | None:
        self._note_poses()
        latest = self.session.latest
        try:
            imaging = self.session.imaging()
        except BeamGeometryError:
            return None
        if imaging is None or imaging.probe is None or not self._poses or latest is None or latest.image is None:
            return None
        rows, columns = latest.image.shape
        return SweepBeams(np.array(self._poses), (columns, rows), imaging.probe, imaging.region).skin()

    def _recording_problems(self) -> Sequence[str]:
        recorder = self.session.recorder
        problems = () if recorder is None else (recorder.failure, recorder.loss, recorder.note)
        return [problem for problem in problems if problem]

    def _recorded(self) -> int:
        return 0 if self.session.recorder is None else self.session.recorder.frames

    def _stop_watches(self) -> None:
        if self._snapshot is not None:
            wait([self._snapshot])
        for watch in (self._agreement, self._guidance, self.bone_watch, self.motion_watch):
            if watch is not None:
                watch.stop()
