"""Self tests of the box to reconstruct in, made by "Create new" in the panel."""

import numpy as np
import slicer
import tinyScene
from openPanel import OpenPanel


class AIFReconBoxTest(OpenPanel):
    """A box that the user has asked for and not drawn."""

    def setUp(self):
        super().setUp()
        from AIFReconScene.inputs.parameters import Region

        self.parameters.spacing = 1.0
        self.parameters.region = Region.BOX

    def create(self):
        """What "Create new" of the box's list does; the box."""
        self.ui.roiSelector.addNode()
        return self.parameters.roi

    def test_a_new_box_holds_what_a_reconstruction_around_the_sweep_holds(self):
        from AIFReconScene.inputs.parameters import Region

        self.parameters.sweep = tinyScene.addSweep()
        box = self.create()
        self.ui.applyButton.click()
        within = self.parameters.output
        self.parameters.region, self.parameters.output = Region.AROUND_SWEEP, None
        self.ui.applyButton.click()
        around = self.parameters.output
        np.testing.assert_allclose(tinyScene.boundsOf(box), tinyScene.boundsOf(around), atol=1.0)
        self.assertTrue(slicer.util.arrayFromVolume(within).any())
        sizes = np.array([within.GetImageData().GetDimensions(), around.GetImageData().GetDimensions()])
        self.assertLessEqual(np.abs(np.diff(sizes, axis=0)).max(), 1)

    def test_a_new_box_lies_around_the_ct_where_no_sweep_is_chosen(self):
        self.parameters.ctVolume, _bone, _registration = tinyScene.addCT()
        np.testing.assert_allclose(tinyScene.boundsOf(self.create()), tinyScene.boundsOf(self.parameters.ctVolume), atol=1e-3)

    def test_a_box_that_has_waited_for_a_sweep_is_laid_around_it(self):
        from AIFReconScene.inputs.boxes import isEmpty

        box = self.create()
        self.assertTrue(isEmpty(box))
        self.parameters.sweep = tinyScene.addSweep()
        self.assertFalse(isEmpty(box))
        self.assertTrue(self.ui.applyButton.enabled, self.ui.applyButton.toolTip)

    def test_a_box_without_a_size_cannot_be_reconstructed_in_until_it_is_drawn(self):
        box = self.create()
        self.assertFalse(self.ui.liveStartButton.enabled)
        self.assertIn(box.GetName(), self.ui.liveStartButton.toolTip)
        box.SetCenterWorld(0.0, 16.0, 0.0)
        box.SetSize(40.0, 40.0, 30.0)
        self.assertTrue(self.ui.liveStartButton.enabled, self.ui.liveStartButton.toolTip)
