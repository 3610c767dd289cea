"""The section Paths: straight lines from the skin that reach a target past bone, and what a line meets while it is dragged."""

import math

import slicer
from AIFReconScene.panelWords import inPanelWords
from AIFReconScene.picture.freePaths import aboutOf, endsOf, placeWithMouse, statesInWords
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError

from ..fields.choosers import TargetChooser
from .layout import enable, say
from .panelPart import PanelPart, every

LOOKED_EVERY = 50
"""ms between two looks where the chosen line lies: the number follows it."""


class PathsPanel(PanelPart):
    """Connects the section to the `FreePaths` of the logic."""

    def __init__(self, ui, work, refresh, paths):
        super().__init__(ui, work, refresh)
        self._paths, self._target = paths, TargetChooser(ui.pathTargetComboBox)
        self._about = self._task = self._asked = self._line = None
        self._notes: list = []
        self._looking = every(LOOKED_EVERY, self._look)
        ui.findPathsButton.connect("clicked(bool)", self.onFind)
        ui.pathsComboBox.connect("activated(int)", self.onLine)
        ui.pathPointSelector.connect("nodeAddedByUser(vtkMRMLNode*)", placeWithMouse)
        self._offer([])

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        super().setParameterNode(parameterNode)
        self._target.setParameterNode(parameterNode)
        if parameterNode is None:
            self._looking.stop()

    def update(self, waits: str) -> None:
        """Enable what can be done, and forget what was found of other inputs; `waits` says why everything has to wait."""
        ui, parameters = self._ui, self._parameterNode
        self._target.update()
        level = self._target.level
        ui.pathsCollapsibleButton.visible = parameters.output is not None
        ui.pathPointLabel.visible = ui.pathPointSelector.visible = level is None
        missing = waits or self._paths.whyNotFind(parameters, level)
        enable(ui.findPathsButton, missing, _("Look for straight lines from the skin that reach the target past all bone that was seen"))
        if self._about is not None:
            self._looking.start()
            self._forgetOld()

    def close(self) -> None:
        """The scene or the panel is being closed."""
        self._forget()
        self._paths.clear()

    # ---- what is done

    def onFind(self) -> None:
        """Look for paths, and show the best."""
        if message := self._do(_("Paths"), _("Paths could not be looked for."), self._find):
            self._say(message)

    def onLine(self, row: int) -> None:
        """Show another line, with the slices along and across it."""
        node = self._paths.lines[row]
        if endsOf(node) is not None:
            self._line, self._asked = node, None
            with slicer.util.RenderBlocker():
                self._paths.choose(node)

    def _find(self, parameters, progress) -> str:
        self._forget()
        self._notes = [inPanelWords(note) for note in self._paths.find(parameters, self._target.level, progress)]
        self._about = aboutOf(parameters, self._target.level)
        self._offer([node.GetName() for node in self._paths.lines])
        if not self._paths.lines:
            return "\n".join([_("No line from the skin reaches the target past bone."), *self._notes])
        self.onLine(0)
        return ""

    # ---- what is shown

    def _look(self) -> None:
        """Have it told what the line meets where it lies now, and say that; of several places the last counts."""
        if self._parameterNode is None or self._work.isRunning or self._forgetOld() or self._line is None:
            return
        if self._task is not None:
            if self._task.is_done:
                self._take()
            return
        ends = endsOf(self._line)
        if ends is not None and ends.tobytes() != self._asked:
            self._asked, self._task = ends.tobytes(), self._paths.along(self._line)

    def _take(self) -> None:
        task, self._task = self._task, None
        try:
            self._say("\n".join([_words(task.result()), *self._notes]))
        except AIFReconError:  # the worker has died
            self._forget()

    def _forgetOld(self) -> bool:
        isOld = self._about is not None and self._about != aboutOf(self._parameterNode, self._target.level)
        if isOld:
            self._forget()
        return isOld

    def _forget(self) -> None:
        self._paths.forget()
        self._about = self._task = self._line = None
        self._looking.stop()
        if self._ui.pathsLabel:  # destroyed: the application is being closed
            self._offer([])

    def _offer(self, names: list) -> None:
        """Let the user choose among lines of these names, and explain the colors of what was found; nothing is said of it yet."""
        ui = self._ui
        ui.pathsComboBox.clear()
        for name in names:
            ui.pathsComboBox.addItem(name)
        ui.pathsComboBox.visible, ui.pathColorsLabel.visible = bool(names), self._about is not None
        say(ui.pathColorsLabel, statesInWords())
        self._say("")

    def _say(self, text: str) -> None:
        self._ui.pathsLabel.visible = bool(text)
        say(self._ui.pathsLabel, text, keepsRoom=True)


def _words(line) -> str:
    """Of a `MetLine`, its clearance, the share that was seen, and its depth."""
    words = (
        _("Blocked by bone: clearance {clearance:.1f} mm, {seen:.0%} seen, {depth:.0f} mm deep."),
        _("Not seen, so it may be blocked: clearance at most {clearance:.1f} mm, {seen:.0%} seen, {depth:.0f} mm deep."),
        _("Tight: clearance {clearance:.1f} mm, {seen:.0%} seen, {depth:.0f} mm deep."),
        _("Free: clearance {clearance:.1f} mm, {seen:.0%} seen, {depth:.0f} mm deep."),
    )
    # All of it is no less than all
    return words[line.state].format(clearance=line.clearance, seen=math.floor(100 * line.seen) / 100, depth=line.depth)
