"""A simulated patient as nodes, for self tests that need a spine: simulated once in a process, for that takes seconds, and added anew."""

from functools import lru_cache

FRAMES = 27
"""Of the sweep: three at each of nine angles."""


@lru_cache
def simulated(simulate, seed: int, frames: int):
    """A patient, of the classes that this function knows: others after the module was reloaded."""
    return simulate(seed, frames=frames, spacing=1.6)


def addPatient(seed: int = 0, frames: int = FRAMES):
    """The `PhantomNodes` of a patient, added to the scene."""
    from AIFReconScene.volumes import phantomSample

    return phantomSample.addPatient(simulated(phantomSample.simulated_patient, seed, frames))
