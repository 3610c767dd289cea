"""Self test of a long scan from the scene's nodes: every update is accounted for, and nothing in the scene grows."""

import threading
import time
from unittest import mock

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel

FRAMES, LOOK_EVERY, DISTURB_EVERY = 400, 100, 40


class AIFReconLiveSoakTest(OpenPanel):
    """A third of a simulated minute: an image below a transform is updated as SlicerOpenIGTLink does it."""

    def setUp(self):
        super().setUp()
        # Each update is waited for until the panel knows of it
        asking = mock.patch("AIFReconScene.live.liveReconstruction.ASK_EVERY", 0.0)
        asking.start()
        self.addCleanup(asking.stop)
        self.updates, self.sequence = 0, tinyScene.makeSequence()
        images = np.zeros((1, *self.sequence.images[0].shape), np.uint8)
        self.imageNode = tinyScene.addVolume("vtkMRMLScalarVolumeNode", "Image", images, np.eye(4))
        self.transformNode = tinyScene.addTransform("ImageToReference", np.eye(4), self.imageNode)
        self.chooseBox()
        self.parameters.spacing = 1.0
        self.follow(None, self.imageNode)
        self.parameters.liveRecord = False
        self.ui.liveStartButton.click()

    scan = property(lambda self: self.live._live)

    def change(self) -> None:
        """Pose, status and pixels of the next frame."""
        place = self.updates % len(self.sequence)
        self.updates += 1
        [pose] = self.sequence.records[place].transforms.values()
        tinyScene.setMatrix(self.transformNode, pose.matrix)
        self.transformNode.SetAttribute("TransformStatus", pose.status.value)
        slicer.util.updateVolumeFromArray(self.imageNode, self.sequence.images[place][None])

    def taken(self) -> int:
        """Updates that the scan knows of."""
        statistics = self.scan.statistics
        return statistics.frames_received + statistics.dropped_images

    def update(self) -> None:
        """One frame, then Slicer's own turn until the panel has taken it."""
        self.change()
        self.waitUntil(lambda: self.taken() >= self.updates)

    def disturb(self, turn: int) -> None:
        """What a user does meanwhile: pauses, empties the volume, deletes what is shown."""
        scan = self.scan
        if turn % 4 == 0:
            self.ui.livePauseButton.checked = True
            self.update()
            self.ui.livePauseButton.checked = False
        elif turn % 4 == 3:
            # Two images before anybody looks: the first is replaced, and counted
            self.change()
        else:
            node = scan._views.frameNode if turn % 4 == 1 else scan.volumeNode
            # Its display node is of no use to anybody else
            for each in (node, node.GetDisplayNode()):
                slicer.mrmlScene.RemoveNode(each)
        self.update()

    def look(self) -> tuple:
        """How many nodes and observers there are, and threads; what was deleted comes back with the images that follow."""
        scan, scene, end = self.scan, slicer.mrmlScene, time.monotonic() + 300.0
        while (scan._views.frameNode is None or scan.volumeNode is None) and time.monotonic() < end:
            self.update()
        nodes = [scene.GetNthNode(number) for number in range(scene.GetNumberOfNodes())]
        observers = sum(str(each).count("vtkObserver (") for each in [scene, *nodes])
        # Insertion has helpers that live for a moment
        threads = []
        for _ in range(5):
            threads.append(threading.active_count())
            time.sleep(0.01)
        return len(nodes), observers, min(threads)

    def test_a_long_scan_leaves_nothing_behind_and_accounts_for_every_image(self):
        looks = []
        for number in range(1, FRAMES + 1):
            self.update()
            if number % DISTURB_EVERY == 0:
                self.disturb(number // DISTURB_EVERY)
            if number % LOOK_EVERY == 0:
                looks.append(self.look())
        live = self.scan
        # What was deleted was made anew, and is shown
        self.assertEqual(self.composite().GetBackgroundVolumeID(), live._views.frameNode.GetID())
        self.assertIs(self.parameters.output, live.volumeNode)
        self.ui.liveStopButton.click()
        statistics = live.statistics
        self.assertEqual(self.updates, statistics.frames_received + statistics.dropped_images)
        self.assertEqual(statistics.frames_received, statistics.inserted + statistics.frames_skipped)
        self.assertGreater(statistics.dropped_images, 0)
        self.assertGreater(statistics.skipped["paused"], 0)
        self.assertEqual(len(set(looks[len(looks) // 2 :])), 1, looks)
