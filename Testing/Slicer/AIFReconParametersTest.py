"""Self tests of the parameters: names, ranges and defaults are the library's, and they come back from a saved scene."""

import unittest

import slicer
import tinyScene


class AIFReconParametersTest(unittest.TestCase):
    """The parameter node beside AIFReconLib.recipe.recipe."""

    def setUp(self):
        slicer.mrmlScene.Clear()
        self.parameters = self.logic().getParameterNode()

    def logic(self):
        """A new logic, of the module as it was loaded last."""
        import AIFRecon

        return AIFRecon.AIFReconLogic()

    def test_untouched_parameters_are_the_library_s_defaults(self):
        from AIFReconScene.inputs.parameters import settingsFrom

        from AIFReconLib.recipe.recipe import DEFAULT_SPACING, ReconstructionSettings

        self.assertEqual(settingsFrom(self.parameters), ReconstructionSettings(spacing=DEFAULT_SPACING, motion="auto"))

    def test_ranges_are_the_library_s(self):
        from AIFReconScene.inputs.parameters import PARAMETERS, SettingChoice, camelCase, rangeOf, settingsFrom

        for name, rule in PARAMETERS.items():
            value = getattr(self.parameters, camelCase(name))
            if isinstance(value, bool | SettingChoice) or rule["default"] is None:
                continue
            lowest = max(rangeOf(name)[0], rule["minimum"])
            for limit, beyond in ((lowest, -1e-3), (rule["maximum"], 1e-3)):
                with self.subTest(name=name, limit=limit):
                    setattr(self.parameters, camelCase(name), limit)
                    self.assertEqual(getattr(settingsFrom(self.parameters), name), limit)
                    if rule["word"] and limit == lowest:
                        continue  # just below the range a number stands for the word
                    with self.assertRaises(ValueError):
                        setattr(self.parameters, camelCase(name), limit + beyond * abs(limit) + beyond * 1e-3)

    def test_choices_are_the_library_s(self):
        from AIFReconScene.inputs.parameters import PARAMETERS, camelCase

        for name, rule in PARAMETERS.items():
            if rule["choices"]:
                with self.subTest(name=name):
                    words = [member.value for member in type(getattr(self.parameters, camelCase(name))) if member.value]
                    self.assertEqual(words, list(rule["choices"]))

    def test_a_number_that_is_left_open_is_left_to_the_library(self):
        from AIFReconScene.inputs.parameters import settingsFrom

        self.parameters.skip, self.parameters.intensityMaximum = 0, 0.0
        settings = settingsFrom(self.parameters)
        self.assertIsNone(settings.skip)
        self.assertIsNone(settings.intensity_maximum)

    def test_a_sweep_and_bone_are_chosen_by_themselves_and_what_is_empty_is_not(self):
        from AIFReconScene.inputs import readiness

        # As Sequences and Segment Editor leave them
        for className in ("vtkMRMLSequenceBrowserNode", "vtkMRMLSegmentationNode"):
            slicer.mrmlScene.AddNewNodeByClass(className)
        readiness.chooseDefaults(self.parameters)
        self.assertEqual((self.parameters.sweep, self.parameters.bone), (None, None))
        tinyScene.addSweep()
        tinyScene.addCT()
        readiness.chooseDefaults(self.parameters)
        self.assertIsNotNone(self.parameters.sweep)
        self.assertIsNotNone(self.parameters.bone)
