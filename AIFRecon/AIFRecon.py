"""AIFRecon in 3D Slicer: from a tracked sweep and a registered CT to a volume over that CT.

The numbers come from AIFReconLib, which knows nothing of Slicer; AIFReconScene turns nodes into its inputs and its results into nodes;
this file holds what Slicer looks for by name: the module, its parameters, its panel and its logic.
"""

import pathlib
import sys

import slicer
import vtk
from slicer.i18n import tr as _
from slicer.i18n import translate
from slicer.ScriptedLoadableModule import (
    ScriptedLoadableModule,
    ScriptedLoadableModuleLogic,
    ScriptedLoadableModuleTest,
    ScriptedLoadableModuleWidget,
)
from slicer.util import VTKObservationMixin

try:
    import AIFReconLib  # noqa: F401
except ImportError:
    # Loaded from source: Slicer knows this folder alone, and the library stands beside it
    sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent))

from AIFReconScene.inputs import readiness
from AIFReconScene.inputs.inputs import Inputs, settingsAndInputs
from AIFReconScene.inputs.parameters import readingFrom, takeConfigured
from AIFReconScene.panelWords import asControl, inPanelWords
from AIFReconScene.sweep.sweepStatus import SweepReport, SweepStatus, offered
from AIFReconScene.work import inWorker, warmUp, worker

from AIFReconLib.errors import OperationCanceled
from AIFReconLib.progress import part
from AIFReconLib.recipe.recipe import LONGEST_GAP, Recipe


class AIFRecon(ScriptedLoadableModule):
    """What Slicer's module list shows."""

    def __init__(self, parent):
        ScriptedLoadableModule.__init__(self, parent)
        parent.title = _("AIFRecon: Angle-weighted Ultrasound Reconstruction")
        parent.categories = [translate("qSlicerAbstractCoreModule", "Ultrasound")]
        parent.dependencies = ["Sequences", "Segmentations", "Markups", "VolumeRendering"]
        parent.contributors = ["The AIFRecon developers"]
        parent.helpText = _(
            "Reconstructs a volume of the spine from tracked ultrasound frames, weighting every beam by its angle of incidence to the "
            "bone that a registered CT shows. Research software, not a medical device."
        )
        parent.acknowledgementText = _(
            "The method is that of Jiang, Xu, Moghekar, Kazanzides and Boctor: Insonification Angle-based Ultrasound Volume "
            "Reconstruction for Spine Intervention."
        )

    def setup(self) -> None:
        """Offer the sample, and let scenes be loaded that were saved while methods were compared.

        Called once every module is made, at start or later. Before that no class of Sequences, Markups or another C++ module exists.
        """
        from AIFReconGui.sampleData import registerSampleData
        from AIFReconScene.display.sliceDisplay import registerLayouts

        registerSampleData()
        registerLayouts()


class AIFReconWidget(ScriptedLoadableModuleWidget, VTKObservationMixin):
    """The panel: binds the parameters to the .ui file, says what is missing, and hands the work to the logic."""

    def __init__(self, parent=None) -> None:
        ScriptedLoadableModuleWidget.__init__(self, parent)
        VTKObservationMixin.__init__(self)
        self._isSetUp = False
        self._parameterNode = self._parameterNodeTags = None

    # ---- life of the panel

    def setup(self) -> None:
        """Load the .ui file and connect it; called when the module is first opened."""
        ScriptedLoadableModuleWidget.setup(self)
        from AIFReconGui.fields.settingFields import dressSettings
        from AIFReconGui.longWork import LongWork
        from AIFReconGui.panel.calibrationPanel import CalibrationPanel
        from AIFReconGui.panel.guidancePanel import GuidancePanel
        from AIFReconGui.panel.layout import RoomForTexts, Tabs
        from AIFReconGui.panel.livePanel import LivePanel
        from AIFReconGui.panel.recordedPanel import RecordedPanel
        from AIFReconGui.panel.registrationPanel import RegistrationPanel
        from AIFReconScene.inputs.inputWatch import InputWatch
        from AIFReconScene.volumes.volumeNodes import goneWith

        uiWidget = slicer.util.loadUI(self.resourcePath("UI/AIFRecon.ui"))
        self.layout.addWidget(uiWidget)
        self.ui = slicer.util.childWidgetVariables(uiWidget)
        dressSettings(self.ui)
        uiWidget.setMRMLScene(slicer.mrmlScene)
        self.logic = AIFReconLogic()
        self._work = LongWork(uiWidget)
        self._recorded = RecordedPanel(self.ui, self._work, self._onParametersModified, self.logic)
        self._live = LivePanel(self.ui, self._work, self._onParametersModified, self.logic.paths)
        self.ui.liveRebuildButton.connect("clicked(bool)", lambda pressed: self._recorded.openAndReconstruct(self._live.recorded))
        onBone = (self.ui, self._work, self._onParametersModified, self._live, self.logic)
        self._registration, self._guidance = RegistrationPanel(*onBone), GuidancePanel(*onBone)
        self._calibration = CalibrationPanel(*onBone, self._registration, self._guidance)
        self._parts = (self._registration, self._guidance, self._calibration, self._recorded)
        self._tabs, self._room = Tabs(self.ui, self._onParametersModified), RoomForTexts(uiWidget, self.ui)
        self._watch = InputWatch(self._onParametersModified, lambda: self.logic.display.followFrame(self._parameterNode), goneWith)
        self._isSetUp = True

        warmUp()
        slicer.app.connect("aboutToQuit()", worker.close)
        self.addObserver(slicer.mrmlScene, slicer.mrmlScene.StartCloseEvent, self.onSceneStartClose)
        self.addObserver(slicer.mrmlScene, slicer.mrmlScene.EndCloseEvent, self.onSceneIsNew)
        self.addObserver(slicer.mrmlScene, slicer.mrmlScene.EndImportEvent, self.onSceneIsNew)
        self.initializeParameterNode()

    def cleanup(self) -> None:
        """Let go of everything; called when the application closes or the module is reloaded."""
        if not self._isSetUp:  # the .ui file could not be loaded, or all is let go of already
            return
        self._isSetUp = False
        self._work.close()
        self._live.close(sceneStays=True)
        for each in self._parts:
            each.close()
        self.setParameterNode(None)
        self.removeObservers()
        self.logic.cleanup()

    def enter(self) -> None:
        """The user opens the module."""
        self.initializeParameterNode()

    def exit(self) -> None:
        """The user opens another module."""
        self.setParameterNode(None)

    def onReload(self) -> None:
        """Reload the library as well as this file; what goes on is ended first, while its classes are those that it was made of."""
        self.cleanup()
        worker.close()
        for name in [name for name in sys.modules if name.split(".")[0] in ("AIFReconLib", "AIFReconScene", "AIFReconGui")]:
            del sys.modules[name]
        super().onReload()

    def onSceneStartClose(self, caller, event) -> None:
        """The parameters go with the scene, and a reconstruction under way has nothing left to write to."""
        self._work.cancel()
        for each in (self._live, *self._parts):
            each.close()
        self.setParameterNode(None)
        self.logic.cleanup()

    def onSceneIsNew(self, caller, event) -> None:
        """Begin anew with what the scene holds after it was closed, or after another was loaded into it."""
        if self.parent.isEntered:
            self.logic.display.showUnseen(self.logic.getParameterNode())
            self.initializeParameterNode()

    def initializeParameterNode(self) -> None:
        """Take the scene's parameters; where nothing is chosen, choose the only sweep, CT and segmentation there are."""
        self.setParameterNode(self.logic.getParameterNode())
        readiness.chooseDefaults(self._parameterNode)

    def setParameterNode(self, parameterNode) -> None:
        """Bind the panel to these parameters, or to none."""
        self._watch.stop()
        if self._parameterNode:
            gui, observer = self._parameterNodeTags
            self._parameterNode.disconnectGui(gui)
            self._parameterNode.RemoveObserver(observer)
        self._parameterNode = parameterNode
        for each in (*self._parts, self._live):
            each.setParameterNode(parameterNode)
        if self._parameterNode:
            gui = self._parameterNode.connectGui(self.ui)
            # Not by the mixin, which would keep all parameters that it was ever given, each of which follows every change of the node
            self._parameterNodeTags = gui, self._parameterNode.AddObserver(vtk.vtkCommand.ModifiedEvent, self._onParametersModified)
            self._onParametersModified()

    def _onParametersModified(self, caller=None, event=None) -> None:
        """Show what follows from the parameters: texts, what can be pressed, and the display."""
        parameters = self._parameterNode
        if parameters is None or self._work.isRunning:
            return
        self._watch.follow(parameters)
        for each in (self._registration, self._guidance, self._calibration):
            each.update()
        self._live.update(readiness.whyNotLive(parameters))
        self._recorded.update(self._live.whyNotNow())
        self.logic.display.update(parameters)


class AIFReconLogic(ScriptedLoadableModuleLogic):
    """What the module does, without its panel: nodes to the library's inputs, one call, results to nodes.

    From the Python console::

        logic = AIFReconLogic()
        sweep = logic.readRecording("sweep.igs.mha", "PlusDeviceSet.xml")
        bone = slicer.util.getNode("Segmentation")
        volume = logic.reconstruct(sweep, bone, spacing=0.5)
    """

    def __init__(self) -> None:
        from AIFReconScene.display.display import SceneDisplay
        from AIFReconScene.picture.freePaths import FreePaths
        from AIFReconScene.registration.sweepVerdicts import SweepVerdicts

        ScriptedLoadableModuleLogic.__init__(self)
        self.display, self.verdicts, self.paths = SceneDisplay(), SweepVerdicts(), FreePaths()
        self.sweep, self._tracking = SweepStatus(), SweepReport()

    def getParameterNode(self):
        """The parameters of the scene, typed."""
        from AIFReconGui.parameterNode import parametersOf

        return parametersOf(super().getParameterNode())

    def cleanup(self) -> None:
        """Take what is drawn for orientation out of the scene, and forget what is known of its sweeps."""
        self.sweep, self._tracking = SweepStatus(), SweepReport()
        self.verdicts.forget()
        self.display.clear()

    # ---- for the console

    def readRecording(self, recording, configuration=None, progress=None, *, orientation=None, timeOffset=0.0, longestGap=LONGEST_GAP):
        """Read a sequence recorded by Plus into a sequence browser that can be replayed.

        `configuration` is the Plus configuration with the calibration, if needed; `orientation` (MF, MN, UF or UN) stands in for a wrong
        or missing one, `timeOffset` (s) and `longestGap` (s) are those of `with_time_offset`. Returns the browser node. An AIFReconError
        says what is wrong, where, and what to do; the scene is then as before.
        """
        from AIFReconGui.longWork import progressOr
        from AIFReconScene.sweep.recordings import openRecording

        reading = {"orientation": orientation, "time_offset": timeOffset, "longest_gap": longestGap}
        with progressOr(progress, _("Load recording")) as progress:
            return openRecording(recording, configuration, progress, **reading)

    def reconstruct(self, sweep, bone=None, *, output=None, keep=(), progress=None, inputs=None, **choices):
        """Reconstruct a volume from the nodes of a sweep.

        Parameters
        ----------
        bone : vtkMRMLSegmentationNode, vtkMRMLLabelMapVolumeNode or vtkMRMLScalarVolumeNode (probability), or None
        output : vtkMRMLScalarVolumeNode or None
            Takes the intensities; a new node by default.
        keep : sequence of str
            Other results to output: "score", "hits", "cosine", "mask".
        progress : callable or None
            ``progress(fraction, message) -> bool``; False cancels. None: a dialog tells, by which it can be canceled.
        inputs : dict or None
            As in `choices`; for callers from before these took them.
        **choices
            The fields of `AIFReconLib.Recipe`, as ``method="average", holeLimit=1.0`` (``hole_limit`` does as well), and
            those of `AIFReconScene.inputs.inputs.Inputs`, as ``region=roiNode, boneSegments=("L3",)``.

        Returns
        -------
        volume : vtkMRMLScalarVolumeNode
            Or an AIFReconError with what is wrong and what to do, OperationCanceled after a cancel; the scene is then as before.
        """
        from AIFReconGui.longWork import progressOr

        settings, more = settingsAndInputs({**(inputs or {}), **choices})
        given = Inputs(sweep=sweep, bone=bone, recipe=Recipe(**{"best_cosine": "cosine" in keep, **settings}), **more)
        with progressOr(progress, _("Reconstruction")) as progress:
            _job, made = self._made(given, keep, progress)
        return self._kept(made, given, output, keep)

    # ---- for the panel

    def describeSweep(self, parameters) -> str:
        """How many frames the chosen sweep has and why some cannot be used, in words; also what is wrong with it as a whole."""
        return inPanelWords(self.sweep.text(parameters))

    def offeredSweeps(self, parameters) -> list:
        """The sweeps that can be reconstructed with the chosen one, and those that are."""
        return offered(parameters, self.sweep)

    def trackingReport(self, parameters) -> tuple:
        """Title and `TrackingReport` of the chosen sweep, with the coverage where it was reconstructed last."""
        return self._tracking.of(parameters)

    def loadRecording(self, parameters, progress=None) -> str:
        """Read the chosen recording and select it; the spacing follows a configuration that tells one."""
        from AIFReconScene.display.firstLook import showInputs
        from AIFReconScene.volumes.opening import openedTogether

        configuration = parameters.configurationPath if parameters.configurationPath.is_file() else None
        with openedTogether(parameters):
            told = part(progress, 0.0, 0.95)
            browser = self.readRecording(parameters.recordingPath, configuration, told, **readingFrom(parameters))
            parameters.sweep, parameters.imageSequence = browser, None
            takeConfigured(parameters, browser)
        showInputs(browser, parameters.ctVolume)
        return _("Loaded {name}.").format(name=browser.GetName())

    def takeImported(self, parameters, foreign, progress=None) -> str:
        """Add a `ForeignSweep` to the scene and select it."""
        from AIFReconScene.display.firstLook import showInputs
        from AIFReconScene.volumes.opening import openedTogether

        with openedTogether(parameters):
            parameters.sweep, parameters.imageSequence = foreign.browser(part(progress, 0.0, 0.95)), None
            showInputs(parameters.sweep, parameters.ctVolume)
        return _("Imported {name}.").format(name=parameters.sweep.GetName())

    def apply(self, parameters, progress=None) -> str:
        """Reconstruct what the parameters ask for, show it over the CT, and return what was done in a few lines."""
        from AIFReconScene.volumes.volumeNodes import isRenamed

        keep = [name for name in ("score", "hits", "mask") if getattr(parameters, "keep" + name.capitalize())]
        keep += ["cosine"] if parameters.bestCosine else []
        inputs = Inputs.fromParameters(parameters)
        job, made = self._made(inputs, keep, part(progress, 0.0, 0.85), forViews=True)
        # Drawn once, when all of it is shown
        with slicer.util.RenderBlocker():
            node = self._kept(made, inputs, None if isRenamed(parameters.output) else parameters.output, keep)
            if progress is not None:
                progress(0.85, "Showing the volume")  # it is there: too late to cancel
            if node.GetScene() is None or parameters.sweep is None:
                raise OperationCanceled("The volume or its sweep was deleted meanwhile.")
            parameters.output = node
            self.paths.remember(node, made.result)
            self.display.showOutput(parameters, part(progress, 0.85, 0.9))
        self.verdicts.judge(parameters, made.comparison, next(iter(made.tracking.values())), job, made.motion)
        unchecked = _("Whether the CT lies on the sweep was not looked at: it is shown where its file has it.")
        return "\n".join([*made.lines, *([unchecked] if parameters.ctVolume is not None and made.comparison is None else [])])

    def openFiles(self, parameters, paths, progress=None) -> str:
        """Read files of any kind that a reconstruction needs, choose and show what they hold; returns what was done."""
        from AIFReconScene.display.firstLook import openAndShow

        return openAndShow(parameters, paths, self.loadRecording, progress)

    def compare(self, parameters, progress=None) -> str:
        """Reconstruct with every method that is compared, show the volumes side by side and measure them; returns what was done."""
        from AIFReconScene.volumes.comparison import compareMethods

        comparison = compareMethods(Inputs.fromParameters(parameters), progress)
        self.display.showComparison(comparison, parameters, progress)
        return comparison.report

    def _made(self, inputs, keep, progress, forViews=False):
        """The `ReconstructionJob` that the inputs are, and the worker's `ReconstructionOutput`."""
        from AIFReconLib.worker.reconstructing import reconstructed

        job = inputs.job(part(progress, 0.0, 0.1))
        made = inWorker(reconstructed, job, keep, forViews, asControl(), progress=part(progress, 0.1, 1.0))
        self._tracking.remember(inputs, made.result.method, next(iter(made.tracking.values())))
        return job, made

    def _kept(self, made, inputs, output, keep):
        """The volume node of a `ReconstructionOutput`, with what is kept beside it; None as `output`: a new one."""
        from AIFReconScene.picture.spineView import keepSpine
        from AIFReconScene.volumes.volumeNodes import outputNodes

        slicer.mrmlScene.SaveStateForUndo()
        kinds, given = ("intensity", *keep), {"intensity": output}
        with slicer.util.RenderBlocker():
            nodes = outputNodes(made.result, inputs.name, kinds, given, inputs=inputs.nodes(), measured=made.measured)
            keepSpine(nodes["intensity"], made.surface, inputs.name)
        return nodes["intensity"]


class AIFReconTest(ScriptedLoadableModuleTest):
    """The whole on the simulated patient; Testing/Slicer holds the tests of each part."""

    def setUp(self):
        """Begin with an empty scene."""
        slicer.mrmlScene.Clear()

    def test_the_simulated_patient_s_bone_appears_where_the_ct_shows_it(self):
        """The peaks across the segmented surface lie on it."""
        from AIFReconScene.inputs.boneNodes import labelsFromNode
        from AIFReconScene.transforms import ijkToRAS
        from AIFReconScene.volumes.phantomSample import loadPhantom

        from AIFReconLib import Volume
        from AIFReconLib.worker.evaluating import measured_volumes

        loadPhantom()
        parameters = (logic := AIFReconLogic()).getParameterNode()
        readiness.chooseDefaults(parameters)
        node = logic.reconstruct(parameters.sweep, parameters.bone, spacing=1.0, hole_limit=2.0, inputs={"boneSigmaMm": 4.0})
        volume = Volume(slicer.util.arrayFromVolume(node), ijkToRAS(node))
        bone = inWorker(measured_volumes, {"": volume}, labelsFromNode(parameters.bone))[""].bone
        self.assertTrue(bone.coverage > 0.1 and bone.localization_error < 1.0, bone)
