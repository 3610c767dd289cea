"""A patient who moves during a scan: each finished pass is laid on those before, and the volume made anew where that moves it."""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import partial

import numpy as np

from ...arrays import Integers, Matrix
from ...bone.echoes.finder import LEAST_SCORE, BoneEchoFinder
from ...bone.echoes.found import FEWEST, SweepEchoes
from ...bone.echoes.surface import LEAST_SCORE as LEAST_OF_SURFACE
from ...bone.growing_bone import GrowingBone
from ...bone.scan_line_reader import ForEachKind
from ...effective_settings import Imaging
from ...message import message_of
from ...motion.motion import PatientMotion, motion_of
from ...motion.passes import Passes, parted
from ...motion.solve import BoneInPlace
from ...progress import Progress, Steps, carry_out
from ..pairing.synchronizer import LiveFrame
from .session import LiveSession
from .watch import Watch

logger = logging.getLogger(__name__)

PERIOD = 0.5
"""s between two looks at the passes."""

OF_A_PASS = 40
"""Frames of a pass whose echoes are looked at, evenly among them."""

TOO_LONG = "More frames came than can be kept: motion is taken out no further. Reconstruct the recorded scan."

NEWS = 0.5
"""mm, root mean square over the frames, by which they must lie elsewhere than in the volume for it to be made anew."""


class MotionWatch(Watch):
    """Lays passes on each other, and on a CT's bone, while a scan goes on, and the last one when it ends.

    Parameters
    ----------
    session : LiveSession
        Asked for with the setting `motion`.
    bone : callable
        The bone of the CT where it lies now, or None.
    growing : GrowingBone or None
        What frames themselves show of bone; it begins anew with the volume.

    Attributes
    ----------
    motion : PatientMotion or None
        That was taken out last.
    problem : str or None
        Why passes are laid on each other no longer.
    """

    def __init__(self, session: LiveSession, bone: Callable[[], BoneInPlace | None], growing: GrowingBone | None = None):
        super().__init__(session, PERIOD)
        self._bone_now, self._growing = bone, growing
        self._finders: ForEachKind[BoneEchoFinder] | None = None
        self._found: dict[int, SweepEchoes] = {}
        self._kept: list[LiveFrame] | None = None
        self._in_force = np.eye(4)[None]
        self._finished = 0
        self.motion: PatientMotion | None = None
        self._start()

    @property
    def lines(self) -> tuple[str, ...]:
        """What was found, in sentences."""
        told = () if self.motion is None else self.motion.lines
        return told if self.problem is None else (*told, self.problem)

    def _look(self, frame: LiveFrame | None) -> Steps[None]:
        imaging = None if frame is None else self._session.imaging()
        yield from self._lay(imaging, is_over=False)

    def lay_last(self, progress: Progress | None = None) -> None:
        """Stop, and lay the pass that was going on when the scan ended on the others, too; nobody else may tell of bone any more."""
        self.stop()
        self._finished = 0
        try:
            carry_out(self._lay(self._session.imaging(), is_over=True), progress)
        except Exception as error:  # told: the volume so far must survive it
            logger.exception("The last pass of a live scan could not be laid on the others")
            self._tell_problem(message_of(error))

    def _lay(self, imaging: Imaging | None, is_over: bool) -> Steps[None]:
        """Where one pass more is finished, find how the patient moved, and make the volume anew where that tells."""
        kept = self._session.kept
        if kept is None and self._kept is not None:
            self.problem = TOO_LONG
        if imaging is None or kept is None:
            return
        if kept is not self._kept:
            self._kept, self._found, self._finished, self._in_force = kept, {}, 0, np.eye(4)[None]
        frames = list(kept)
        poses = np.array([frame.placed()[1] for frame in frames])
        times = np.array([frame.timestamp for frame in frames])
        numbers = parted(times, poses) if len(frames) > 1 else np.zeros(len(frames), np.int64)
        finished = int(numbers.max(initial=-1)) + is_over
        if finished < 2 or finished <= self._finished:
            return
        self._finished = finished
        for number in self._chosen(numbers, finished):
            if number not in self._found:
                self._found[number] = self._echoes_of(imaging, frames[number], number)
                yield number / len(frames), "Looking for bone in the sweep"
        echoes = SweepEchoes.joined(list(self._found.values()))
        passes = Passes(np.where(numbers < finished, numbers, -1), times, poses)
        sure = echoes[(echoes.scores >= LEAST_SCORE) & (passes.numbers[echoes.frames] >= 0)]
        if len(sure) < FEWEST:
            return
        motion = motion_of(sure, passes, self._bone_now())
        yield 0.5, "Taking the patient's motion out"
        moved = motion.curve.matrices if motion.applied else np.tile(np.eye(4), (len(frames), 1, 1))
        # Who has moved lies there until another pass tells more
        moved[numbers >= finished] = moved[np.flatnonzero(numbers < finished)[-1]]
        if self._lies_elsewhere(moved, motion.curve.places):
            if self._growing is not None:
                of = moved[echoes.frames]
                points, beams = (np.einsum("nij,nj->ni", of[:, :3, :3], each) for each in (echoes.points, echoes.beams))
                self._growing.begin_anew(SweepEchoes(points + of[:, :3, 3], beams, echoes.scores, echoes.frames, echoes.dark))
            if (yield from self._session.rebuild(kept, moved, self._tell_bone(is_over), motion.lines)):
                self._in_force, self.motion = moved, motion

    def _tell_bone(self, is_over: bool) -> Steps[None]:
        """Until the volume knows of bone all that frames have shown."""
        if self._growing is None:
            return
        if is_over:
            yield from self._growing.spread()
        while not self._growing.has_told:
            yield 0.0, "Telling the volume of bone"

    def _chosen(self, numbers: Integers, finished: int) -> list[int]:
        """Evenly some frames of each pass that is finished."""
        chosen: list[int] = []
        for number in range(finished):
            mine = np.flatnonzero(numbers == number)
            chosen += mine[np.unique(np.linspace(0, len(mine) - 1, min(len(mine), OF_A_PASS)).astype(np.int64))].tolist()
        return chosen

    def _echoes_of(self, imaging: Imaging, frame: LiveFrame, number: int) -> SweepEchoes:
        self._finders = self._finders or ForEachKind(partial(BoneEchoFinder, least=LEAST_OF_SURFACE), imaging)
        image, pose = frame.placed()
        return self._finders.of(frame).find(image).placed(pose, number)

    def _lies_elsewhere(self, moved: Matrix, places: Matrix) -> bool:
        """Whether frames moved so lie elsewhere than they do in the volume; `places` (n, 3) is where the bone is that each shows."""
        before = np.concatenate([self._in_force, np.repeat(self._in_force[-1:], max(len(moved) - len(self._in_force), 0), axis=0)])
        change = moved - before[: len(moved)]
        by = np.einsum("nij,nj->ni", change[:, :3, :3], places) + change[:, :3, 3]
        return bool(np.sqrt((by**2).sum(axis=1).mean()) > NEWS)
