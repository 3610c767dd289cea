"""A live session in the scene: starts it from the panel's parameters and keeps the nodes it shows up to date."""

import contextlib
import logging
import threading
from dataclasses import replace

from AIFReconLib.errors import GeometryError, OperationCanceled, SettingsError
from AIFReconLib.live.pairing.synchronizer import SynchronizerSettings
from AIFReconLib.live.session.agreement_watch import AgreementWatch, LiveState
from AIFReconLib.live.session.session import SCOUTING, LiveSession
from AIFReconLib.live.session.snapshots import SnapshotMaker
from AIFReconLib.machine.threads import usable_cores
from AIFReconLib.progress import part, report
from AIFReconLib.provenance.record import with_settings
from AIFReconLib.registration.echoes import FEWEST, SweepEchoes

from .. import garbage
from ..background import ALIVE_EVERY, inBackground
from ..inputs.boneSource import BoneSource
from ..inputs.inputs import Inputs
from ..inputs.parameters import LiveSource, fileFrom, settingsFrom
from ..transforms import matrixToWorld
from ..volumes.volumeNodes import followIntensity, outputNodes, updateVolumeNode, windowOf
from .inSteps import InSteps
from .liveBone import LiveBone
from .liveGuidance import LiveGuidance
from .liveViews import LiveViews
from .nodeSource import NodeSource
from .shownFrame import ShownFrame

SCOUT_MARGIN = 5.0
"""mm added on each side of the box that was scouted."""


class LiveReconstruction:
    """One scan: a `LiveSession`, the volume that it fills and the frame that is seen now.

    Parameters
    ----------
    parameters : AIFReconParameterNode
    progress : callable or None
        For the bone map or the network, which is made before the first frame is received.
    record : Path or None
        Where every frame is recorded.

    Raises
    ------
    AIFReconError
        With what is missing or wrong; nothing is left running, and the scene is as before.

    Notes
    -----
    Reference, the frame that the stream's poses lead to, is RAS world. A scan goes to the selected output only while that is empty, else
    to a new volume: what was reconstructed before is not lost by pressing Start. Everything here is called on the main thread and returns
    at once; receiving, inserting and making snapshots happen on threads of their own.
    """

    def __init__(self, parameters, progress=None, record=None):
        self._name = "Live"
        self._displayProblems = {}
        self._window = None
        self.wasCanceled = False
        self._views = LiveViews(parameters.ctVolume, parameters.opacity)
        self._frame = ShownFrame(self._views)
        self._inSteps, self._waiting = InSteps(), {}
        empty = parameters.output is not None and parameters.output.GetImageData() is None
        self._outputs = {"intensity": parameters.output} if empty else {}
        inputs = Inputs.fromParameters(parameters)
        settings = settingsFrom(parameters)
        labels, configuration = inputs.labels(part(progress, 0.0, 0.1)), _configurationFrom(parameters)
        grid, self._source = inputs.grid(settings), _sourceFrom(parameters)
        share = part(progress, 0.1, 0.5)
        self.seen = None if parameters.boneSource == BoneSource.CT else LiveBone(parameters, record, share)
        bone = inputs.boneMap(share, labels, settings.method_for(True)) if self.seen is None else self.seen.bone
        self._bone, self._inputs, self._method = parameters.bone, inputs, settings.method_for(True)
        field = _fieldOf(labels, part(progress, 0.5, 0.6))
        self.session = LiveSession(
            self._source,
            settings,
            bone,
            grid,
            configuration=configuration,
            synchronizer=SynchronizerSettings(image_device=parameters.liveImageDevice.strip() or None),
            record=record,
            predictions_device=None if self.seen is None else self.seen.device,
        )
        self._snapshots = SnapshotMaker(self.session)
        self._boneAt = None if field is None else matrixToWorld(parameters.bone)
        self._watch = None if field is None else AgreementWatch(self.session, field, self._boneAt)
        self._parameters = parameters
        self.guidance = None
        if self.seen is not None:
            self.seen.begin(self.session)
        try:
            self.guide(parameters.guidance, part(progress, 0.6, 0.7))
            # Beside the windows of a scan it takes many times as long
            while progress is not None and not self.session.prepare(ALIVE_EVERY):
                report(progress, 0.7, "Preparing the scan")
        except OperationCanceled:
            self._endThreads()
            # It waits for what is being compiled
            threading.Thread(target=self.session.stop, name="AIFRecon canceled scan", daemon=True).start()
            raise
        self.session.start()
        self._whileScanning = contextlib.ExitStack()
        self._whileScanning.enter_context(garbage.leftAlone())

    @property
    def statistics(self):
        """What the session tells of itself."""
        return self.session.statistics

    @property
    def snapshotProblem(self):
        """The error that keeps the volume that is shown from growing; None while it grows."""
        return self._snapshots.error

    @property
    def agreement(self) -> LiveState:
        """How well the CT agrees with the last seconds of the scan."""
        return self._watch.state if self._watch is not None else LiveState()

    def guide(self, wanted: bool, progress=None) -> None:
        """Tell from now on what is met, and where to look next, or do so no longer."""
        if wanted and self.guidance is None:
            self.guidance = LiveGuidance(self.session, self._parameters)
            self.guidance.begin(progress)
        elif not wanted and self.guidance is not None:
            ended, self.guidance = self.guidance, None
            ended.stop(wait=False)

    def echoes(self):
        """The `SweepEchoes` of the scan so far, to place the CT by.

        Raises
        ------
        GeometryError
            When it has shown too little bone.
        """
        echoes = self._watch.echoes() if self._watch is not None else SweepEchoes.joined(())
        if len(echoes) < FEWEST:
            raise GeometryError(
                f"The scan has shown {len(echoes)} bone echoes so far; {FEWEST} are needed to place the CT. Scan the bone some seconds "
                "longer, then press “Place CT on sweep” again."
            )
        return echoes

    def followBone(self, progress=None) -> bool:
        """Weight by the bone where it lies now; True where a volume is growing already, which keeps the weights that it began with.

        Where the frames themselves say where bone is, the place of the CT changes nothing.
        """
        if self.seen is not None:
            return False
        self.session.use_bone(self._inputs.boneMap(progress, method=self._method))
        return not self.isScouting

    @property
    def isScouting(self) -> bool:
        """Whether the box is still to be found."""
        return self.session.grid is None or self.statistics.phase == SCOUTING

    def useScoutedBox(self) -> None:
        """Reconstruct in the box around what was seen so far."""
        self.session.use_grid(self.session.grid_from_scout(margin=SCOUT_MARGIN))

    def collect(self) -> None:
        """Take a new image from the scene, where that is the source; to be called often."""
        if isinstance(self._source, NodeSource):
            self._source.collect()

    def goOn(self) -> bool:
        """Take the next step of what is being shown; False where none is left. To be called often."""
        if not self._inSteps.isUnderWay:
            return False
        self._attempt(self._inSteps.goOn)
        return True

    def showToo(self, name: str, steps) -> None:
        """Show something else with volume and frame, in steps as `InSteps` takes them; what waits under the same name is dropped."""
        self._waiting[name] = steps

    @property
    def showsVolume(self) -> bool:
        """Whether the growing volume is in all views that it is to be in."""
        return self.volumeNode is not None and self._views.shows(self.volumeNode)

    def refresh(self) -> None:
        """Have what has changed of volume, frame and what else waits shown as `goOn` is called; `displayProblem` says what failed."""
        self._attempt(self._followPlace)
        if self.guidance is not None:
            self._attempt(self.guidance.follow)
        if self._inSteps.isUnderWay:
            return
        changed, self._waiting = {"volume": self._volumeSteps(), "frame": self._frameSteps(), **self._waiting}, {}
        changed = {name: steps for name, steps in changed.items() if steps is not None}
        if changed:
            self._inSteps.begin(self._stepsOf(changed))
        self._snapshots.request()

    def stop(self, progress=None):
        """End the scan and show the final volume; returns its node, or None when nothing was reconstructed.

        A cancel, which may come while holes are filled, leaves the volume as it was shown last; `wasCanceled` is True then.
        """

        def work(progress):
            # It waits for the snapshot that is being made, whose holes may take seconds
            self._endThreads()
            return self.session.finish(progress)

        self._inSteps.interrupt()
        try:
            result = inBackground(work, progress)
            if result is not None and result.frames_inserted:
                for _step in self._filling(result):
                    pass
                self._attempt(self._showVolume)
        except OperationCanceled:
            self.wasCanceled = True
        finally:
            self._attempt(self.removeFrame)
            self._whileScanning.close()
        return self.volumeNode

    def abandon(self) -> None:
        """End the scan without a word to the scene, which is being closed."""
        self._inSteps.interrupt()
        self._endThreads()
        self.session.stop()
        self._whileScanning.close()

    @property
    def volumeNode(self):
        """The volume that grows; None before there is one, and when somebody has deleted it."""
        node = self._outputs.get("intensity")
        return node if node is not None and node.GetScene() is not None else None

    @property
    def frameNode(self):
        """The frame that is seen now, in its place, or None."""
        return self._frame.node

    def removeFrame(self) -> None:
        """Take the frame out of the scene, and give the red view back as it was."""
        self._inSteps.interrupt()
        self._frame.remove()

    @property
    def displayProblem(self):
        """The error that keeps something from being shown as it is now; None while all is. The scan goes on beside it."""
        return next(iter(self._displayProblems.values()), None)

    def _attempt(self, show, *what) -> None:
        """Show something. What goes wrong is kept until it has gone right again, for nothing on the screen is worth the scan."""
        with self._attempted(show.__name__):
            show(*what)

    @contextlib.contextmanager
    def _attempted(self, name: str):
        try:
            yield
        except Exception as error:
            if name not in self._displayProblems:
                logging.exception("The scan goes on, but its display has failed.")
            self._displayProblems[name] = error
        else:
            self._displayProblems.pop(name, None)

    def _stepsOf(self, changed: dict):
        """One after the other, to be drawn together: a view takes as long to draw whatever has changed in it."""
        for name, steps in changed.items():
            with self._attempted(name):
                yield from steps

    def _endThreads(self) -> None:
        self._snapshots.stop()
        for beside in (self._watch, self.guidance, self.seen):
            if beside is not None:
                beside.stop()

    def _followPlace(self) -> None:
        """Let the agreement be judged where the bone lies now, whoever has moved it."""
        if self._watch is None or self._bone.GetScene() is None:
            return
        place = matrixToWorld(self._bone)
        if (place != self._boneAt).any():
            self._boneAt = place
            self._watch.place(place)

    def _volumeSteps(self):
        if self.volumeNode is not None and not self.showsVolume:
            return self._views.stepsTo(self.volumeNode)
        result = self._snapshots.take()
        return None if result is None else self._filling(result)

    def _showVolume(self) -> None:
        for _step in self._views.stepsTo(self.volumeNode):
            pass

    def _frameSteps(self):
        return self._frame.stepsTo(self.session.latest)

    def _filling(self, result):
        """Steps that put a volume into its node, which is made where there is none, and fit what is shown of its gray levels."""
        result = with_settings(result, self._inputs.boneSettings(self._method))
        known = self.volumeNode
        if known is not None and known.GetImageData() is not None:
            updateVolumeNode(known, result.intensity)
            yield
            self._window = followIntensity(known, result, self._window)
        else:
            self._outputs = outputNodes(result, self._name, nodes={"intensity": known})
            self._window = windowOf(self.volumeNode)
        yield


def _fieldOf(labels, progress):
    if labels is None:
        return None
    from AIFReconLib.registration.bone_field import BoneField

    return inBackground(lambda _progress: BoneField.from_labels(labels), progress)


def _sourceFrom(parameters):
    if parameters.liveSource == LiveSource.SCENE:
        if parameters.liveImage is None:
            raise SettingsError("The image that is kept up to date must be chosen; got none. Select it as Live image.")
        return NodeSource(parameters.liveImage)
    from AIFReconLib.live.wire.client import OpenIGTLinkClient

    return OpenIGTLinkClient(parameters.liveHost.strip(), parameters.livePort)


def _configurationFrom(parameters):
    """The Plus configuration. Unless it says itself how many threads insert, one core stays with the windows: they would wait to draw."""
    from AIFReconLib import read_plus_configuration
    from AIFReconLib.sweep.configuration import NO_CONFIGURATION

    path = fileFrom(parameters.configurationPath)
    configuration = NO_CONFIGURATION if path is None else read_plus_configuration(path)
    return replace(configuration, threads=configuration.threads or max(usable_cores() - 1, 1))
