"""Straight lines from the skin past bone: what the worker finds in a volume, and the nodes that show it; they are saved with the scene."""

import functools

import numpy as np
import slicer
import vtk
from slicer.i18n import tr as _

from AIFReconLib.geometry.labels import Labels
from AIFReconLib.paths.path_query import PathQuery
from AIFReconLib.paths.states import COLORS
from AIFReconLib.progress import part

from ..display import sliceDisplay
from ..display.ownNodes import colorBy, legend, polyData, setScalars
from ..inputs.boneNodes import boneNames, isLabeled, nameOf
from ..inputs.inputs import Inputs
from ..registration.ctRegistration import rigidPlace
from ..sceneNodes import removeNodes, sharedColors
from ..transforms import placeOf
from ..volumes.volumeNodes import MASK, SCORE, besideOf, giveName, hasGivenName, intoFolder, volumeOf
from ..work import inWorker, worker
from .levelNames import placingKept

A_POINT = "a point"
"""As a target, beside levels."""

STATE = "Best line from here"
ROLE = "AIFRecon.Paths"
"""Of the references from a volume to the nodes of the paths that it shows."""

RGB = [tuple(int(color[n : n + 2], 16) / 255 for n in (1, 3, 5)) for color in COLORS]


class FreePaths:
    """The paths that were found last; the worker keeps what tells of any other line."""

    def __init__(self):
        self._last, self._found, self._map = (None, 0, None, None), None, None
        self.lines: list = []  #: Nodes of the best line of each window, the best first
        self.unseen = None  #: Where windows were not seen, (n, 3) in RAS; guidance leads there

    def remember(self, node, result, skin=None) -> None:
        """Keep what the scene does not of the `Reconstruction` that a node shows: the score, and points of a scan's skin, (n, 3) in RAS."""
        self._last = node, node.GetImageData().GetMTime(), result, skin

    def whyNotFind(self, parameters, level: str | None) -> str:
        """What is missing before paths to a level, or to the point, can be looked for; empty: nothing."""
        if parameters.output is None or parameters.output.GetImageData() is None:
            return _("Reconstruct a volume first, or select one as output.")
        if level is None and (parameters.pathPoint is None or not parameters.pathPoint.GetNumberOfControlPoints()):
            return _("Select or create a point, and place it with a click into a view.")
        if parameters.sweep is None and self._made(parameters.output)[1] is None:
            return _("Select the sweep that it was made from.")
        return ""

    def find(self, parameters, level: str | None, progress=None) -> tuple:
        """Look for paths and show them; what must be known of them, in sentences. An AIFReconError says what cannot be."""
        self.forget()
        output, bone, inputs = parameters.output, parameters.bone, Inputs.fromParameters(parameters)
        result, skin = self._made(output)
        labels = place = None
        if bone is not None and isLabeled(bone):
            place, labels = rigidPlace(bone), inputs.labels(part(progress, 0.0, 0.1))
            labels = Labels(labels.array, labels.ijk_to_reference, names=boneNames(bone, list(inputs.boneSegments)))
        target = pointOf(parameters) if level is None else level
        beside = (besideOf(output, MASK), besideOf(output, SCORE)) if result is None else (result.mask, result.score)
        skin = inputs.sequence() if skin is None else skin
        asked = volumeOf(output), *beside, target, skin, labels, place, inputs.recipe
        self._found = worker.keep(PathQuery, *asked, progress=part(progress, 0.1, 1.0))
        shown = inWorker(PathQuery.shown, self._found)
        self.unseen = shown.unseen if len(shown.unseen) else None
        with slicer.util.RenderBlocker():
            self._show(output, shown)
        return shown.notes

    def along(self, node):
        """A `Task` that tells what the line of a node meets as it lies now, a `MetLine`; None where that is no line any more."""
        ends = endsOf(node)
        return None if ends is None or self._found is None else worker.begin("along", self._found, *ends)

    def choose(self, chosen) -> None:
        """Show this line alone, and lay the slices along and across it."""
        for node in self.lines:
            node.SetDisplayVisibility(node is chosen)
        sliceDisplay.lieAlong(*endsOf(chosen))

    def forget(self) -> None:
        """They are of other inputs: hide what is shown of them."""
        if self._found is not None:
            worker.forget(self._found)
            for node in (self._map, *self.lines):
                if node is not None and node.GetScene() is not None:
                    node.SetDisplayVisibility(False)
        self._found, self._map, self.lines, self.unseen = None, None, [], None

    def clear(self) -> None:
        """The scene goes, or the panel."""
        self.forget()
        self._last = (None, 0, None, None)

    def _made(self, output) -> tuple:
        """The `Reconstruction` that a volume shows, and a scan's skin; None, where that is not known."""
        node, time, *made = self._last
        return tuple(made) if node is output and output.GetImageData().GetMTime() == time else (None, None)

    def _show(self, output, shown) -> None:
        earlier = [output.GetNthNodeReference(ROLE, n) for n in range(output.GetNumberOfNodeReferences(ROLE))]
        removeNodes([node for node in earlier if node is not None and hasGivenName(node)])
        output.RemoveNodeReferenceIDs(ROLE)
        self._map, self.lines = _mapNode(shown), [_lineNode(number, line) for number, line in enumerate(shown.lines, start=1)]
        for node in (self._map, *self.lines):
            node.SetDescription(_("For research, not for guiding a needle."))
            output.AddNodeReferenceID(ROLE, node.GetID())
        intoFolder([self._map, *self.lines], output.GetName())


def _mapNode(shown):
    """The skin, colored by the best line from each place."""
    node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode")
    giveName(node, "Free paths on the skin")
    surface = polyData(shown.skin.astype(np.float32), shown.triangles)
    setScalars(surface.GetPointData(), STATE, shown.states.astype(np.int16))
    node.SetAndObservePolyData(surface)
    node.CreateDefaultDisplayNodes()
    colors = sharedColors("Free paths", "AIFRecon.PathColors", [(name, (*color, 1.0)) for name, color in zip(stateNames(), RGB)])
    colorBy(node.GetDisplayNode(), STATE, colors, -0.5, len(RGB) - 0.5)
    return node


def _lineNode(number: int, line):
    """A line that can be dragged, in the color of its state."""
    with placingKept():
        node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsLineNode")
    giveName(node, f"Path {number}")
    for place, name in ((line.entry, "entry"), (line.end, "target")):
        node.AddControlPoint(vtk.vtkVector3d(*place), name)
    node.CreateDefaultDisplayNodes()
    node.GetDisplayNode().SetSelectedColor(*RGB[line.state])
    node.SetDisplayVisibility(False)
    return node


def endsOf(node):
    """The ends of a line in RAS world, (2, 3) mm; None where it has lost one, or has left the scene."""
    whole = node.GetScene() is not None and node.GetNumberOfControlPoints() == 2
    return slicer.util.arrayFromMarkupsControlPoints(node, world=True) if whole else None


def pointOf(parameters):
    """Where the user has placed the target, (3,) mm in RAS world; None where nowhere."""
    node = parameters.pathPoint
    return None if node is None or not node.GetNumberOfControlPoints() else slicer.util.arrayFromMarkupsControlPoints(node, world=True)[0]


def placeWithMouse(node) -> None:
    """Let the next click into a view place a point of a markups node."""
    selection, interaction = slicer.app.applicationLogic().GetSelectionNode(), slicer.app.applicationLogic().GetInteractionNode()
    selection.SetReferenceActivePlaceNodeClassName(node.GetClassName())
    selection.SetReferenceActivePlaceNodeID(node.GetID())
    interaction.SetCurrentInteractionMode(interaction.Place)


def levelsOf(parameters) -> dict[str, str]:
    """The gaps between neighboring bones, in words, and what the library calls them."""
    bone = parameters.bone
    names = {} if bone is None else boneNames(bone, list(parameters.boneSegments))
    if bone is not None and bone.IsA("vtkMRMLLabelMapVolumeNode") and bone.GetImageData() is not None:
        names = {number: nameOf(number, {}) for number in _numbersIn(bone.GetID(), bone.GetImageData().GetMTime())}
    words = _("{upper} to {lower}")
    pairs = zip(list(names.items()), list(names.items())[1:])
    return {words.format(upper=upper, lower=lower): f"{one}-{other}" for (one, upper), (other, lower) in pairs}


@functools.lru_cache(maxsize=1)
def _numbersIn(nodeID: str, _time: int) -> list[int]:
    """The labels of a labelmap, above 0, looked for once: it is asked whenever anything of the panel changes."""
    planes = slicer.util.arrayFromVolume(slicer.mrmlScene.GetNodeByID(nodeID))
    return sorted(set().union(*(np.flatnonzero(np.bincount(plane.ravel())).tolist() for plane in planes)) - {0})


def aboutOf(parameters, level: str | None) -> tuple:
    """What paths are about: they do not hold when that changes."""
    output, bone = parameters.output, parameters.bone
    image = None if output is None else output.GetImageData()
    of_bone = None if bone is None else (bone.GetID(), placeOf(bone).tobytes(), tuple(parameters.boneSegments))
    point = None if level is not None or pointOf(parameters) is None else pointOf(parameters).tobytes()
    return image, image and image.GetMTime(), parameters.sweep, tuple(parameters.otherSweeps), of_bone, level, point


def stateNames() -> tuple:
    """What the colors stand for, in the user's language."""
    return _("blocked by bone"), _("not seen"), _("tight, below 1 mm"), _("free")


def statesInWords() -> str:
    """What the colors stand for, as HTML."""
    return legend(_("The best line from the skin:"), reversed(RGB), reversed(stateNames()))
