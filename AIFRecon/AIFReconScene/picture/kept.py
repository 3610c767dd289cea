"""A reconstruction becomes nodes: its volumes, and what is kept beside them for the views."""

from ..volumes.volumeNodes import outputNodes
from .spineView import keepSpine


def keptNodes(result, beside, inputs, output, kinds) -> dict:
    """The volume nodes of a `Reconstruction` by kind, the intensities first, with what a `Beside` holds.

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
    nodes = outputNodes(result, inputs.name, ("intensity", *kinds), volumes, inputs=inputs.nodes(), measured=beside.measured)
    keepSpine(nodes["intensity"], beside.shown, inputs.name)
    return nodes
