"""A simulated patient as nodes, for self tests that need a spine: simulated once in a process, for that takes seconds, and added anew."""

import itertools
from dataclasses import replace
from functools import lru_cache

import numpy as np
import tinyScene
from openPanel import OpenPanel, waitFor

FRAMES = 27
"""Of the sweep: three at each of nine angles."""

MOST_ROUNDS = 300
"""Over the sweep until what must come has come."""


@lru_cache
def simulated(simulate, seed: int, frames: int):
    """A patient, of the classes that this function knows: others after the module was reloaded."""
    return simulate(seed, frames=frames, spacing=1.6)


def patient(seed: int = 0, frames: int = FRAMES):
    """What is simulated."""
    from AIFReconScene.volumes import phantomSample

    return simulated(phantomSample.simulated_patient, seed, frames)


def addPatient(seed: int = 0, frames: int = FRAMES, **changed):
    """The `PhantomNodes` of a patient, added to the scene, with another sweep if that is given."""
    from AIFReconScene.volumes import phantomSample

    return phantomSample.addPatient(replace(patient(seed, frames), **changed))


def wronglyCalibrated(by, sweep=None):
    """A patient's sweep with a calibration that is wrong by a (4, 4) matrix of pixels."""
    from AIFReconLib.sweep.edits import corrected, with_configured_transforms

    return corrected(with_configured_transforms(sweep or patient().sweep), by)


class OpenPatient(OpenPanel):
    """The panel with a simulated patient."""

    frames, spacing = FRAMES, 2.0

    def setUp(self):
        super().setUp()
        self.nodes = addPatient(frames=self.frames)
        self.transform = self.nodes.ctToReference
        self.true = tinyScene.matrixOf(self.transform)
        self.widget.initializeParameterNode()
        self.parameters.spacing = self.spacing

    def error(self, place=None) -> float:
        """Mean distance in mm by which the bone is off a place, else its true one."""
        from AIFReconScene.inputs.boneNodes import labelsFromNode

        labels = labelsFromNode(self.nodes.segmentation, world=False)
        k, j, i = np.nonzero(labels.array)
        points = labels.ijk_to_reference @ np.stack([i, j, k, np.ones_like(i)])[:, :: max(len(i) // 500, 1)].astype(float)
        off = tinyScene.worldOf(self.nodes.segmentation) - (self.true if place is None else place)
        return float(np.linalg.norm((off @ points)[:3], axis=0).mean())

    def start(self):
        """Begin a scan of the sweep; the frame that is shown already would not be a new one."""
        self.show(self.nodes.browser, self.frames - 1)
        self.ui.liveStartButton.click()

    def playUntil(self, condition):
        """Show the sweep again and again: how much of it the last seconds hold depends on how busy this machine is."""
        for start in itertools.islice(itertools.cycle(range(3)), MOST_ROUNDS):
            self.playFrames(self.nodes.browser, range(start, self.frames, 3))
            if waitFor(condition, 0.2):
                return
        self.fail(f"It did not come in {MOST_ROUNDS} rounds: {self.live._live.statistics}")
