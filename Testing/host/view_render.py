"""Pictures of MRML views, drawn offscreen by Slicer's own displayable managers and slice logics.

The application draws a slice view from two sources: the image that the slice logic blends from background and foreground, and what the
displayable managers add (segmentations, models that are cut, rulers). The same two are put together here in a VTK window that is never
shown. A 3D view is drawn by its displayable managers alone.

Limits: no interaction, and none of the texts that the application's own widgets lay over a view. OpenGL must be there, be it in software;
`why_no_views` says why where it is not.
"""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np

SLICE_MANAGERS = (
    "vtkMRMLVolumeGlyphSliceDisplayableManager",
    "vtkMRMLModelSliceDisplayableManager",
    "vtkMRMLSegmentationsDisplayableManager2D",
    "vtkMRMLMarkupsDisplayableManager",
    "vtkMRMLRulerDisplayableManager",
)
THREE_D_MANAGERS = (
    "vtkMRMLVolumeRenderingDisplayableManager",
    "vtkMRMLCameraDisplayableManager",
    "vtkMRMLViewDisplayableManager",
    "vtkMRMLModelDisplayableManager",
    "vtkMRMLSegmentationsDisplayableManager3D",
    "vtkMRMLMarkupsDisplayableManager",
    "vtkMRMLOrientationMarkerDisplayableManager",
)

_PROBE = """
import vtk
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.SetSize(8, 8)
window.AddRenderer(vtk.vtkRenderer())
window.Render()
raise SystemExit(0 if window.SupportsOpenGL() else 1)
"""


def why_no_views() -> str:
    """Why views cannot be drawn here; "" where they can. Tried in a process of its own, because a missing OpenGL may end it."""
    prefer_headless()
    try:
        tried = subprocess.run([sys.executable, "-c", _PROBE], capture_output=True, timeout=120, check=False)
    except subprocess.TimeoutExpired:
        return "a window offscreen was not drawn within 2 minutes"
    return "" if tried.returncode == 0 else "VTK finds no OpenGL to draw with offscreen"


def prefer_headless() -> None:
    """Lets VTK draw by EGL where there is no display on Linux; must come before the first window. What the user has set stays."""
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", "vtkEGLRenderWindow")


class _View:
    """A window offscreen and the displayable managers of one view node."""

    def __init__(self, node, factory, managers, size, application_logic):
        import slicer
        import vtk

        prefer_headless()
        self._renderer = vtk.vtkRenderer()
        self._window = vtk.vtkRenderWindow()
        self._window.SetOffScreenRendering(True)
        self._window.SetMultiSamples(8)
        self._window.SetSize(*size)
        self._window.AddRenderer(self._renderer)
        # Some displayable managers take an interactor for granted; it is never started
        self._interactor = vtk.vtkGenericRenderWindowInteractor()
        self._interactor.SetRenderWindow(self._window)
        self._interactor.Initialize()
        factory.SetMRMLApplicationLogic(application_logic)
        for name in managers:
            if not factory.IsDisplayableManagerRegistered(name):
                factory.RegisterDisplayableManager(name)
        self._group = slicer.vtkMRMLDisplayableManagerGroup()
        self._group.SetRenderer(self._renderer)
        self._group.Initialize(factory, self._renderer)
        self._group.SetMRMLDisplayableNode(node)

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self._group.SetMRMLDisplayableNode(None)
        self._group = None
        self._window.Finalize()
        self._window = self._interactor = self._renderer = None

    def image(self) -> np.ndarray:
        """What the view shows now: (height, width, 3) uint8, the upper row first."""
        import vtk
        from vtk.util import numpy_support

        self._window.Render()
        reader = vtk.vtkWindowToImageFilter()
        reader.SetInput(self._window)
        reader.ReadFrontBufferOff()
        reader.ShouldRerenderOff()
        reader.SetInputBufferTypeToRGB()
        reader.Update()
        picture = reader.GetOutput()
        width, height, _ = picture.GetDimensions()
        pixels = numpy_support.vtk_to_numpy(picture.GetPointData().GetScalars()).reshape(height, width, 3)
        return pixels[::-1].copy()


class OffscreenSliceView(_View):
    """A slice view as the application would draw it.

    Parameters
    ----------
    slice_logic : vtkMRMLSliceLogic
        Of the view; its node is given the size.
    application_logic : vtkMRMLApplicationLogic
    size : (int, int)
        Width and height, pixels.
    """

    def __init__(self, slice_logic, application_logic, size: tuple[int, int]):
        import slicer
        import vtk

        slice_logic.ResizeSliceNode(*size)
        factory = slicer.vtkMRMLSliceViewDisplayableManagerFactory.GetInstance()
        super().__init__(slice_logic.GetSliceNode(), factory, SLICE_MANAGERS, size, application_logic)
        self._logic = slice_logic
        self._renderer.GetActiveCamera().ParallelProjectionOn()
        mapper = vtk.vtkImageMapper()
        # The blended image holds the colors that are to be shown, 0 to 255
        mapper.SetColorWindow(255)
        mapper.SetColorLevel(127.5)
        self._volumes = vtk.vtkActor2D()
        self._volumes.SetMapper(mapper)
        self._volumes.GetProperty().SetDisplayLocationToBackground()
        self._renderer.AddViewProp(self._volumes)

    def image(self) -> np.ndarray:
        """What the view shows now: (height, width, 3) uint8, the upper row first."""
        self._logic.UpdatePipeline()
        connection = self._logic.GetImageDataConnection()
        self._volumes.GetMapper().SetInputConnection(connection)
        self._volumes.SetVisibility(connection is not None)
        return super().image()


class OffscreenThreeDView(_View):
    """A 3D view as the application would draw it.

    Parameters
    ----------
    view_node : vtkMRMLViewNode
    application_logic : vtkMRMLApplicationLogic
    size : (int, int)
        Width and height, pixels.
    """

    def __init__(self, view_node, application_logic, size: tuple[int, int]):
        import slicer

        factory = slicer.vtkMRMLThreeDViewDisplayableManagerFactory.GetInstance()
        super().__init__(view_node, factory, THREE_D_MANAGERS, size, application_logic)
        # Peeling, which the view manager turns on, loses translucent lines in a window with multisampling
        self._renderer.SetUseDepthPeeling(False)

    def look(self, focal_point, away, distance: float) -> None:
        """Puts the camera so far away from a place, in a direction, the head up; RAS mm."""
        camera = self._renderer.GetActiveCamera()
        camera.SetFocalPoint(*focal_point)
        camera.SetPosition(*(focal_point + distance * np.asarray(away) / np.linalg.norm(away)))
        camera.SetViewUp(0.0, 0.0, 1.0)
        self._renderer.ResetCameraClippingRange()
