"""A live scan from nodes that somebody keeps up to date, for as long as asked, and what the scene and the process hold meanwhile."""

import gc
import sys
import threading
import time
from dataclasses import dataclass

import numpy as np
import slicer
import tinyScene

LOOK_EVERY = 100
"""Frames between two looks."""

PATIENCE = 300.0


@dataclass(frozen=True)
class Look:
    """What there is after so many frames."""

    frames: int
    nodes: int
    observers: int
    threads: int
    blocks: int


class SceneSoak:
    """Updates an image node and its transform as SlicerOpenIGTLink does, with all that happens during a long scan.

    Parameters
    ----------
    live : LivePanel
        With a scan of `imageNode` under way.
    imageNode : vtkMRMLScalarVolumeNode
    transformNode : vtkMRMLLinearTransformNode
        Above the image.
    """

    def __init__(self, live, imageNode, transformNode):
        self.live, self.imageNode, self.transformNode = live, imageNode, transformNode
        self.updates = 0
        self._sequence = tinyScene.makeSequence()
        self._poses = [next(iter(record.transforms.values())).matrix for record in self._sequence.records]

    def run(self, frames: int, report=lambda look: None) -> list:
        """Update so many times; the answer is what was there every `LOOK_EVERY` frames."""
        looks = []
        for number in range(1, frames + 1):
            self.update()
            if number % 40 == 0:
                self.disturb(number // 40)
            if number % LOOK_EVERY == 0:
                looks.append(self.look(number))
                report(looks[-1])
        return looks

    def update(self) -> None:
        """One frame: pose, status and pixels, then Slicer's own turn until the panel has taken it."""
        place = self.updates % len(self._poses)
        self.updates += 1
        self.transformNode.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(self._poses[place]))
        self.transformNode.SetAttribute("TransformStatus", "OUT_OF_VIEW" if place == tinyScene.UNTRACKED else "OK")
        slicer.util.updateVolumeFromArray(self.imageNode, self._sequence.images[place][None])
        self.wait(lambda: self._taken() >= self.updates)

    def _taken(self) -> int:
        statistics = self.live._live.statistics
        return statistics.frames_received + statistics.dropped_images

    def disturb(self, turn: int) -> None:
        """What a user does meanwhile: pauses, empties the volume, deletes what is shown."""
        live = self.live._live
        kind = turn % 4
        if kind == 0:
            live.pause(True)
            self.update()
            live.pause(False)
        elif kind == 1 and live._views.frameNode is not None:
            self._delete(live._views.frameNode)
            self.update()
        elif kind == 2 and live.volumeNode is not None:
            self._delete(live.volumeNode)
            self.update()
        elif kind == 3:
            # Two images before anybody looks: the first is replaced, and counted
            slicer.util.updateVolumeFromArray(self.imageNode, self._sequence.images[0][None])
            self.updates += 1
            self.update()

    @staticmethod
    def _delete(node) -> None:
        """With its display node, which is of no use to anybody else."""
        display = node.GetDisplayNode()
        for each in (node, display):
            slicer.mrmlScene.RemoveNode(each)

    def look(self, frames: int) -> Look:
        """What the scene and this process hold, once nothing is under way."""
        live = self.live._live

        def shown() -> bool:
            return live._views.frameNode is not None and live.volumeNode is not None

        # What was deleted comes back with the images that follow
        end = time.monotonic() + PATIENCE
        while not shown() and time.monotonic() < end:
            self.update()
        self.wait(lambda: shown())
        gc.collect()
        scene = slicer.mrmlScene
        nodes = [scene.GetNthNode(number) for number in range(scene.GetNumberOfNodes())]
        observers = sum(str(each).count("vtkObserver (") for each in [scene, *nodes])
        return Look(frames, len(nodes), observers, self._threads(), sys.getallocatedblocks())

    @staticmethod
    def _threads() -> int:
        """Threads that stay; insertion has helpers that live for a moment."""
        counts = []
        for _ in range(5):
            counts.append(threading.active_count())
            time.sleep(0.01)
        return min(counts)

    def wait(self, condition) -> None:
        """Let Qt work until it holds."""
        end = time.monotonic() + PATIENCE
        while not condition():
            if time.monotonic() > end:
                raise AssertionError(f"it never came: {self.live._live.statistics}")
            slicer.app.processEvents()
            time.sleep(0.001)


def begin(widget, spacing: float = 1.0) -> SceneSoak:
    """An image below a transform in the scene, and a scan of it in a box, started in the panel."""
    from AIFReconScene.inputs.parameters import LiveSource, Region

    parameters = widget._parameterNode
    parameters.spacing = spacing
    columns, rows = tinyScene.FRAME_SIZE
    imageNode = tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Image", np.zeros((1, rows, columns), np.uint8), np.eye(4))
    transformNode = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLLinearTransformNode", "ImageToReference")
    imageNode.SetAndObserveTransformNodeID(transformNode.GetID())
    roi = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLMarkupsROINode", "Box")
    roi.SetCenterWorld(0.0, 16.0, 0.0)
    roi.SetSize(40.0, 40.0, 30.0)
    parameters.roi, parameters.region = roi, Region.BOX
    parameters.liveSource, parameters.liveImage = LiveSource.SCENE, imageNode
    parameters.liveRecord = False
    widget.ui.liveStartButton.click()
    return SceneSoak(widget._live, imageNode, transformNode)
