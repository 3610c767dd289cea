"""Finding nodes of a scene, and taking them out again without leaving anything behind."""

import contextlib

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support


def proxiesOf(browser) -> list:
    """The nodes that a sequence browser replays into; none without a browser."""
    return [] if browser is None else _collected(browser.GetAllProxyNodes)


def sequencesOf(browser, withMaster: bool = True) -> list:
    """The sequences of a browser, its master first; none without a browser."""
    return [] if browser is None else _collected(browser.GetSynchronizedSequenceNodes, withMaster)


def _collected(give, *arguments) -> list:
    nodes = vtk.vtkCollection()
    give(nodes, *arguments)
    return [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]


def colorTable(name: str, colors):
    """A node of colors, each a name and (red, green, blue, opacity), that is in no scene yet."""
    node, colors = slicer.vtkMRMLColorTableNode(), list(colors)
    node.SetName(name)
    node.SetTypeToUser()
    node.SetNumberOfColors(len(colors))
    for number, (called, color) in enumerate(colors):
        node.SetColor(number, called, *color)
    return node


def sharedColors(name: str, attribute: str, colors):
    """A `colorTable` in the scene, one for all that ask for it by this attribute."""
    for node in slicer.util.getNodesByClass("vtkMRMLColorTableNode"):
        if node.GetAttribute(attribute):
            return node
    node = colorTable(name, colors)
    node.SetAttribute(attribute, "1")
    node.SetAttribute("Category", "AIFRecon")
    return slicer.mrmlScene.AddNode(node)


def setWindow(display, low: float, high: float) -> None:
    """Show these gray levels, whatever the voxels are."""
    display.SetAutoWindowLevel(False)
    display.SetWindowLevelMinMax(low, high)


def newImage(array: np.ndarray) -> tuple:
    """A vtkImageData for an array [k, j, i], and its own voxels as such an array, to be written into; truth values become bytes."""
    image = vtk.vtkImageData()
    image.SetDimensions(*array.shape[::-1])
    image.AllocateScalars(numpy_support.get_vtk_array_type(np.dtype(np.uint8) if array.dtype == bool else array.dtype), 1)
    return image, numpy_support.vtk_to_numpy(image.GetPointData().GetScalars()).reshape(array.shape)


def showGrayLevels(node) -> None:
    """Give an image node its display, with gray levels as in every other frame: automatic window and level would flicker."""
    node.CreateDefaultDisplayNodes()
    display = node.GetScalarVolumeDisplayNode()
    if node.GetImageData().GetScalarType() == vtk.VTK_UNSIGNED_CHAR:
        setWindow(display, 0, 255)
    display.SetInterpolate(True)


def boundsOf(node) -> np.ndarray:
    """Where a node lies in RAS world, (3, 2): the least and the most of each axis, mm."""
    bounds = np.zeros(6)
    node.GetRASBounds(bounds)
    return bounds.reshape(3, 2)


@contextlib.contextmanager
def addedTogether():
    """What is added to the scene within stays if all goes well; where something raises, a cancel too, it is taken out again."""
    before = {node.GetID() for node in slicer.util.getNodesByClass("vtkMRMLNode")}
    try:
        yield
    except BaseException:
        # Singletons belong to the application
        added = [node for node in slicer.util.getNodesByClass("vtkMRMLNode") if node.GetID() not in before and not node.GetSingletonTag()]
        # Browsers first: they make the nodes anew that they replay into
        removeNodes(sorted(added, key=lambda node: node.IsA("vtkMRMLSequenceBrowserNode")))
        raise


def freeName(name: str) -> str:
    """`name`, with a number where a node has it already. Unlike the scene's own, a name that was not used in the end is given again."""
    number, free = 0, name
    while slicer.mrmlScene.GetFirstNodeByName(free) is not None:
        number += 1
        free = f"{name}_{number}"
    return free


def removeNodes(nodes) -> None:
    """Take nodes out of the scene, the last first, with the display and storage nodes that were made for them."""
    scene = slicer.mrmlScene
    for node in reversed(list(nodes)):
        if node is None or node.GetScene() is not scene:
            # What went with another of them; Slicer logs an error for each that is taken out twice
            continue
        own = []
        if node.IsA("vtkMRMLDisplayableNode"):
            own += [node.GetNthDisplayNode(index) for index in range(node.GetNumberOfDisplayNodes())]
        if node.IsA("vtkMRMLStorableNode"):
            own += [node.GetNthStorageNode(index) for index in range(node.GetNumberOfStorageNodes())]
        scene.RemoveNode(node)
        for each in own:
            if each is not None and each.GetScene() is scene:
                scene.RemoveNode(each)
