"""A picture of the bone in 3D for a page: drawn offscreen, from behind, whatever the views show."""

import numpy as np
import slicer
import vtk
from vtk.util import numpy_support

from AIFReconLib.errors import AIFReconError

from ..transforms import matrixToWorld
from .spineView import FARTHEST, distanceColors

SIZE = (640, 720)
"""Pixels."""

BEHIND, BEHIND_OPACITY = (0.55, 0.60, 0.70), 0.15
"""The bone of the CT."""

BACKGROUND = (0.07, 0.08, 0.11)
MARGIN = 1.08


def spinePicture(model, bone=None) -> bytes:
    """A PNG file of a model of `keepSpine`, with the closed surfaces of a segmentation behind it, where it has some."""
    try:
        place = matrixToWorld(bone) if bone is not None else np.eye(4)
    except AIFReconError:
        bone, place = None, np.eye(4)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(*BACKGROUND)
    renderer.SetUseDepthPeeling(True)
    renderer.AddActor(_spine(model.GetPolyData()))
    for surface in _surfaces(bone):
        renderer.AddActor(_behind(surface, place))
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetAlphaBitPlanes(True)
    window.SetMultiSamples(0)
    window.SetSize(*SIZE)
    window.AddRenderer(renderer)
    _aim(renderer, place[:3, 1], place[:3, 2])
    window.Render()
    seen = vtk.vtkWindowToImageFilter()
    seen.SetInput(window)
    seen.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(seen.GetOutputPort())
    writer.WriteToMemoryOn()
    writer.Write()
    data = numpy_support.vtk_to_numpy(writer.GetResult()).tobytes()
    window.Finalize()
    return data


def _spine(surface):
    table = vtk.vtkLookupTable()
    colors = distanceColors()
    table.SetNumberOfTableValues(len(colors))
    for number, color in enumerate(colors):
        table.SetTableValue(number, *color, 1.0)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.SetLookupTable(table)
    mapper.SetScalarRange(0.0, FARTHEST)
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*colors[0])
    return actor


def _behind(surface, place):
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface)
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.SetUserMatrix(slicer.util.vtkMatrixFromArray(place))
    actor.GetProperty().SetColor(*BEHIND)
    actor.GetProperty().SetOpacity(BEHIND_OPACITY)
    return actor


def _surfaces(bone) -> list:
    """What 3D views draw of the segments."""
    name = slicer.vtkSegmentationConverter.GetClosedSurfaceRepresentationName()
    if bone is None or not bone.IsA("vtkMRMLSegmentationNode") or not bone.GetSegmentation().ContainsRepresentation(name):
        return []
    segmentation = bone.GetSegmentation()
    segments = [segmentation.GetNthSegment(number) for number in range(segmentation.GetNumberOfSegments())]
    return [surface for surface in (each.GetRepresentation(name) for each in segments) if surface is not None]


def _aim(renderer, front, head) -> None:
    camera = renderer.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(0.0, 0.0, 0.0)
    camera.SetPosition(*-np.asarray(front))
    camera.SetViewUp(*head)
    renderer.ResetCamera()
    camera.SetParallelScale(camera.GetParallelScale() * MARGIN)
