"""Dialogs that do not wait for anybody: what would be shown is kept, and the answer is given beforehand.

In a headless process a modal dialog would wait forever. So `exec` of any dialog notes what it would have shown and returns the next
prepared answer, else that of Cancel. A progress dialog is Qt's own; a test can have its Cancel button pressed after some updates.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from PySide6 import QtWidgets


@dataclass
class Dialogs:
    """What was shown, and what will be answered.

    Attributes
    ----------
    shown : list of str
        Texts.
    answers : list
        Returned by the next dialogs, in order: an enumeration value, a path, or text.
    on_progress : callable or None
        Called with the value at every update of a progress dialog.
    """

    shown: list[str] = field(default_factory=list)
    answers: list = field(default_factory=list)
    on_progress: object = None

    def answer(self, default):
        return self.answers.pop(0) if self.answers else default

    def clear(self) -> None:
        self.shown.clear()
        self.answers.clear()
        self.on_progress = None

    def messages(self) -> list[str]:
        return list(self.shown)


DIALOGS = Dialogs()


class QProgressDialog(QtWidgets.QProgressDialog):
    """Qt's progress dialog, watched."""

    def setValue(self, value):
        super().setValue(value)
        if DIALOGS.on_progress is not None:
            DIALOGS.on_progress(value)


def text_of(dialog) -> str:
    """What a dialog says."""
    if isinstance(dialog, QtWidgets.QMessageBox):
        return "\n".join(part for part in (dialog.text(), dialog.informativeText(), dialog.detailedText()) if part)
    return "\n".join(label.text() for label in dialog.findChildren(QtWidgets.QLabel) if label.text())


def execute(dialog) -> int:
    """Notes a dialog in place of waiting for it; returns the prepared answer or that of Cancel."""
    DIALOGS.shown.append(text_of(dialog))
    if isinstance(dialog, QtWidgets.QMessageBox):
        buttons = dialog.standardButtons()
        default = next(
            (b for b in (dialog.StandardButton.Cancel, dialog.StandardButton.No, dialog.StandardButton.Close) if buttons & b),
            dialog.StandardButton.Ok,
        )
        answer = DIALOGS.answer(default)
        return int(getattr(answer, "value", answer))
    return int(DIALOGS.answer(0))


def ask_statically(default):
    """A function that stands for a static dialog such as QFileDialog.getSaveFileName."""

    def ask(*args):
        DIALOGS.shown.append(str(args[1]))
        return DIALOGS.answer(default)

    return ask


STATIC = {"getSaveFileName": "", "getExistingDirectory": "", "getOpenFileNames": ()}
"""Functions of QFileDialog that open one, with the answer of Cancel."""
