"""Finding nodes of a scene, and taking them out again without leaving anything behind."""

import contextlib

import slicer
import vtk


def nodesOfClass(className: str, scene) -> list:
    """The nodes of a class in a scene, in the scene's order."""
    return [scene.GetNthNodeByClass(index, className) for index in range(scene.GetNumberOfNodesByClass(className))]


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


def setWindow(display, low: float, high: float) -> None:
    """Show these gray levels, whatever the voxels are."""
    display.SetAutoWindowLevel(False)
    display.SetWindowLevelMinMax(low, high)


@contextlib.contextmanager
def addedTogether(scene):
    """What is added to a scene within stays if all goes well; where something raises, a cancel too, it is taken out again."""
    before = {node.GetID() for node in _all(scene)}
    try:
        yield
    except BaseException:
        # Singletons belong to the application
        added = [node for node in _all(scene) if node.GetID() not in before and not node.GetSingletonTag()]
        # Browsers first: they make the nodes anew that they replay into
        removeNodes(sorted(added, key=lambda node: node.IsA("vtkMRMLSequenceBrowserNode")), scene)
        raise


def _all(scene) -> list:
    return [scene.GetNthNode(number) for number in range(scene.GetNumberOfNodes())]


def freeName(name: str, scene) -> str:
    """`name`, with a number where a node has it already. Unlike the scene's own, a name that was not used in the end is given again."""
    number, free = 0, name
    while scene.GetFirstNodeByName(free) is not None:
        number += 1
        free = f"{name}_{number}"
    return free


def removeNodes(nodes, scene) -> None:
    """Take nodes out of a scene, the last first, with the display and storage nodes that were made for them."""
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
