"""Volumes in the slice views: the reconstruction over the CT, several of them side by side, and volume rendering."""

import contextlib
from collections.abc import Iterator

import numpy as np
import slicer

from AIFReconLib.errors import AIFReconError, SettingsError

from ..sceneNodes import boundsOf, removeNodes
from ..transforms import ijkToRAS, matrixToWorld
from ..volumes.volumeNodes import KIND_ATTRIBUTE, windowOf

MAIN_VIEWS = ("Red", "Yellow", "Green")

FIRST_LAYOUT = 4200
"""Layout numbers 4201 to 4219 are ours: Slicer's own stay below 100, and custom ones are free from there on."""

MOST_VIEWS = 9
WITH_TABLE = 10
"""Added to the number of a layout that has a table below its slice views."""

VIEW_NAME = "AIFRecon{number}"
TABLE_VIEW_NAME = "AIFReconTable"

FRAME_VIEW = "Red"
"""The view that lies in a frame before there is a volume, or while one grows."""

MARGIN = 1.1
"""Of the view around the frame."""

_FRAME_SHOWN = "AIFRecon.InFrame"
"""Attribute of that view's slice node before there is a volume."""

IN_FRAME, ON_PATH = "Frame", "Path"
"""Orientations of a view in a frame, and along or across a path, as the view's own list names them."""

_PREVIOUS_LAYOUT = "AIFRecon.PreviousLayout"
"""Attribute of the layout node while volumes are side by side."""


def mainViews() -> list:
    """The slice nodes of the red, yellow and green view."""
    return [logic.GetSliceNode() for logic in _sliceLogics(MAIN_VIEWS)]


def showOverCT(outputNode, ctNode=None, opacity: float = 1.0, views=MAIN_VIEWS, fit: bool = True) -> None:
    """Show a volume over a CT, or alone; with `fit` the views are brought to it, else they stay where the user has brought them."""
    for sliceLogic in _sliceLogics(views):
        _showIn(sliceLogic, outputNode, ctNode, opacity)
        if _leaveFrame(sliceLogic.GetSliceNode()) or fit:
            _fit(sliceLogic, outputNode)


def isShown(volumeNode) -> bool:
    """Whether any slice view shows a volume, over another or alone."""
    return any(volumeNode.GetID() in (each.GetBackgroundVolumeID(), each.GetForegroundVolumeID()) for each in _composites())


def showBackground(volumeNode) -> None:
    """Show a volume in the background of the red, yellow and green views, and all of it in those that did not show it."""
    for sliceLogic in _sliceLogics(MAIN_VIEWS):
        composite = sliceLogic.GetSliceCompositeNode()
        if composite.GetBackgroundVolumeID() != volumeNode.GetID():
            with changing(composite):
                composite.SetBackgroundVolumeID(volumeNode.GetID())
            _leaveFrame(sliceLogic.GetSliceNode())
            _fit(sliceLogic, volumeNode)


def showFrame(imageNode) -> None:
    """Show the image of a sweep that nothing was made of yet: in its plane, and in its place in 3D."""
    for sliceLogic in _sliceLogics([FRAME_VIEW] if imageNode is not None and imageNode.GetImageData() is not None else ()):
        node, composite = sliceLogic.GetSliceNode(), sliceLogic.GetSliceCompositeNode()
        with changing(composite):
            composite.SetBackgroundVolumeID(imageNode.GetID())
        node.SetAttribute(_FRAME_SHOWN, imageNode.GetID())
        node.SetSliceVisible(True)
        followFrame()


def followFrame() -> None:
    """Let the view that shows a frame lie in its plane as it is now, unless the user has turned it or chosen something else."""
    for sliceLogic in _sliceLogics([FRAME_VIEW]):
        node, shown = sliceLogic.GetSliceNode(), sliceLogic.GetSliceCompositeNode().GetBackgroundVolumeID()
        image = slicer.mrmlScene.GetNodeByID(shown) if shown and shown == node.GetAttribute(_FRAME_SHOWN) else None
        if image is not None:
            with contextlib.suppress(AIFReconError):  # a transform that warps
                lieIn(node, image)


def _leaveFrame(sliceNode) -> bool:
    """Turn a view that lies in a frame as views are turned; whether it lay in one."""
    isIn = sliceNode.GetAttribute(_FRAME_SHOWN) is not None
    if isIn:
        sliceNode.RemoveAttribute(_FRAME_SHOWN)
        sliceNode.SetSliceVisible(False)
        if sliceNode.GetOrientation() in (IN_FRAME, "Reformat"):
            sliceNode.SetOrientationToDefault()
    return isIn


def lieIn(sliceNode, imageNode) -> None:
    """Let a view lie in the plane of an image, which fills it; a TransformError where a transform above the image warps it."""
    pose = matrixToWorld(imageNode) @ ijkToRAS(imageNode)
    columns, rows, _slices = imageNode.GetImageData().GetDimensions()
    spacing = np.linalg.norm(pose[:3, :2], axis=0)
    across, down = pose[:3, 0] / spacing[0], pose[:3, 1] / spacing[1]
    center = pose @ [(columns - 1) / 2, (rows - 1) / 2, 0.0, 1.0]
    # Screens have their y axis upward, images have their rows downward
    sliceToRAS = _placeOf(across, -down, center[:3])
    width, height, _depth = sliceNode.GetDimensions()
    shown = MARGIN * max(columns * spacing[0] / max(width, 1), rows * spacing[1] / max(height, 1))
    with slicer.util.NodeModify(sliceNode):
        _turn(sliceNode, sliceToRAS, IN_FRAME)
        sliceNode.SetFieldOfView(shown * width, shown * height, sliceNode.GetFieldOfView()[2])
        sliceNode.UpdateMatrices()


def lieAlong(entry: np.ndarray, end: np.ndarray) -> None:
    """Lay the red view along a line between two points of RAS world, its entry on top, and the yellow one across it, at its middle."""
    down = (end - entry) / np.linalg.norm(end - entry)
    # Right on the screen is the patient's left, as in other axial views, unless the line leads there
    first = np.eye(3)[1 if abs(down[0]) > np.sqrt(0.5) else 0]
    right = (first @ down) * down - first
    right /= np.linalg.norm(right)
    for name, up in (("Red", -down), ("Yellow", np.cross(down, right))):
        for sliceLogic in _sliceLogics([name]):
            node = sliceLogic.GetSliceNode()
            _leaveFrame(node)
            _turn(node, _placeOf(right, up, (entry + end) / 2), ON_PATH)
            node.UpdateMatrices()


def _turn(sliceNode, sliceToRAS: np.ndarray, name: str) -> None:
    """Lay a view obliquely, and give that orientation a name: of one without Slicer logs an error when it opens a saved scene."""
    sliceNode.AddSliceOrientationPreset(name, slicer.util.vtkMatrixFromArray(sliceToRAS[:3, :3]))
    sliceNode.GetSliceToRAS().DeepCopy(slicer.util.vtkMatrixFromArray(sliceToRAS))


def _placeOf(right: np.ndarray, up: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Where a view lies, (4, 4), by unit vectors, (3,), on its screen, and its middle."""
    normal, place = np.cross(right, up), np.eye(4)
    place[:3] = np.column_stack([right, up, normal / np.linalg.norm(normal), center])
    return place


def showsReconstruction() -> bool:
    """Whether any slice view of the layout shows a volume that was reconstructed here."""
    logics = slicer.app.applicationLogic().GetSliceLogics()
    for index in range(logics.GetNumberOfItems()):
        sliceNode, composite = logics.GetItemAsObject(index).GetSliceNode(), logics.GetItemAsObject(index).GetSliceCompositeNode()
        if sliceNode is None or composite is None or not sliceNode.IsMappedInLayout():
            continue
        shown = [composite.GetBackgroundVolumeID(), composite.GetForegroundVolumeID()]
        nodes = [sliceNode.GetScene().GetNodeByID(nodeID) for nodeID in shown if nodeID]
        if any(node is not None and node.GetAttribute(KIND_ATTRIBUTE) for node in nodes):
            return True
    return False


def setOpacity(outputNode, opacity: float) -> None:
    """Set how strongly `outputNode` covers the CT, 0 to 1, wherever it is in the foreground."""
    for composite in _composites():
        if composite.GetForegroundVolumeID() == outputNode.GetID():
            with changing(composite):
                composite.SetForegroundOpacity(opacity)


def exchange(before, after) -> bool:
    """Show one volume wherever the other is shown, as background or foreground; whether it was shown anywhere."""
    found = False
    for composite in _composites():
        for layer in ("Background", "Foreground"):
            if getattr(composite, f"Get{layer}VolumeID")() == before.GetID():
                with changing(composite):
                    getattr(composite, f"Set{layer}VolumeID")(after.GetID())
                found = True
    return found


def showLabels(labelNode, overNode) -> None:
    """Show labels over a volume, as opaque as it is, wherever it is shown and nothing else takes their place; elsewhere no longer."""
    for composite in _composites():
        shown = composite.GetLabelVolumeID()
        over = overNode.GetID() if overNode is not None else None
        if over is not None and over in (composite.GetBackgroundVolumeID(), composite.GetForegroundVolumeID()):
            if shown in (None, "", labelNode.GetID()):
                with changing(composite):
                    composite.SetLabelVolumeID(labelNode.GetID())
                    composite.SetLabelOpacity(composite.GetForegroundOpacity() if composite.GetForegroundVolumeID() == over else 1.0)
        elif shown == labelNode.GetID():
            with changing(composite):
                composite.SetLabelVolumeID(None)
                composite.SetLabelOpacity(1.0)


def showSideBySide(volumes: list, ctNode=None, tableNode=None, fit: bool = True, progress=None) -> None:
    """Show 1 to 9 volumes, each with its label for the view's bar, in linked slice views that scroll, pan and zoom together.

    The CT is shown where a volume has nothing, the table below the views. With `fit` the views are brought to the first volume, as new ones
    are; else they stay where the user has brought them. `progress` is called after each new view, for which Slicer takes half a second; no
    more are made when it returns False.
    """
    if not 1 <= len(volumes) <= MOST_VIEWS:
        raise SettingsError(f"Input volumes must be 1 to {MOST_VIEWS}; got {len(volumes)}. Choose which to compare.")
    layout = _layoutNode()
    registerLayouts()
    number = FIRST_LAYOUT + len(volumes) + (WITH_TABLE if tableNode is not None else 0)
    if not _isOurs(layout.GetViewArrangement()):
        layout.SetAttribute(_PREVIOUS_LAYOUT, str(layout.GetViewArrangement()))
    there = len(_sliceLogics(_viewNames(len(volumes))))
    areThere = there == len(volumes)
    for arrangement in (*range(FIRST_LAYOUT + there + 1, FIRST_LAYOUT + len(volumes)), number):
        layout.SetViewArrangement(arrangement)
        if progress is not None and progress(1.0, "") is False:  # views have their size once events were handled
            return
    tableView = slicer.mrmlScene.GetSingletonNode(TABLE_VIEW_NAME, "vtkMRMLTableViewNode")
    if tableNode is not None and tableView is not None:
        tableView.SetTableNodeID(tableNode.GetID())
    logics = _sliceLogics(_viewNames(len(volumes)))
    if not logics:
        return  # an application without views
    for sliceLogic in logics:
        # While views are linked, setting one up would change the others
        sliceLogic.GetSliceCompositeNode().SetLinkedControl(False)
    first = logics[0].GetSliceNode()
    for sliceLogic, (node, label) in zip(logics, volumes):
        sliceNode = sliceLogic.GetSliceNode()
        sliceNode.SetLayoutLabel(label)
        _showIn(sliceLogic, node, ctNode, 1.0)
        if areThere and not fit:
            continue
        sliceNode.SetOrientation("Axial")
        _fit(sliceLogic, volumes[0][0])
        if sliceNode is not first:
            sliceNode.GetSliceToRAS().DeepCopy(first.GetSliceToRAS())
            sliceNode.UpdateMatrices()
    for sliceLogic in logics:
        sliceLogic.GetSliceCompositeNode().SetLinkedControl(True)
        sliceLogic.GetSliceCompositeNode().SetHotLinkedControl(True)


@contextlib.contextmanager
def changing(composite) -> Iterator[None]:
    """Change what a view shows at once, and as no step of *Undo*: the view's own controls save one whenever volumes or opacities change."""
    scene = composite.GetScene()
    asked = scene.GetUndoFlag()
    scene.SetUndoFlag(False)
    try:
        with slicer.util.NodeModify(composite):
            yield
    finally:
        scene.SetUndoFlag(asked)


def restoreLayout() -> None:
    """Back to the layout there was before `showSideBySide`; nothing happens while another layout is shown.

    The views that were side by side go: Slicer keeps what it has once made, and a view that is not seen costs about as much as one that is.
    """
    layout = _layoutNode()
    if _isOurs(layout.GetViewArrangement()):
        previous = layout.GetAttribute(_PREVIOUS_LAYOUT)
        layout.SetViewArrangement(int(previous) if previous else slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpView)
        for logic in _sliceLogics(_viewNames(MOST_VIEWS)):
            inSpace = logic.GetSliceModelDisplayNode(), logic.GetSliceModelTransformNode(), logic.GetSliceModelNode()
            removeNodes([*inSpace, logic.GetSliceNode(), logic.GetSliceCompositeNode()])


def _viewNames(count: int) -> list:
    return [VIEW_NAME.format(number=number) for number in range(1, count + 1)]


def registerLayouts() -> None:
    """Tell the scene's layout node what our layouts are; a saved scene only holds the number of the one that was shown."""
    layout = _layoutNode()
    for count in range(1, MOST_VIEWS + 1) if layout is not None else ():
        for number, withTable in ((FIRST_LAYOUT + count, False), (FIRST_LAYOUT + WITH_TABLE + count, True)):
            if not layout.IsLayoutDescription(number):
                layout.AddLayoutDescription(number, layoutDescription(count, withTable))


def layoutDescription(count: int, withTable: bool = False) -> str:
    """The XML of a layout of so many slice views: one row of up to 3, two of up to 4 each, or three of 3; a table below if wanted."""
    rows = 1 if count <= 3 else 2 if count <= 8 else 3
    perRow = -(-count // rows)
    views = [
        f'<item><view class="vtkMRMLSliceNode" singletontag="{VIEW_NAME.format(number=number)}">'
        f'<property name="orientation" action="default">Axial</property>'
        f'<property name="viewlabel" action="default">{number}</property>'
        f'<property name="viewcolor" action="default">#6C7A89</property>'
        # A group of their own, so that the red, yellow and green views do not follow
        f'<property name="viewgroup" action="default">42</property></view></item>'
        for number in range(1, count + 1)
    ]
    lines = ["".join(views[start : start + perRow]) for start in range(0, count, perRow)]
    inner = "".join(f'<item><layout type="horizontal">{line}</layout></item>' for line in lines)
    slices = f'<layout type="vertical">{inner}</layout>'
    if not withTable:
        return slices
    label = '<property name="viewlabel" action="default">T</property>'
    table = f'<view class="vtkMRMLTableViewNode" singletontag="{TABLE_VIEW_NAME}">{label}</view>'
    return f'<layout type="vertical" split="true"><item splitSize="720">{slices}</item><item splitSize="280">{table}</item></layout>'


def showVolumeRendering(node, on: bool):
    """Turn volume rendering of an ultrasound volume on or off; the display node, or None where there is none and none is wanted.

    Notes
    -----
    Made once, with an opacity that starts high up the window: above tissue and the line of the skin. Later calls leave what the user has
    changed.
    """
    logic = slicer.app.applicationLogic().GetModuleLogic("VolumeRendering")
    display = logic.GetFirstVolumeRenderingDisplayNode(node)
    if display is None and on:
        # Drawn with its own opacity only: the default one has steps so fine that OpenGL complains
        with slicer.util.RenderBlocker():
            display = logic.CreateDefaultVolumeRenderingNodes(node)
            _likeUltrasound(display, node)
    if display is not None:
        display.SetVisibility(on)
    return display


def _likeUltrasound(display, node) -> None:
    import vtk

    low, high = windowOf(node)

    def level(share: float) -> float:
        return low + share * (high - low)

    opacity = vtk.vtkPiecewiseFunction()
    for share, value in ((0.0, 0.0), (0.75, 0.0), (0.88, 0.25), (1.0, 0.8)):
        opacity.AddPoint(level(share), value)
    colors = vtk.vtkColorTransferFunction()
    for share, color in ((0.0, (0.4, 0.27, 0.18)), (0.6, (0.85, 0.68, 0.48)), (0.85, (0.97, 0.91, 0.78)), (1.0, (1.0, 1.0, 0.97))):
        colors.AddRGBPoint(level(share), *color)
    properties = display.GetVolumePropertyNode()
    with slicer.util.NodeModify(properties):
        properties.SetScalarOpacity(opacity)
        properties.SetColor(colors)
        properties.GetVolumeProperty().ShadeOn()
        # Reconstructed bone is a thin sheet, whose two sides face opposite ways: light from the side alone leaves it dark
        properties.GetVolumeProperty().SetAmbient(0.6)


def _composites() -> list:
    """What each slice view shows, in any layout."""
    logics = slicer.app.applicationLogic().GetSliceLogics()
    found = [logics.GetItemAsObject(index).GetSliceCompositeNode() for index in range(logics.GetNumberOfItems())]
    return [each for each in found if each is not None]


def _sliceLogics(names) -> list:
    """The slice logics of these views that there are."""
    found = (slicer.app.applicationLogic().GetSliceLogicByLayoutName(name) for name in names)
    return [each for each in found if each is not None]


def _showIn(sliceLogic, node, ctNode, opacity: float) -> None:
    composite = sliceLogic.GetSliceCompositeNode()
    with changing(composite):
        composite.SetBackgroundVolumeID((ctNode or node).GetID())
        composite.SetForegroundVolumeID(node.GetID() if ctNode is not None else None)
        composite.SetForegroundOpacity(opacity if ctNode is not None else 0.0)


def _fit(sliceLogic, volumeNode) -> None:
    """Field of view and place of a view such that a volume fills it, its middle in the middle."""
    sliceNode = sliceLogic.GetSliceNode()
    width, height, _ = sliceNode.GetDimensions()
    sliceLogic.FitSliceToVolume(volumeNode, max(width, 1), max(height, 1))
    # Fitting rounds the place to voxels of the background
    sliceNode.JumpSliceByCentering(*boundsOf(volumeNode).mean(axis=1))


def _layoutNode():
    return slicer.mrmlScene.GetFirstNodeByClass("vtkMRMLLayoutNode")


def _isOurs(arrangement: int) -> bool:
    return FIRST_LAYOUT < arrangement <= FIRST_LAYOUT + WITH_TABLE + MOST_VIEWS
