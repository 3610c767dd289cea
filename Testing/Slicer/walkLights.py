"""A step of `walkInSlicer.py`: the three lights in all of their colors, and what the views can show beside."""

import numpy as np
import slicer

SLOW_FRAMES = 360
"""Of a sweep from one side, slow enough for a good verdict on tracking."""

OFF = (9.0, 12.0, -8.0)
"""mm by which a CT lies beside its place: 17 in all."""


def lights(walk) -> None:
    """One press in an empty scene, the CT put off its place, a slow sweep from one side: good, caution and poor are all seen."""
    from AIFReconLib.commands.simulate import write_simulated_patient

    slicer.mrmlScene.Clear()
    walk.ui.tabWidget.currentIndex = 0
    walk.settle()
    walk.press(walk.ui.sampleButton)
    judged(walk, "result", tracking="caution", registration="good")
    made = slicer.util.childWidgetVariables(walk.ui.recordedContents)
    made.probeUpCheckBox.checked = made.showLevelsCheckBox.checked = True
    walk.picture("probeUp")
    made.probeUpCheckBox.checked = made.showLevelsCheckBox.checked = False
    mover = walk.parameters.bone.GetParentTransformNode()
    off = slicer.util.arrayFromTransformMatrix(mover)
    off[:3, 3] = np.add(off[:3, 3], OFF)
    slicer.util.updateTransformMatrixFromArray(mover, off)
    walk.settle()
    walk.press(walk.ui.applyButton)
    judged(walk, "wrongCT", registration="poor")
    slicer.mrmlScene.Clear()
    walk.settle()
    files = write_simulated_patient(walk.folder / "slow", path="single-angle", frames=SLOW_FRAMES)
    walk.heart.start()  # the windows were not asked while that was simulated
    walk.open([files.sequence, files.configuration, files.ct, files.labels, files.ct_to_reference])
    walk.settle()
    walk.press(walk.ui.applyButton)
    judged(walk, "thorough", tracking="good", registration="good")


def judged(walk, name: str, **expected: str) -> None:
    """Wait until all lights have been judged, and take a picture; each must say the word that is expected of it."""
    walk.settle()
    walk.wait(lambda: not walk.widget._recorded.lights.isLooking, what="a verdict")
    walk.picture(name)
    for light, word in expected.items():
        said = getattr(walk.ui, f"{light}SignalLabel").text
        if word not in said:
            raise RuntimeError(f"{name}: the light of {light} says {said!r} and not {word!r}")
