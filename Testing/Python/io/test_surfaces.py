"""Closed surfaces of labels as files: where they lie, which way they face, and what Slicer is told."""

from __future__ import annotations

import numpy as np
import pytest
from sweeps import rigid
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersCore import vtkFeatureEdges, vtkMassProperties
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

from AIFReconLib.geometry.volume import Volume
from AIFReconLib.io.volume.surfaces import write_labels_surface, write_surface

CENTER = np.array([12.0, -30.0, 55.0])
RADIUS = 9.0


def ball(spacing=(0.8, 0.6, 1.1), mirrored: bool = False) -> Volume:
    """Two halves of a ball, labels 3 and 7, on an oblique grid whose right end cuts it."""
    size = np.array([30, 40, 24])
    placed = rigid((40.0, -50.0, -65.0)) @ np.diag([-spacing[0] if mirrored else spacing[0], *spacing[1:], 1.0])
    placed[:3, 3] = CENTER - placed[:3, :3] @ ((size - 1) / 2)
    k, j, i = np.indices(tuple(size[::-1].tolist()))
    points = np.stack([i, j, k], -1) @ placed[:3, :3].T + placed[:3, 3]
    inside = np.linalg.norm(points - CENTER, axis=-1) < RADIUS
    return Volume((inside * np.where(points[..., 2] > CENTER[2], 7, 3)).astype(np.uint8), placed)


def read(path):
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


@pytest.fixture(scope="module", params=[False, True, None], ids=["right-handed", "left-handed", "one voxel at the edge"])
def surface(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("surface") / "ball.vtp"
    one = Volume(np.pad(np.ones((1, 1, 1), np.uint8), ((0, 2),) * 3), np.eye(4))
    write_labels_surface(one if request.param is None else ball(mirrored=request.param), path)
    return read(path), request.param is None


def test_it_has_no_edge_where_it_ends(surface):
    edges, measured = vtkFeatureEdges(), vtkMassProperties()
    edges.SetInputData(surface[0])
    edges.BoundaryEdgesOn()
    edges.FeatureEdgesOff()
    edges.NonManifoldEdgesOff()
    edges.ManifoldEdgesOff()
    edges.Update()
    assert edges.GetOutput().GetNumberOfCells() == 0
    measured.SetInputData(surface[0])
    assert not surface[1] or 0.05 < measured.GetVolume() < 1.1


def test_points_lie_on_the_ball_in_reference_each_half_has_its_own_label_and_triangles_face_outward(surface):
    surface, is_one = surface
    if is_one:
        return
    points, label = (vtk_to_numpy(data) for data in (surface.GetPoints().GetData(), surface.GetPointData().GetArray("label")))
    above = points[:, 2] - CENTER[2]
    off = (np.linalg.norm(points - CENTER, axis=1) - RADIUS)[np.abs(above) > 2.0]
    assert np.abs(off).max() < 1.0
    assert abs(np.median(off)) < 0.2
    assert (set(label[above > 2.0]), set(label[above < -2.0])) == ({7}, {3})
    corners = vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3)
    a, b, c = (points[corners[:, n]] for n in range(3))
    normals, middles = np.cross(b - a, c - a), (a + b + c) / 3 - CENTER
    outer = np.abs(middles[:, 2]) > 2.0
    assert (np.einsum("ij,ij->i", normals, middles)[outer] > 0).mean() > 0.99


def test_points_without_triangles_are_written_with_their_values(tmp_path):
    points, values = np.arange(12.0).reshape(4, 3), np.array([0.5, np.nan, 1.0, 2.0])
    write_surface(tmp_path / "points.vtp", points, best_cosine=values, frames=np.arange(4))
    read_back = read(tmp_path / "points.vtp")
    np.testing.assert_array_equal(vtk_to_numpy(read_back.GetPoints().GetData()), points)
    np.testing.assert_array_equal(vtk_to_numpy(read_back.GetPointData().GetArray("best_cosine")), values)
    assert read_back.GetNumberOfVerts() == 4
