"""A live session in the scene: starts it from the panel's parameters and keeps the nodes it shows up to date."""

import slicer

from AIFReconLib.errors import SettingsError
from AIFReconLib.live.session import SCOUTING, LiveSession
from AIFReconLib.live.snapshots import SnapshotMaker
from AIFReconLib.live.synchronizer import SynchronizerSettings
from AIFReconLib.volume import Volume

from .inputs import Inputs
from .liveViews import LiveViews
from .nodeSource import NodeSource
from .parameters import LiveSource, settingsFrom
from .volumeNodes import outputNodes, updateVolumeNode

SCOUT_MARGIN = 5.0
"""mm added on each side of the box that was scouted."""

FRAME_NAME = "Live frame"


class LiveReconstruction:
    """One scan: a `LiveSession`, the volume that it fills and the frame that is seen now.

    Parameters
    ----------
    parameters : AIFReconParameterNode
    progress : callable or None
        For the bone map, which is made before the first frame is received.

    Raises
    ------
    AIFReconError
        With what is missing or wrong; nothing is left running, and the scene is as before.

    Notes
    -----
    Reference, the frame that the stream's poses lead to, is RAS world. Everything here is called on the main thread and returns at
    once; receiving, inserting and making snapshots happen on threads of their own.
    """

    def __init__(self, parameters, progress=None):
        self._name = "Live"
        self._frameNode = None
        self._shownFrame = None
        self._views = LiveViews(parameters.ctVolume, parameters.opacity)
        self._outputs = {"intensity": parameters.output} if parameters.output is not None else {}
        inputs = Inputs.fromParameters(parameters)
        settings = settingsFrom(parameters)
        grid, bone = inputs.grid(settings), inputs.boneMap(progress)
        self._source = _sourceFrom(parameters)
        self.session = LiveSession(
            self._source,
            settings,
            bone,
            grid,
            probe=inputs.probe,
            configuration=_configurationFrom(parameters),
            synchronizer=SynchronizerSettings(image_device=parameters.liveImageDevice.strip() or None),
            record=_fileFrom(parameters.liveRecordPath),
        )
        self._snapshots = SnapshotMaker(self.session)
        self.session.start()

    @property
    def statistics(self):
        """What the session tells of itself."""
        return self.session.statistics

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

    def refresh(self) -> None:
        """Bring the nodes up to date with what is ready, and ask for the next snapshot."""
        self._showFrame()
        result = self._snapshots.take()
        if result is not None:
            self._showVolume(result)
        self._snapshots.request()

    def stop(self, progress=None):
        """End the scan and show the final volume; returns its node, or None when nothing was reconstructed."""
        self._snapshots.stop()
        result = self.session.finish(progress)
        if result is not None and result.frames_inserted:
            self._showVolume(result)
        self._removeFrame()
        return self.volumeNode

    def abandon(self) -> None:
        """End the scan without a word to the scene, which is being closed."""
        self._snapshots.stop()
        self.session.stop()

    @property
    def volumeNode(self):
        """The volume that grows, or None before there is one."""
        return self._outputs.get("intensity")

    @property
    def frameNode(self):
        """The frame that is seen now, in its place, or None."""
        return self._frameNode

    def _showVolume(self, result) -> None:
        known = self._outputs.get("intensity")
        if known is not None and known.GetScene() is not None and known.GetImageData() is not None:
            updateVolumeNode(known, result.intensity)
        else:
            self._outputs = outputNodes(result, self._name, nodes=self._outputs)
        self._views.showVolume(self.volumeNode)

    def _showFrame(self) -> None:
        frame = self.session.latest
        if frame is None or frame is self._shownFrame or frame.image_to_reference is None or frame.status != "OK":
            return
        self._shownFrame = frame
        if self._frameNode is None:
            self._frameNode = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", FRAME_NAME)
            self._frameNode.SetSaveWithScene(False)
            self._frameNode.CreateDefaultDisplayNodes()
        updateVolumeNode(self._frameNode, Volume(frame.image[None], frame.image_to_reference))
        self._views.showFrame(self._frameNode)

    def _removeFrame(self) -> None:
        self._views.restore()
        if self._frameNode is not None and self._frameNode.GetScene() is not None:
            slicer.mrmlScene.RemoveNode(self._frameNode)
        self._frameNode = None


def _sourceFrom(parameters):
    if parameters.liveSource == LiveSource.SCENE:
        if parameters.liveImage is None:
            raise SettingsError("The image that is kept up to date must be chosen; got none. Select it as Live image.")
        return NodeSource(parameters.liveImage)
    from AIFReconLib.live.openigtlink import OpenIGTLinkClient

    return OpenIGTLinkClient(parameters.liveHost.strip(), parameters.livePort)


def _configurationFrom(parameters):
    path = _fileFrom(parameters.configurationPath)
    if path is None:
        return None
    from AIFReconLib import read_plus_configuration

    return read_plus_configuration(path)


def _fileFrom(path):
    return None if str(path) in ("", ".") else path
