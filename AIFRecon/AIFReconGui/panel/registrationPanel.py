"""What belongs to the light Registration: places the CT on the sweep, says how well the two agree, and draws the echoes on the bone."""

import numpy as np
import slicer
from AIFReconScene.display.echoPoints import EchoPoints
from AIFReconScene.inputs import readiness
from AIFReconScene.inputs.boneNodes import boneNames
from AIFReconScene.panelWords import inPanelWords, withNames
from AIFReconScene.registration.ctRegistration import CTRegistration, rigidPlace
from AIFReconScene.registration.moves import Moves, placing, transformAbove
from AIFReconScene.volumes.segments import bentBone
from slicer.i18n import tr as _

from AIFReconLib.errors import AIFReconError
from AIFReconLib.progress import part

from ..longWork import errorsShown
from .layout import enable, say
from .panelPart import PanelPart, every

WORTH_OFFERING = 0.5
"""Share of what the best place explains that makes another one worth a line in the choice."""

LOOKED_EVERY = 100
"""ms between two looks where the CT is: gauge and colors follow it once it rests."""


class RegistrationPanel(PanelPart):
    """Connects the widgets below the light to a `CTRegistration` and its `Moves`.

    Gauge and colors are those of the place where the CT is now, once they were asked for: they follow it when it is moved. While the tab
    Live scans, what the scan has shown so far takes the place of the chosen sweep.
    """

    def __init__(self, ui, work, refresh, live, logic):
        super().__init__(ui, work, refresh)
        self._live, self._logic = live, logic
        self._registration, self._moves, self._echoes = CTRegistration(), Moves(), EchoPoints()
        self._placed = self._about = self._task = self._seenAt = self._knownAt = self._unbent = None
        self._saidBefore = ""
        self._places = []
        self._looking = every(LOOKED_EVERY, self._look)
        ui.checkButton.connect("clicked(bool)", self.onCheck)
        ui.placeButton.connect("clicked(bool)", self.onPlace)
        ui.livePlaceButton.connect("clicked(bool)", self.onPlace)
        ui.undoPlaceButton.connect("clicked(bool)", self.onUndo)
        ui.takePlaceButton.connect("clicked(bool)", self.onTake)
        ui.landmarksButton.connect("clicked(bool)", self.onLandmarks)
        ui.landmarksButton.visible = hasattr(slicer.modules, "landmarkregistration")
        self._say("")
        self._offer([])

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        super().setParameterNode(parameterNode)
        (self._looking.stop if parameterNode is None else self._looking.start)()

    def update(self) -> None:
        """Enable what can be done; follow what is chosen."""
        ui, parameters = self._ui, self._parameterNode
        missing = readiness.whyNotRegister(parameters, self._logic.sweep.summary(parameters), self._live.isRunning)
        waits = self._live.whyNotNow()
        if self._about is not None and self._about != self._subject(parameters):
            self.forget()
        places = _(
            "Move CT and bone together so that the bone lies on its echoes; the CT itself stays as it is, and the move can be undone"
        )
        enable(ui.checkButton, waits or missing, _("Say how well CT and sweep agree; nothing is moved"))
        enable(ui.placeButton, missing, places)
        ui.livePlaceButton.enabled = self._live.isRunning and not missing
        ui.livePlaceButton.toolTip = missing or _("Move the CT onto the bone that this scan has shown so far")
        ui.undoPlaceButton.enabled = self._moves.canUndo
        self._echoes.setVisible(parameters.showEchoes)
        self._tellAgreement(parameters)

    def _tellAgreement(self, parameters) -> None:
        """The number by which the light is judged, be it of a place or of what was reconstructed; words about another one go."""
        verdicts, placed = self._logic.verdicts, None if self._placed is None else self._placed.agreement
        if parameters.sweep is None:
            self._gauge(placed, self._names())
            return
        isKnown = verdicts.of(parameters)["registration"].level.value != "unknown"
        self._gauge(verdicts.agreement if isKnown else None, self._names())
        if isKnown and placed is not None and verdicts.agreement is not None and verdicts.agreement is not placed:
            self._say("")

    def forget(self) -> None:
        """Take the echoes out of the scene, and the words with them."""
        self._placed = self._about = self._task = None
        self._echoes.clear()
        if not self._ui.registrationLabel:  # destroyed: the application is being closed
            return
        self._say("")
        self._offer([])

    def close(self) -> None:
        """The scene or the panel is being closed."""
        self.forget()
        self._registration.forget()
        self._moves = Moves()

    # ---- buttons

    def onCheck(self) -> None:
        """Say how well CT and sweep agree."""
        self._run(_("Checking the CT's place"), _("CT and sweep could not be compared."), self._check)

    def onPlace(self) -> None:
        """Move the CT to where it belongs."""
        self._run(_("Placing the CT"), _("The CT could not be placed. It is where it was."), self._place)

    def onTake(self) -> None:
        """Move the CT to the place that the user has chosen."""
        number = self._ui.alternativesComboBox.currentIndex
        if 0 <= number < len(self._places):
            with errorsShown(_("The CT could not be placed. It is where it was.")):
                self._moveTo(self._parameterNode, self._registration.at(self._places[number]))
                self._say(self._words(_("Placed there because you chose it.")))
                self._offer([])
        self._refresh()

    def onUndo(self) -> None:
        """Bring the CT back to where it was before it was moved last."""
        if self._moves.undo():
            if self._unbent is not None:
                self._parameterNode.bone, bent = self._unbent
                slicer.mrmlScene.RemoveNode(bent)
                self._unbent = None
            self._saidBefore = _("The CT is back where it was.")
            self._offer([])
            self._say(self._saidBefore)
        self._refresh()

    def onLandmarks(self) -> None:
        """Open Slicer's own registration by landmarks."""
        slicer.util.selectModule("LandmarkRegistration")

    # ---- work

    def _run(self, title: str, failure: str, work) -> None:
        if message := self._do(title, failure, work):
            self._say(message)

    def _check(self, parameters, progress) -> str:
        self._show(parameters, self._registration.check(parameters, progress))
        self._offer([])
        return self._words()

    def _place(self, parameters, progress) -> str:
        ct, bone, sweep = parameters.ctVolume, parameters.bone, parameters.sweep
        transformAbove(bone, ct, sweep)  # what cannot be moved is said before any work
        scan = self._live.isRunning
        echoes = self._live.echoes() if scan else None
        found, self._unbent = self._registration.register(parameters, part(progress, 0.0, 0.7 if scan else 1.0), echoes), None
        if found.reason is not None:
            self._show(parameters, self._registration.at(rigidPlace(bone)))
            self._offer(_places(found))
            reason = withNames(inPanelWords(found.reason), self._names())
            refused = _("The CT was not moved. About the best place found: {reason}").format(reason=reason)
            return self._words(refused, verdict=False)
        moved = "" if found.moved is None else _("Moved by {mm:.1f} mm.").format(mm=found.moved)
        names = self._names()
        uncertain = "; ".join(found.uncertain)
        self._moveTo(parameters, found.placed, uncertain if found.moved is None else "")
        if found.apart is not None:
            parameters.bone, parameters.boneSegments = bentBone(bone, found.apart, names), []
            self._unbent = bone, parameters.bone
            self._show(parameters, self._registration.check(parameters, echoes=echoes))
        self._offer([])
        loose = _("This sweep does not tell exactly: {motions}.").format(motions=uncertain) if uncertain else ""
        message = self._words(moved, loose)
        if not scan:
            return message
        # The CT is moved by now: a cancel would come too late
        followed = self._live.followBone(lambda share, message: progress(0.7 + 0.3 * share, message) or True)
        return "\n".join(line for line in (message, followed) if line)

    def _moveTo(self, parameters, placed, guessed: str = "") -> None:
        with slicer.util.RenderBlocker():
            self._moves.do(placing(parameters.bone, parameters.ctVolume, parameters.sweep, placed.labels_to_reference))
            self._show(parameters, placed, guessed)

    # ---- what is shown

    def _subject(self, parameters) -> tuple:
        """What gauge and colors are about: they are forgotten when another is chosen."""
        chosen = (parameters.sweep if not self._live.isRunning else None, parameters.bone)
        return (*(node.GetID() if node is not None else "" for node in chosen), tuple(parameters.boneSegments))

    def _show(self, parameters, placed, guessed: str = "") -> None:
        self._placed, self._about, self._task, self._knownAt = placed, self._subject(parameters), None, None
        if parameters.sweep is not None:
            self._logic.verdicts.takeAgreement(parameters, placed.agreement, guessed)
        self._echoes.show(placed.points, placed.distances, parameters.showEchoes)

    def _look(self) -> None:
        """Follow a CT that was moved by whatever means and rests now: have its agreement told anew, and show it when it is told."""
        if self._parameterNode is None or self._work.isRunning:
            return
        if self._task is not None:
            self._takeJudged()
            return
        place = self._placeNow()
        at, before = None if place is None else place.tobytes(), self._seenAt
        self._seenAt = at
        if at != before or at == self._knownAt:
            return
        self._knownAt = at
        if self._placed is not None and place is None:
            self.forget()
        if self._placed is None:
            self._refresh()
        elif not np.allclose(place, self._placed.labels_to_reference, rtol=0.0, atol=1e-6):
            self._task = self._registration.beginAt(place)

    def _takeJudged(self) -> None:
        if not self._task.is_done:
            return
        task, message, self._saidBefore = self._task, self._saidBefore, ""
        try:
            self._show(self._parameterNode, task.result())
            self._say("\n".join(line for line in (message, self._words()) if line))
        except AIFReconError:  # the worker has died
            self.forget()
        self._refresh()

    def _placeNow(self):
        """Where the CT's bone is, (4, 4); None where there is none, or its place cannot be used."""
        try:
            return None if self._parameterNode.bone is None else rigidPlace(self._parameterNode.bone)
        except AIFReconError:
            return None

    def _words(self, *more: str, verdict: bool = True) -> str:
        agreement = self._placed.agreement
        lines = [agreement.sentence(), agreement.warning(self._names()) or ""] if verdict else []
        return "\n".join(line for line in (*lines, *more) if line)

    def _names(self) -> dict:
        parameters = self._parameterNode
        return {} if parameters is None or parameters.bone is None else boneNames(parameters.bone, list(parameters.boneSegments))

    def _say(self, text: str) -> None:
        self._ui.registrationLabel.visible = bool(text)
        say(self._ui.registrationLabel, text)

    def _gauge(self, agreement, names=None) -> None:
        bar = self._ui.agreementProgressBar
        bar.value = 0 if agreement is None else round(100 * agreement.share)
        bar.format = "" if agreement is None else _("{share:.0%} of the echoes agree").format(share=agreement.share)
        labels = {} if agreement is None else agreement.per_label
        lines = [
            _("Label {number} {name}: {share:.0%} of its echoes agree").format(
                number=label, name=(names or {}).get(label, ""), share=own.agreement
            )
            for label, own in sorted(labels.items())
        ]
        bar.toolTip = "\n".join(lines) or _("How many of the bone echoes lie on bone of the CT that their beams could reach")

    def _offer(self, places: list) -> None:
        """Let the user choose among places, each with its words; none hides the choice."""
        ui = self._ui
        self._places = [place for place, _words in places]
        ui.alternativesComboBox.clear()
        for _place, words in places:
            ui.alternativesComboBox.addItem(words)
        for widget in (ui.alternativesLabel, ui.alternativesComboBox, ui.takePlaceButton):
            widget.visible = bool(places)


def _places(found) -> list:
    """The places that an answer leaves open, the best first, each with what speaks for it: the share of all echoes that agree."""
    best = found.agreement.explained
    places = [(found.placed.labels_to_reference, found.agreement, _("Best"))]
    for other in found.alternatives:
        if other.agreement.explained >= WORTH_OFFERING * best:
            where = _("{levels:+d} level(s) (+: toward the head)").format(levels=other.levels) if other.levels else _("Elsewhere")
            places.append((other.labels_to_reference, other.agreement, where))
    words = _("{where}: {share:.0%} of the echoes agree, median {median:.1f} mm")
    return [(place, words.format(where=where, share=own.explained, median=own.median_distance)) for place, own, where in places]
