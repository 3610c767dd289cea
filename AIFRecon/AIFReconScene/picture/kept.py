"""A reconstruction becomes nodes: its volumes, and what is kept beside them for the views."""

from dataclasses import dataclass
from typing import Any

import slicer

from AIFReconLib.errors import AIFReconError, OperationCanceled
from AIFReconLib.progress import part

from ..background import inBackground
from ..inputs.parameters import needsBone
from ..volumes.volumeNodes import outputNodes
from .spineSurface import spineSurface
from .spineView import keepSpine


@dataclass(frozen=True)
class Beside:
    """What is kept beside a reconstruction for the views.

    Parameters
    ----------
    measured : Volume or None
        Its plain echo.
    surface : vtkPolyData or None
        Of the bone that it shows.
    problem : Message or None
        Why there is none of them.
    """

    measured: Any = None
    surface: Any = None
    problem: Any = None


def besideOf(prepared, settings, result, progress=None) -> Beside:
    """What is kept of a `Reconstruction` that was made of these `PreparedInputs`; nothing of a method that does not weight by bone."""
    if not needsBone(result.method):
        return Beside()
    try:
        measured = prepared.measured(settings, result, part(progress, 0.0, 0.6))
        shown = prepared.shown(result, part(progress, 0.6, 0.9))
        surface = None if shown is None else inBackground(lambda _progress: spineSurface(shown), part(progress, 0.9, 1.0))
        return Beside(measured, surface)
    except OperationCanceled:
        raise
    except AIFReconError as error:
        return Beside(problem=f"The plain echo and the bone in 3D were not made. {error}")


def keptNodes(result, beside: Beside, inputs, output, kinds) -> dict:
    """The volume nodes of a `Reconstruction` by kind, the intensities first, with what is kept beside them.

    Parameters
    ----------
    result : Reconstruction
    beside : Beside
    inputs : Inputs
    output : vtkMRMLScalarVolumeNode or None
        Takes the intensities; None: a new node.
    kinds : sequence of str
        Further volumes that are wanted.
    """
    volumes = {"intensity": output}
    with slicer.util.RenderBlocker():
        nodes = outputNodes(result, inputs.name, ("intensity", *kinds), volumes, inputs=inputs.nodes(), measured=beside.measured)
        keepSpine(nodes["intensity"], beside.surface, inputs.name)
    return nodes
