"""A reconstruction becomes nodes: its volumes, and what is kept beside them for the views."""

import slicer

from ..volumes.volumeNodes import outputNodes
from .spineView import keepSpine


def keptNodes(made, inputs, output, kinds) -> dict:
    """The volume nodes of a reconstruction by kind, the intensities first, with what is kept beside them.

    Parameters
    ----------
    made : Made
    inputs : Inputs
    output : vtkMRMLScalarVolumeNode or None
        Takes the intensities; None: a new node.
    kinds : sequence of str
        Further volumes that are wanted.
    """
    volumes = {"intensity": output}
    with slicer.util.RenderBlocker():
        nodes = outputNodes(made.result, inputs.name, ("intensity", *kinds), volumes, inputs=inputs.nodes(), measured=made.measured)
        keepSpine(nodes["intensity"], made.surface, inputs.name)
    return nodes
