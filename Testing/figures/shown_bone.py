"""The picture of docs/slicer.md: bone of the CT from behind, and the bone that a simulated sweep shows, from behind and from the side.

``python Testing/figures/shown_bone.py``, or ``make figures``. In the colors of the module.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import numpy as np
import vtk
from scipy import ndimage

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "AIFRecon"))

from host import i18n
from study.method_cases import EFFECTS, PHANTOM, patient_of, placed_labels, simulated_scan

from AIFReconLib.geometry.level_surface import level_surface
from AIFReconLib.geometry.volume import Volume
from AIFReconLib.inspection.bone_surface import bone_surface
from AIFReconLib.inspection.shown_bone import shown_bone
from AIFReconLib.recipe.recipe import Recipe
from AIFReconLib.reconstruction import reconstruct
from AIFReconLib.simulation.phased_array import PhasedArray
from AIFReconLib.simulation.scan import multi_angle_sweep

sys.modules["slicer.i18n"] = i18n  # slicer-core has none
spine_view = importlib.import_module("AIFReconScene.picture.spineView")

PICTURE = Path(__file__).resolve().parents[2] / "docs" / "images" / "shown-bone.png"
SEED, FRAMES, SPACING = 0, 270, 0.7
SIZE = (500, 600)
"""Pixels of each view."""

BELOW, ABOVE = (0.0, 0.0, 0.0), (0.12, 0.14, 0.2)
BEHIND, BEHIND_OPACITY = (0.55, 0.60, 0.70), 0.15
FROM_BEHIND, FROM_THE_SIDE = (0.0, -1.0, 0.1), (0.9, -0.45, 0.1)


def surface_of_labels(labels: Volume) -> vtk.vtkPolyData:
    """The surface of all labels without the steps of their voxels, in Reference."""
    smooth = ndimage.gaussian_filter((labels.array > 0).astype(np.float32), 1.0)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputData(level_surface(Volume(smooth, labels.ijk_to_reference), 0.5, 0.0))
    normals.SplittingOff()
    normals.Update()
    return normals.GetOutput()


def actor_of(surface: vtk.vtkPolyData, color: tuple[float, float, float], opacity: float = 1.0) -> vtk.vtkActor:
    """In one color, or in those of its distances."""
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(surface)
    if surface.GetPointData().GetScalars() is not None and opacity == 1.0:
        colors = spine_view.distanceColors()
        table = vtk.vtkLookupTable()
        table.SetNumberOfTableValues(len(colors))
        for number, each in enumerate(colors):
            table.SetTableValue(number, *each, 1.0)
        mapper.SetLookupTable(table)
        mapper.SetScalarRange(0.0, spine_view.FARTHEST)
    else:
        mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*color)
    actor.GetProperty().SetOpacity(opacity)
    return actor


def main() -> None:
    """Simulate, reconstruct, draw."""
    back = patient_of(PHANTOM, SEED)
    labels = placed_labels(back)
    sequence = simulated_scan(back, PhasedArray(), multi_angle_sweep(back, FRAMES), SEED, EFFECTS).sequence
    found = bone_surface(shown_bone(reconstruct(sequence, Recipe(spacing=SPACING, hole_limit=2.0), labels), labels, np.eye(4)))
    assert found is not None
    ct, bone = surface_of_labels(labels), spine_view.surfaceOf(found)
    color = tuple(spine_view.distanceColors()[0])
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetAlphaBitPlanes(True)
    window.SetMultiSamples(0)
    window.SetSize(3 * SIZE[0], SIZE[1])
    behind = actor_of(ct, BEHIND, BEHIND_OPACITY)
    views = (
        ((actor_of(ct, color),), FROM_BEHIND),
        ((actor_of(bone, color), behind), FROM_BEHIND),
        ((actor_of(bone, color), behind), FROM_THE_SIDE),
    )
    for number, (actors, position) in enumerate(views):
        renderer = vtk.vtkRenderer()
        renderer.SetViewport(number / 3, 0.0, (number + 1) / 3, 1.0)
        renderer.SetBackground(*BELOW)
        renderer.SetBackground2(*ABOVE)
        renderer.GradientBackgroundOn()
        renderer.SetUseDepthPeeling(True)
        for actor in actors:
            renderer.AddActor(actor)
        window.AddRenderer(renderer)
        camera = renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(0.0, 0.0, 0.0)
        camera.SetPosition(*position)
        camera.SetViewUp(0.0, 0.0, 1.0)
        renderer.ResetCamera(ct.GetBounds())
        camera.SetParallelScale(0.72 * camera.GetParallelScale())
    window.Render()
    seen = vtk.vtkWindowToImageFilter()
    seen.SetInput(window)
    seen.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(seen.GetOutputPort())
    writer.SetFileName(str(PICTURE))
    writer.Write()


if __name__ == "__main__":
    main()
