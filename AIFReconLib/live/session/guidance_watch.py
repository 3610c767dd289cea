"""What a scan has met of the bone while it goes on, and where to look next."""

from __future__ import annotations

import itertools
import threading
import time
from collections.abc import Iterable, Iterator
from functools import partial

import numpy as np

from ...arrays import Floats, Matrix, Numbers
from ...bone.growing_bone import GrowingBone
from ...effective_settings import Imaging
from ...geometry.volume import Volume
from ...guidance.bone import GuidedBone, bone_of_echoes, guided_bone
from ...guidance.bone_coverage import CoverageAccumulator, FrameGeometry
from ...guidance.coverage import is_awry, unrefuted
from ...guidance.guidance import FAR, NOT_IN_BOX, Advisor, Guidance, has_come_near, holds_bone
from ...guidance.mesh import ColoredBone
from ...guidance.window import window
from ...progress import Steps
from ..pairing.synchronizer import LiveFrame
from .session import LiveSession
from .watch import Watch

TELL_EVERY = 0.15
"""s between two summaries, so that colors change five times a second."""

ADVISE_EVERY = 0.5
"""s between two advices."""

SKIN_AFTER = 20
"""Frames that have felt the skin before candidate passes are laid upon it."""

MOST_POSES = 2000
"""Frames that are looked at again when the CT is placed anew."""

AT_ONCE = 5
"""Of those, between two looks at new ones."""

FAR_AFTER = 60
"""Frames after which bone that none has come near to is probably not where the CT has it."""

RENEW_EVERY = 5.0
"""s between two looks at the surface of echoes, where there is no CT, at least: who follows a move has some seconds for it."""

NOTHING_YET = "No bone is known yet. Scan the bone."


class GuidanceWatch(Watch):
    """Looks at the frames of a session, at every one if there is time for it.

    Parameters
    ----------
    labels : Volume of integers, or GrowingBone
        Where the frames alone tell of bone, what they have told.
    labels_to_reference : (4, 4) array or None, mm
        Rigid.
    unseen : (n, 3) array, mm in Reference, or None
        Places that the next move leads to in place of bone, as `FreePaths.unseen` has them.

    Attributes
    ----------
    prepared : threading.Event
        Set when the surface of bone is known, or a problem.
    state : Guidance
        What is known now; `colored` is the same object until the labels change, or more bone is known.

    Notes
    -----
    A frame takes some 2 ms; those that come meanwhile are not looked at. Candidate passes are looked at for every place of the CT, in
    steps between two frames: advice is there when all were looked at once, and becomes better when they were looked at again.
    Bone that grows is told anew every some seconds, from all poses so far, and what was told before stays until that is done.
    """

    def __init__(
        self, session: LiveSession, labels: Volume | GrowingBone, labels_to_reference: Matrix | None = None, unseen: Floats | None = None
    ):
        super().__init__(session)
        self.prepared = threading.Event()
        self.state = Guidance()
        self._labels_to_reference = np.eye(4) if labels_to_reference is None else np.asarray(labels_to_reference, dtype=np.float64)
        self._growing = labels if isinstance(labels, GrowingBone) else None
        self._labels: Volume | None = None
        self._bone_of_ct: GuidedBone | None = None
        self._colored: ColoredBone | None = None
        self._bone: GuidedBone | None = None
        self._unseen = unseen
        self._mets: list[CoverageAccumulator] = []
        self._advisor: Advisor | None = None
        self._poses: list[Matrix] = []
        self._in_place: list[Matrix] = []
        self._again: list[Matrix] = []
        self._since: list[Matrix] = []
        self._ahead: Iterator[object] | None = None
        self._told = self._advised = self._renewed = 0.0
        if isinstance(labels, GrowingBone):
            self._tell_problem(NOTHING_YET)
        else:
            self._ask("labels", partial(self._take_labels, labels))
        self._start()

    def place(self, labels_to_reference: Matrix, labels: Volume | None = None) -> None:
        """The CT lies elsewhere now, or has other labels; what was met is told anew from the poses so far."""
        if labels is not None:
            self._ask("labels", partial(self._take_labels, labels))
        self._ask("place", partial(self._move, np.asarray(labels_to_reference, dtype=np.float64)))

    def _tell_problem(self, problem: str) -> None:
        self.state = Guidance(problem=problem)
        self.prepared.set()

    def _breathe(self) -> bool:
        # What is done ahead ends as a frame comes: once inserted, that one is looked at next
        has_come = self._ahead is not None and self._session.latest is not self._newest and self._session.wait_for_rest(0.0)
        return self._resume() if has_come else super()._breathe()

    def _take_labels(self, labels: Volume) -> None:
        self._labels, self._bone_of_ct, self._growing = labels, None, None
        self._begin()
        self._show(guided_bone(labels))
        self._begin()

    def _move(self, labels_to_reference: Matrix) -> None:
        self._labels_to_reference = labels_to_reference
        if self._growing is None:
            self._begin()

    def _begin(self) -> None:
        """Nothing is met yet of the bone where it lies now."""
        self._mets, self._advisor, self._ahead = [], None, None
        self._advised = 0.0
        self._bone = None if self._bone_of_ct is None else self._bone_of_ct.placed_by(self._labels_to_reference)
        if self._bone is not None:
            self.prepared.set()

    def _show(self, bone: GuidedBone) -> None:
        self._bone_of_ct, self._colored = bone, ColoredBone.of(bone)
        self.state = Guidance.before(self._colored, bone)

    def _look(self, frame: LiveFrame | None) -> Iterable[object]:
        imaging = None if frame is None else self._session.imaging()
        if self._session.in_place is not self._in_place:
            self._follow_motion(self._session.in_place)
        if frame is not None and imaging is not None:
            image, pose = frame.placed()
            if self._bone is not None:
                self._add(self._bone, imaging, image, pose)
            elif self._growing is not None:
                self._remember(pose)
            if self._growing is not None and self._ahead is None and time.monotonic() - self._renewed >= RENEW_EVERY:
                self._ahead = self._follow_anew(self._growing, imaging, (image.shape[1], image.shape[0]))
        if self._mets:
            for pose, met in itertools.product(self._again[:AT_ONCE], self._mets):
                met.insert(pose)
            self._again = self._again[AT_ONCE:]
            yield from self._tell(self._mets[0], self._mets[-1])
            if self._advisor is None and self._ahead is None and len(self._poses) >= SKIN_AFTER:
                self._ahead = self._look_at_passes(self._mets[-1])
        while self._ahead is not None and not self._asked and self._session.latest is self._newest:
            # It is lost where it fails
            ahead, self._ahead = self._ahead, None
            if next(ahead, self) is not self:
                self._ahead = ahead
            yield None

    def _follow_motion(self, poses: list[Matrix]) -> None:
        """The patient moved: the frames so far lie elsewhere."""
        self._in_place, self._renewed = poses, 0.0
        if poses:
            self._poses = poses[-MOST_POSES:]
            if self._growing is None:
                self._begin()

    def _add(self, bone: GuidedBone, imaging: Imaging, image: Numbers, pose: Matrix) -> None:
        """Add a frame; the first says how large images are, and which way the probe looks."""
        rows, columns = image.shape
        if not self._mets:
            self._turn(bone, pose)
            self._mets = self._none_met(self._bone or bone, imaging, (columns, rows))
            self._again = list(self._poses)
        if self._mets[0].geometry.beams.frame_size != (columns, rows):
            return
        levels = imaging.gray_levels.of(image)
        for met in self._mets:
            met.insert(pose, levels)
        self._remember(pose)

    def _none_met(self, bone: GuidedBone, imaging: Imaging, frame_size: tuple[int, int]) -> list[CoverageAccumulator]:
        """What frames are added to: bone first, and last what moves are to lead to, which may be places that were not seen."""
        looked_at = [bone] if self._unseen is None else [bone, window(bone, self._unseen)]
        return [CoverageAccumulator(FrameGeometry(one, frame_size, imaging.known_probe(), imaging.region)) for one in looked_at]

    def _remember(self, pose: Matrix) -> None:
        self._poses = [*self._poses, pose][-MOST_POSES:]
        if self._growing is not None:
            self._since.append(pose)

    def _turn(self, bone: GuidedBone, pose: Matrix) -> None:
        """Where the labels' axes are not the patient's, the first frame says where the front is."""
        looks = pose[:3, 1] / np.linalg.norm(pose[:3, 1])
        if self._labels is not None and is_awry(bone.patient_to_reference[:3, 1], looks):
            self._show(guided_bone(self._labels, None, self._labels_to_reference[:3, :3].T @ looks))
            self._begin()

    def _tell(self, met: CoverageAccumulator, aim: CoverageAccumulator) -> Iterator[object]:
        now, colored = time.monotonic(), self._colored
        if now - self._told < TELL_EVERY or colored is None or not self._poses:
            return
        self._told = now
        yield None
        problem = self._why_not(met)
        if problem is not None:
            self.state = Guidance.before(colored, met.bone, problem)
            return
        pose, advice = self._poses[-1], None
        if self._advisor is not None:
            move = None if self.state.advice is None else self.state.advice.move
            if now - self._advised >= ADVISE_EVERY:
                gains = yield from self._advisor.moves.gains(aim)
                move, self._advised = self._advisor.moves.advise(aim, pose, gains), now
            advice = self._advisor.to(move, pose)
        self.state = Guidance.of(colored, met, advice)

    def _why_not(self, met: CoverageAccumulator) -> str | None:
        grid = self._session.grid
        if grid is not None and not holds_bone(grid, met.bone):
            return NOT_IN_BOX
        far = len(self._poses) >= FAR_AFTER and not self._again and not has_come_near(met)
        return FAR if far else None

    def _look_at_passes(self, aim: CoverageAccumulator) -> Iterator[object]:
        advisor = Advisor(aim, np.array(self._poses))
        candidates = advisor.moves.candidates
        while candidates.is_rough:
            yield from candidates.look_again()
            self._advisor = advisor

    def _follow_anew(self, growing: GrowingBone, imaging: Imaging, frame_size: tuple[int, int]) -> Steps[None]:
        """What echoes have shown of bone until now, and what all poses so far met of it."""
        poses, self._since = np.array(self._poses), []
        self._renewed = time.monotonic()
        known = (yield from growing.so_far()) if len(poses) >= SKIN_AFTER else None
        if known is None:
            return
        mets = self._none_met(bone_of_echoes(known, poses), imaging, frame_size)
        for number, pose in enumerate(poses):
            yield number / len(poses), "Following the beams"
            for met in mets:
                met.insert(pose)
        mets[0] = unrefuted(mets[0])
        advisor = Advisor(mets[-1], poses)
        yield from advisor.moves.candidates.look_again()
        self._colored, self._bone, self._mets, self._advisor = ColoredBone.of(mets[0].bone), mets[0].bone, mets, advisor
        self._again, self._renewed = list(self._since), time.monotonic()
