"""Guidance in the panel: bone in colors, what was met of each segment, and in large type where the probe must go next."""

from html import escape

import slicer
from AIFReconScene.display import threeDViews
from AIFReconScene.display.boneColors import BoneColors, colorsInWords
from AIFReconScene.display.ghostProbe import GhostProbe
from AIFReconScene.inputs import readiness
from AIFReconScene.inputs.boneNodes import boneNames, inNames
from AIFReconScene.panelWords import inPanelWords
from AIFReconScene.transforms import placeOf
from slicer.i18n import tr as _

from .layout import say
from .panelPart import PanelPart, every

SHOWN_EVERY = 150
"""ms between two looks at what the scan has met: colors change five times a second and more."""


class GuidancePanel(PanelPart):
    """Connects the box *Guidance* and what stands below it to the scan under way, or to the chosen sweeps."""

    def __init__(self, ui, work, refresh, live, logic):
        super().__init__(ui, work, refresh)
        self._live, self._logic = live, logic
        self._colors, self._ghost = BoneColors(), GhostProbe()
        self._shown = self._about = None
        self._told = "", ""
        self._isTurned = False
        self._showing = every(SHOWN_EVERY, self._showScan)
        ui.guidanceTableLabel.toolTip = _(
            "Shares of the bone that faces the back, as the light “Coverage” tells them. The next move leads to where most bone is to be "
            "gained, which need not be the vertebra of the lowest share."
        )
        ui.guidanceCheckBox.connect("clicked(bool)", self.onBox)
        ui.liveGuidanceCheckBox.connect("clicked(bool)", self.onLiveBox)
        ui.guidanceSweepButton.connect("clicked(bool)", self.onSweep)

    def update(self) -> None:
        """Follow the box and what is chosen."""
        parameters, scanning = self._parameterNode, self._live.isRunning
        whyNot = readiness.whyNoImages if parameters.bone is None else readiness.whyNotRegister
        missing = self._live.whyNotNow() or whyNot(parameters, self._logic.sweep.summary(parameters))
        button = self._ui.guidanceSweepButton
        button.enabled = parameters.guidance and not missing
        button.toolTip = missing or _("Color the bone by what the chosen sweep has hit, and say where to scan next")
        if scanning != self._showing.isActive():
            (self._showing.start if scanning else self._showing.stop)()
            if not scanning:
                # No order to move the probe outlasts the scan
                self._clearMove()
                self._say("")
        if scanning and (self._live.guidance is not None) != parameters.guidance:
            self._live.guide(parameters.guidance)
        self._ui.guidanceWords.visible = self._ui.liveGuidanceCheckBox.checked = parameters.guidance
        if not parameters.guidance or self._isOld(parameters):
            self.forget()
        elif not scanning and self._colors.node is None:
            # A scene that was saved with its bone in colors is loaded without them: segments come back in their place
            self._colors.clear()
        if parameters.guidance and not scanning and self._shown is None:
            self._say(missing or _("Press “Update colors” to color the bone by what the chosen sweep has hit, or start a scan."))

    def forget(self) -> None:
        """Take everything out of the scene and the views, and the words with it."""
        self._shown = self._about = None
        self._isTurned = False
        self._say("")
        if self._ui.guidanceTableLabel:  # destroyed: the application is being closed
            self._ui.guidanceTableLabel.text = ""
        with slicer.util.RenderBlocker():
            self._clearMove()
            self._colors.clear()
        self._explain()

    def close(self) -> None:
        """The scene or the panel is being closed."""
        self._showing.stop()
        self.forget()

    # ---- buttons

    def onLiveBox(self, wanted: bool) -> None:
        """The user has set or taken the box of the tab Live, which stands for the same."""
        if self._parameterNode is not None:
            self._parameterNode.guidance = wanted

    def onBox(self, wanted: bool) -> None:
        """The user has set or taken the box: where no scan is under way, the chosen sweep is told at once."""
        if wanted and self._ui.guidanceSweepButton.enabled:
            self.onSweep()

    def onSweep(self) -> None:
        """Color the bone by what the chosen sweeps have met."""
        if message := self._do(_("Guidance"), _("What the sweep has hit could not be told."), self._ofSweep):
            self._say(message)

    def _ofSweep(self, parameters, progress) -> str:
        seen = self._logic.verdicts.guide(parameters, progress, self._logic.paths.unseen)
        self._about = self._subject(parameters, ofScan=False)
        self._show(seen, parameters.bone)
        return ""

    # ---- what is shown

    def _subject(self, parameters, ofScan: bool) -> tuple:
        """What is shown is about: it is forgotten when another is chosen."""
        chosen = (parameters.bone, *(() if ofScan else (parameters.sweep, *parameters.otherSweeps)))
        place = () if ofScan or parameters.bone is None else tuple(placeOf(parameters.bone).ravel().round(6))
        return (ofScan, place, tuple(parameters.boneSegments), *(node.GetID() if node is not None else "" for node in chosen))

    def _isOld(self, parameters) -> bool:
        """Whether what is shown is of something else than what is chosen now; a scan follows its bone by itself."""
        if self._about is None or self._live.isRunning:
            return self._about is not None and not self._about[0]
        return self._about != self._subject(parameters, self._about[0])

    def _showScan(self) -> None:
        live, parameters = self._live.guidance, self._parameterNode
        if live is None or self._work.isRunning:
            return
        seen = live.state
        if seen is not self._shown and (seen.problem is not None or seen.surface is not None):
            self._about = self._about if parameters is None else self._subject(parameters, ofScan=True)
            self._show(seen, live.bone)

    def _show(self, seen, bone) -> None:
        """Show a `GuidanceSnapshot` of this node."""
        self._shown = seen
        bone = bone if bone is not None and bone.GetScene() is not None else None
        chosen = None if self._parameterNode is None else list(self._parameterNode.boneSegments)
        names = {} if bone is None else boneNames(bone, chosen)
        with slicer.util.RenderBlocker():
            if seen.mesh is None:
                self._colors.clear()
            else:
                self._colors.show(bone, seen.mesh, seen.levels)
            if seen.problem is not None or seen.all is None:
                self._clearMove()
                self._ui.guidanceTableLabel.text = ""
                self._say(inPanelWords(seen.problem) if seen.problem is not None else _("Scan the bone."))
            else:
                self._ui.guidanceTableLabel.text = _table(seen, names)
                self._showMove(seen, names)
                self._turn(seen.patient_to_reference)
        self._explain()

    def _explain(self) -> None:
        """Say what the colors stand for, while bone is drawn in them."""
        words = "" if self._colors.node is None else colorsInWords()
        for label in (self._ui.guidanceColorsLabel, self._ui.liveColorsLabel):
            if label and label.text != words:
                label.visible = bool(words)
                say(label, words)

    def _turn(self, patientToWorld) -> None:
        """The first time, look at the bone as the probe does, from the back: the side that takes on color."""
        if not self._isTurned and self._colors.node is not None:
            self._isTurned = True
            threeDViews.lookAlong(patientToWorld[:3, 1], patientToWorld[:3, 2], self._colors.node)

    def _showMove(self, seen, names) -> None:
        move = seen.move
        if move is None:
            self._clearMove()
            self._say(
                _("Enough is scanned: no further move would add much.")
                if seen.is_advised
                else _("Looking for the next move: keep scanning.")
            )
            return
        self._ghost.show(move.image_to_reference, move.probe)
        first, *then = move.directions
        self._large(first.arrow, first.words)
        # Beside a scan the first step stands in large letters; of what was recorded the list is all there is
        listed = move.directions if self._about is not None and not self._about[0] else then
        isOfBone = move.adds_cm2 is not None
        words = _("over {where}; shows {adds:.1f} cm² more bone") if isOfBone else _("over {where}; looks where paths were not seen")
        adds = words.format(where=inNames(move.over, names) or _("the bone"), adds=move.adds_cm2)
        self._say("\n".join([*(f"{step.arrow}  {step.words}" for step in listed), adds]))

    def _clearMove(self) -> None:
        self._ghost.clear()
        self._large("", "")

    def _large(self, arrow: str, words: str) -> None:
        if (arrow, words) == self._told:
            return
        self._told = arrow, words
        # No letters of VTK's are arrows
        threeDViews.say(words)
        self._live.advise(f"{arrow}  {words}".strip())

    def _say(self, text: str) -> None:
        label = self._ui.guidanceLabel
        if label and label.text != text:
            say(label, text, keepsRoom=True)


def _table(seen, names: dict) -> str:
    """A line for each segment, as HTML: what was hit, what of it squarely, and what is expected to show."""
    known = {str(label): name for label, name in names.items()}
    rows = [(known.get(label) or _("Label {number}").format(number=label), share) for label, share in seen.by_label.items()]
    if seen.interspinous.reachable_cm2:
        rows.append((_("Edges of interspinous spaces"), seen.interspinous))
    rows.append((_("All bone"), seen.all))
    heads = (_("Bone"), _("hit"), _("squarely"), _("expected to show"))
    lines = ["".join(f"<th align='{_side(n)}'>{escape(head)}</th>" for n, head in enumerate(heads))]
    for name, share in rows:
        cells = (escape(name), *map(_percent, (share.met, share.below_45_deg, share.expected_visibility)))
        lines.append("".join(f"<td align='{_side(n)}'>{cell}</td>" for n, cell in enumerate(cells)))
    return f"<table width='100%' cellspacing='0' cellpadding='4'>{''.join(f'<tr>{line}</tr>' for line in lines)}</table>"


def _side(column: int) -> str:
    return "right" if column else "left"


def _percent(share: float) -> str:
    return "-" if share != share else f"{share:.0%}"
