"""A live scan in the scene: it goes on in the worker, and what it shows is asked for and put into nodes."""

import collections
import logging
import sys
import time
from dataclasses import replace
from types import SimpleNamespace

from AIFReconLib.errors import AIFReconError, OperationCanceled, SettingsError, WorkerDiedError
from AIFReconLib.guidance.snapshot import GuidanceSnapshot
from AIFReconLib.io.plus.configuration import read_plus_configuration
from AIFReconLib.live.pairing.synchronizer import SynchronizerSettings
from AIFReconLib.message import message_of
from AIFReconLib.progress import part
from AIFReconLib.sweep.configuration import NO_CONFIGURATION
from AIFReconLib.worker.reconstructing import begin_scan
from AIFReconLib.workflows.job import BoneSource as GivenBone
from AIFReconLib.workflows.job import ScanJob

from ..inputs.boneNodes import isLabeled, probabilityFromNode
from ..inputs.boneSource import BoneSource
from ..inputs.inputs import Inputs
from ..inputs.parameters import LiveSource, fileFrom, settingsFrom
from ..transforms import matrixToWorld
from ..volumes.volumeNodes import followIntensity, outputNodes, updateVolumeNode, windowOf
from ..work import inWorker, worker
from .followedBone import FollowedBone
from .liveViews import LiveViews
from .nodeImages import NodeImages

ASK_EVERY = 0.1
"""s between two looks at the scan; longer where what came of the last takes longer to be shown."""

MOST_DEATHS, WITHIN = 3, 60.0
"""Workers that may die within so many s before a scan is given up."""

MOST_UNSENT = 256
"""Images that wait for a worker."""


class LiveReconstruction:
    """One scan: the volume that it fills and the frame that is seen now.

    `progress` hears of what is made before the first frame is received, every frame is recorded to the path `record`, and guidance leads to
    bone, or to `unseen` places, (n, 3) in RAS. An AIFReconError says what is missing or wrong; nothing is left running then, and the scene
    is as before. `seen` is the last look at it, a `Seen`; `guidance` has a `GuidanceSnapshot` as `state`, and the node `bone`
    that it is about; `lost` says why the process that scans has died, while another takes up where it was, and is empty else.

    Reference, the frame that the stream's poses lead to, is RAS world. A scan goes to the selected output only while that is empty, else
    to a new volume: what was reconstructed before is not lost by pressing Start. But for `stop` and `followBone`, everything here returns
    at once.
    """

    def __init__(self, parameters, progress=None, record=None, unseen=None):
        self._parameters, self._name, self._window = parameters, "Live", None
        self.wasCanceled, self.guidance, self.lost, self._displayProblems = False, None, "", {}
        self._views = LiveViews(parameters.ctVolume, parameters.opacity)
        empty = parameters.output is not None and parameters.output.GetImageData() is None
        self._outputs = {"intensity": parameters.output} if empty else {}
        self._bone = FollowedBone(parameters, part(progress, 0.0, 0.1))
        self._request = replace(_requestOf(parameters, self._bone, record), unseen=unseen)
        self._unsent, self._deaths = collections.deque(maxlen=MOST_UNSENT), []
        self._asked = self._again = self._followed = None
        self._toShow = collections.deque()
        self._nextLook, self._number, self._surface = 0.0, -1, None
        self._scan = worker.keep(begin_scan, self._request, progress=part(progress, 0.1, 1.0))
        self.seen = worker.call("look", self._scan)
        fromScene = parameters.liveSource == LiveSource.SCENE
        self._images = NodeImages(parameters.liveImage) if fromScene else None
        self.guide(parameters.guidance)

    @property
    def statistics(self):
        """What the scan counts."""
        return self.seen.statistics

    # ---- what the user asks for

    def guide(self, wanted: bool) -> None:
        """Tell from now on what is met, and where to look next, or do so no longer."""
        if wanted != (self.guidance is not None):
            self.guidance = SimpleNamespace(state=GuidanceSnapshot(), bone=self._bone.node) if wanted else None
            self._surface = None
        if wanted != self._request.guidance:
            self._tell("guide", wanted, guidance=wanted)

    def pause(self, paused: bool) -> None:
        """Insert nothing for a while, or go on."""
        self._tell("pause", paused)

    def reset(self) -> None:
        """Empty the volume and go on; a scan that was given up is begun again."""
        self._tell("reset", **self._followed or {})
        if self.lost and self._again is None:
            self._deaths = []
            self.seen = replace(self.seen, spans=((self.statistics.recorded, None),))
            self._beginAgain(self.lost)

    def useScoutedBox(self) -> None:
        """Reconstruct in the box around what was seen so far; an AIFReconError where that cannot be told yet."""
        inWorker("use_scouted_box", self._scan)

    def echoes(self):
        """The `SweepEchoes` of the scan so far, to place the CT by; a GeometryError when it has shown too little bone."""
        return inWorker("echoes", self._scan)

    def followBone(self, progress=None) -> bool:
        """Weight by the bone where it lies now; True where a volume is growing already, which keeps the weights that it began with."""
        place = matrixToWorld(self._parameters.bone)
        keepsWeights = inWorker("follow_bone", self._scan, place, progress=progress)
        self._followed = {"bone": replace(self._request.bone, to_reference=place, labels=self._bone.labels)}
        if not keepsWeights:
            self._request = replace(self._request, **self._followed)
        return keepsWeights

    # ---- while it goes on

    def goOn(self) -> bool:
        """Hear of the scan and show what is new, one thing at a time, for windows wait for each; whether there was. To be called often."""
        self._handOnImages()
        if self._toShow:
            return self._attempt(self._toShow.popleft())
        if self._again is not None:
            return self._again.is_done and self._attempt(self._takeUp)
        if self._asked is None:
            if time.monotonic() >= self._nextLook:
                self._attempt(self._followNodes)
                self._asked = worker.begin("look", self._scan, self._number, self._surface)
            return False
        if not self._asked.is_done:
            return False
        asked, self._asked, self._nextLook = self._asked, None, time.monotonic() + ASK_EVERY
        try:
            self.seen = seen = asked.result()
        except WorkerDiedError as error:
            self._beginAgain(error)
            return True
        if self.guidance is not None and seen.guidance is not None:
            self.guidance.state, self._surface = seen.guidance.after(self.guidance.state), seen.guidance.surface
        hasNoCT = self._request.sees_bone and self._request.bone.labels is None
        if self.guidance is not None and self._bone.problem is not None and not hasNoCT:
            self.guidance.state = GuidanceSnapshot(problem=self._bone.problem)
        if seen.frame is not None:
            self._toShow.append(self._showFrame)
        if seen.result is not None:
            self._toShow.append(self._showVolume)
        return True

    def _showFrame(self) -> None:
        self._number = self.seen.frame.number
        self._views.showFrame(self.seen.frame)

    def _showVolume(self) -> None:
        self._fill(self.seen.result)

    def _followNodes(self) -> None:
        """Tell the scan of bone that was moved, drawn anew, chosen or deleted."""
        news = self._bone.news()
        if self.guidance is not None:
            self.guidance.bone = self._bone.node
        if news is not None:
            # Not of the request: a volume that is taken up keeps the weights that it began with
            self._tell("place", *news)
            if self._request.guidance:
                self._tell("guide", True)

    def _handOnImages(self) -> None:
        message = None if self._images is None else self._images.take()
        if message is not None:
            self._unsent.append(message)
        while self._unsent and self._again is None:
            worker.begin("put", self._scan, self._unsent.popleft(), self._images.replaced)

    def _tell(self, what: str, *arguments, **changed) -> None:
        """Have the scan do something, nobody waits for it; what it changes of the request holds for a scan that is begun again, too."""
        self._request = replace(self._request, **changed)
        if self._again is None:
            worker.begin(what, self._scan, *arguments)

    # ---- a worker that has died

    def _beginAgain(self, error) -> None:
        now = time.monotonic()
        self._deaths = [*(each for each in self._deaths if now - each < WITHIN), now]
        self.lost, seen = error if isinstance(error, str) else message_of(error), self.seen
        if len(self._deaths) <= MOST_DEATHS:
            logging.warning("%s The scan is taken up again.", self.lost)
            grid = seen.grid or self._request.grid
            self._request = replace(self._request, grid=grid, spans=seen.spans, takes_up=True, record=seen.record or self._request.record)
            self._again = worker.begin(begin_scan, self._request, keep=True)
        else:
            self._giveUp()

    def _takeUp(self) -> None:
        again, self._again = self._again, None
        try:
            self._scan, self.lost, self._number, self._surface = again.result(), "", -1, None
            if self._bone.labels is not None:
                others = None if self._bone.labels is self._request.bone.labels else self._bone.labels
                self._tell("place", self._bone.place, others)
        except WorkerDiedError as error:
            self._beginAgain(error)
        except AIFReconError as error:
            self.lost = message_of(error)
            self._giveUp()

    def _giveUp(self) -> None:
        statistics = replace(self.seen.statistics, phase="failed", trouble=self.lost)
        self.seen, self._nextLook = replace(self.seen, statistics=statistics, frame=None, result=None), float("inf")

    # ---- the end

    def stop(self, progress=None):
        """End the scan and show the final volume; returns what is left of it, as last `Seen`, or None when it was lost or canceled.

        A cancel, which may come while holes are filled, leaves the volume as it was shown last; `wasCanceled` is True then.
        """
        self._handOnImages()
        try:
            ended = self._finished(progress)
            self.seen = replace(self.seen, statistics=ended.statistics)
            if ended.result is not None:
                self._attempt(lambda: self._fill(ended.result))
            return ended
        except WorkerDiedError as error:
            self.lost = message_of(error)
        except OperationCanceled:
            self.wasCanceled = True
        finally:
            self.abandon()
            self._attempt(self.removeFrame)
        return None

    def _finished(self, progress):
        """What is left of it, as last `Seen`; where the worker has died, another takes up the recording first."""
        for _attempt in range(MOST_DEATHS):
            try:
                if self._again is not None:
                    again, self._again = self._again, None
                    self._scan = again.result(progress)
                ended = inWorker("finish", self._scan, progress=progress)
                self.lost = ""
                return ended
            except WorkerDiedError as error:
                self._beginAgain(error)
        raise WorkerDiedError(self.lost)

    def abandon(self) -> None:
        """End the scan without a word to the scene, which is being closed; its recording is finished."""
        if self._images is not None:
            self._images.stop()
        if self._again is not None:
            self._again.cancel()
        worker.forget(self._scan)

    @property
    def volumeNode(self):
        """The volume that grows; None before there is one, and when somebody has deleted it."""
        node = self._outputs.get("intensity")
        return node if node is not None and node.GetScene() is not None else None

    def removeFrame(self) -> None:
        """Take the frame out of the scene, and give the red view back as it was."""
        self._views.removeFrame()

    def _attempt(self, show) -> bool:
        """Do something with the scene; what goes wrong is kept until it goes right again, for nothing on the screen is worth the scan."""
        try:
            show()
        except Exception as error:
            if show.__name__ not in self._displayProblems:
                logging.exception("The scan goes on, but its display has failed.")
            self._displayProblems[show.__name__] = error
        else:
            self._displayProblems.pop(show.__name__, None)
        return True

    @property
    def displayProblem(self):
        """The error that keeps something from being shown as it is now; None while all is. The scan goes on beside it."""
        return next(iter(self._displayProblems.values()), None)

    def _fill(self, result) -> None:
        """Put a volume into its node, which is made where there is none, and fit what is shown of its gray levels."""
        known = self.volumeNode
        if known is not None and known.GetImageData() is not None:
            updateVolumeNode(known, result.intensity)
            self._window = followIntensity(known, result, self._window)
        else:
            self._outputs = outputNodes(result, self._name, nodes={"intensity": known})
            self._window = windowOf(self.volumeNode)
        self._views.show(self.volumeNode)


def _requestOf(parameters, bone: FollowedBone, record) -> ScanJob:
    if parameters.liveSource == LiveSource.SCENE and parameters.liveImage is None:
        raise SettingsError("The image that is kept up to date must be chosen; got none. Select it as Live image.")
    inputs, recipe = Inputs.fromParameters(parameters), settingsFrom(parameters)
    node, path = parameters.bone, fileFrom(parameters.configurationPath)
    source = parameters.boneSource
    isProbability = node is not None and not isLabeled(node)
    if bone.labels is None and node is not None and not isProbability and source == BoneSource.CT:
        inputs.labels()  # says what is wrong with it
    given = GivenBone(
        bone.labels,
        probabilityFromNode(node) if isProbability and source == BoneSource.CT else None,
        None if node is None else matrixToWorld(node),
        model=inputs.boneModel,
        device=parameters.liveBoneDevice.strip() if source == BoneSource.PREDICTIONS else None,
    )
    return ScanJob(
        recipe,
        server=None if parameters.liveSource == LiveSource.SCENE else (parameters.liveHost.strip(), parameters.livePort),
        configuration=NO_CONFIGURATION if path is None else read_plus_configuration(path),
        grid=inputs.grid(recipe),
        bone=given,
        synchronizer=SynchronizerSettings(image_device=parameters.liveImageDevice.strip() or None),
        record=record,
        guidance=parameters.guidance and (bone.labels is not None or source != BoneSource.CT),
        search_path=tuple(sys.path),
    )
