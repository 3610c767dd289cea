"""Pictures of the module for the README and the user guide: the program behind `make screenshots`.

    python Testing/host/screenshots.py [--output FOLDER] [--thumbnail FILE]

The module is used as a user does: the sample data are loaded, its own buttons are pressed and its check boxes set. What is shown comes
from real MRML nodes, drawn by Slicer's own displayable managers, and from real Qt widgets in Qt's Fusion style, all of it offscreen and
not in the Slicer application. Exit status: 0, 1 when the module failed, 2 when pictures cannot be made here.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY / "Testing"), str(REPOSITORY / "Testing" / "Slicer")]
from host import guide_pictures, missing, runHost, view_frames, view_render  # noqa: E402 - the folder must be known first

SPACING, HOLE_LIMIT = 0.7, 2.0
"""mm. Coarser than the default, and without holes: the phantom's sweep has few frames, so that it is made quickly."""

LOOK_AT = (0.0, 52.0, -13.7)
"""RAS mm: where the lamina of a vertebra, its facets and the transverse processes are all cut."""


FRAMES_SEEN = 72
"""Of the replayed sweep, before the box is used and again before the picture: the whole of it."""

PANEL_WIDTH = 400
FIELD_OF_VIEW = 130.0
"""mm, across a slice view."""


class Module:
    """The module in the host, with short ways to what the pictures need."""

    def __init__(self, host):
        import slicer

        self.host = host
        host.start(REPOSITORY / "AIFRecon" / "AIFRecon.py")
        slicer.mrmlScene.Clear()
        self.widget = host.open("AIFRecon")
        self.application = slicer.app.applicationLogic()
        self.check()

    @property
    def parameters(self):
        return self.widget._parameterNode

    def check(self) -> None:
        """Raises what went wrong in a slot, or what a message box said: a picture of a failure is worth nothing."""
        self.host.raise_slot_errors()
        if messages := self.host.dialogs.messages():
            raise RuntimeError(messages[0])

    def press(self, button) -> None:
        if not button.enabled:
            raise RuntimeError(f"{button.text} cannot be pressed: {button.toolTip}")
        button.click()
        self.check()

    def load_sample(self) -> None:
        from AIFReconGui.sampleData import loadPhantomSample

        loadPhantomSample()
        self.check()
        self.widget.initializeParameterNode()
        self.parameters.spacing, self.parameters.holeLimit = SPACING, HOLE_LIMIT

    def slice_view(self, name: str, size, field_of_view: float = FIELD_OF_VIEW, center=LOOK_AT):
        """A slice view under its bar, looking at a place; `center` None: where it looks already."""
        logic = self.application.GetSliceLogicByLayoutName(name)
        node = logic.GetSliceNode()
        with view_render.OffscreenSliceView(logic, self.application, size) as view:
            if center is not None:
                node.JumpSliceByCentering(*center)
            node.SetFieldOfView(field_of_view, field_of_view * size[1] / size[0], 1.0)
            node.SetRulerType(node.RulerTypeThin)
            pixels = view.image()
        return view_frames.framed(pixels, view_frames.slice_title(logic), node.GetLayoutColor(), view_frames.slice_letters(node))

    def view_3d(self, title: str, size, shown, away, distance: float, beside=(0.0, 0.0, 0.0), marked: bool = False):
        """The 3D view under its bar, looking from a direction at the middle of a node, or so far beside it; RAS mm."""
        import slicer

        node = slicer.mrmlScene.GetFirstNodeByClass("vtkMRMLViewNode")
        node.SetBoxVisible(False)
        node.SetAxisLabelsVisible(False)
        if marked:
            node.SetOrientationMarkerType(node.OrientationMarkerTypeAxes)
        bounds = [0.0] * 6
        shown.GetRASBounds(bounds)
        center = np.reshape(bounds, (3, 2)).mean(axis=1) + beside
        with view_render.OffscreenThreeDView(node, self.application, size) as view:
            view.look(center, away, distance)
            return view_frames.framed(view.image(), title, node.GetLayoutColor())


def panel(module: Module, folder: Path) -> None:
    """panel.png: the panel after a reconstruction, when its coverage is told."""
    import time

    while module.widget._recorded.lights.isLooking:
        module.host.process_events()
        time.sleep(0.05)
    view_frames.write_png(module.host.picture(module.widget.parent, PANEL_WIDTH), folder / "panel.png")


def compare(module: Module, folder: Path) -> None:
    """step-7-compare.png: the methods side by side."""
    from AIFReconLib.compounding.methods.table import COMPARED_METHODS

    module.press(module.widget.ui.compareButton)
    views = [module.slice_view(f"AIFRecon{number}", (440, 275), field_of_view=125.0) for number in range(1, len(COMPARED_METHODS) + 1)]
    view_frames.write_png(view_frames.tiled([views[:2], views[2:]]), folder / "step-7-compare.png")
    module.press(module.widget.ui.singleViewButton)


def live(module: Module, folder: Path) -> None:
    """live-panel.png, live.png: the tab Live and the views during a scan, from a server that replays the sweep."""
    import time

    from AIFReconScene.inputs.parameters import Region
    from AIFReconScene.sweep.sequenceReader import sequenceFromBrowser

    from AIFReconLib.live.replay.server import ReplayServer

    parameters, ui = module.parameters, module.widget.ui
    parameters.output, parameters.region = None, Region.AROUND_SWEEP
    with ReplayServer(sequenceFromBrowser(parameters.sweep), 0, rate=10.0, loop=True) as server:
        parameters.liveHost, parameters.livePort = "127.0.0.1", server.port
        module.press(ui.liveStartButton)

        def wait(condition) -> None:
            end = time.monotonic() + 60.0
            while not condition():
                if time.monotonic() > end:
                    raise RuntimeError(f"nothing came of it: {ui.liveStatisticsLabel.text}")
                module.host.process_events()
                module.check()
                time.sleep(0.01)

        scan = module.widget._live._live
        wait(lambda: scan.seen.scouted >= FRAMES_SEEN)
        wait(lambda: ui.liveUseBoxButton.enabled)
        module.press(ui.liveUseBoxButton)
        wait(lambda: scan.statistics.inserted > FRAMES_SEEN and scan.statistics.waiting == 0 and parameters.output is not None)
        wait(lambda: ui.liveStateLabel.text == "Probe seen")
        view_frames.write_png(module.host.picture(module.widget.parent, PANEL_WIDTH), folder / "live-panel.png")
        size = (330, 330)
        views = [module.slice_view("Red", size, center=None, field_of_view=110.0)]
        views += [module.slice_view(name, size) for name in ("Yellow", "Green")]
        view_frames.write_png(view_frames.tiled([views]), folder / "live.png")
        guide_pictures.live(module, views[:1], folder)
        module.press(ui.liveStopButton)
    ui.tabWidget.currentIndex = 0


def thumbnail(module: Module, path: Path) -> None:
    """The picture of the phantom in the Sample Data module, 260 x 280: its CT above, a frame of its sweep below."""
    from AIFReconScene.display.sliceDisplay import lieIn
    from PySide6 import QtGui

    logic, parameters = module.application.GetSliceLogicByLayoutName("Red"), module.parameters
    node, composite = logic.GetSliceNode(), logic.GetSliceCompositeNode()
    image = parameters.sweep.GetProxyNode(parameters.sweep.GetMasterSequenceNode())
    composite.SetBackgroundVolumeID(parameters.ctVolume.GetID())
    composite.SetForegroundVolumeID(image.GetID())
    composite.SetForegroundOpacity(0.8)
    lieIn(node, image)
    with view_render.OffscreenSliceView(logic, module.application, (260, 280)) as view:
        node.SetFieldOfView(125.0, 125.0 * 280 / 260, 1.0)
        node.SetRulerType(node.RulerTypeNone)
        pixels = view.image()
    view_frames.write_png(QtGui.QImage(pixels.data, 260, 280, 3 * 260, QtGui.QImage.Format.Format_RGB888), path)


def main(arguments=None) -> int:
    """Makes the pictures; returns the exit status."""
    parser = argparse.ArgumentParser(description="Make the pictures of the module that the README shows.")
    parser.add_argument("--output", type=Path, default=REPOSITORY / "Resources" / "Screenshots", help="folder of the pictures")
    parser.add_argument(
        "--thumbnail",
        type=Path,
        default=REPOSITORY / "AIFRecon" / "Resources" / "Icons" / "AIFReconLumbarPhantom.png",
        help="picture of the sample data",
    )
    options = parser.parse_args(arguments)
    if reason := missing() or view_render.why_no_views():
        print(f"Pictures cannot be made here: {reason}.", file=sys.stderr)
        return 2
    host = runHost()
    try:
        options.output.mkdir(parents=True, exist_ok=True)
        module = Module(host)
        guide = guide_pictures
        guide.empty(module, options.output)
        module.load_sample()
        made = (guide.imported, guide.registration, guide.guidance, guide.settings, guide.progress, panel, guide.result, compare, live)
        for make in made:
            make(module, options.output)
            print(make.__doc__)
        thumbnail(module, options.thumbnail)
        print(f"{options.thumbnail.name}: the sample data's picture.")
    except Exception as error:
        print(f"The pictures could not be made: {type(error).__name__}: {error}", file=sys.stderr)
        return 1
    finally:
        host.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
