"""Shows the panel in a made-up language and names every visible text that stays in English.

    python Testing/host/translated_panel.py [--forget TEXT ...]

The language is every text that translators get, in wide letters (ＡＢＣ), so an ASCII letter that can be seen was
never translated, or is a name: of a method, a node, a file, a transform. With --forget, a text is left out of the language; it has to be
named then. The exit status is 0 when nothing was found, 1 when something was, 2 when the host cannot run here.
"""

from __future__ import annotations

import argparse
import re
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
from dataclasses import fields
from pathlib import Path

TESTING = Path(__file__).resolve().parents[1]
for folder in (TESTING, TESTING / "Slicer"):
    sys.path.insert(0, str(folder))
from write_translations import MODULE, all_texts  # noqa: E402

from AIFReconLib.settings import ReconstructionSettings  # noqa: E402
from host import missing, runHost  # noqa: E402 - the folder must be known first

SHOWN = (
    "text",
    "toolTip",
    "title",
    "windowTitle",
    "placeholderText",
    "prefix",
    "suffix",
    "specialValueText",
    "accessibleName",
    "noneDisplay",
)
"""Properties of widgets that a user can read."""


def _words_of_the_settings() -> set[str]:
    """Words that the panel shows as they are written in settings, files and scenes."""
    choices = (spec.metadata.get("choices") or () for spec in fields(ReconstructionSettings))
    return {
        *(word for words in choices for word in words),
        "MF",
        "MN",
        "UF",
        "UN",
        "OpenIGTLink",
        "OUT_OF_VIEW",
        "ImageToReference",
        "ElementDataFile",
    }


KEPT = re.compile(r"\{[^}]*\}|--[a-z][a-z-]*(?: [A-Z][A-Z0-9]*\b)*|<[^>]*>|&\w+;")
"""Placeholders, options (which the panel replaces by its own words), tags: no translator may change these."""

NAMES = re.compile(
    r"<[^>]*>|&\w+;|(?<=\d) x (?=\d)|\d[eE][+-]?\d|\b("
    + "|".join(sorted(map(re.escape, _words_of_the_settings()), key=len, reverse=True))
    + r")\b"
)
"""What is the same in every language: tags, sizes, numbers, and words of the settings."""


def widened(text: str) -> str:
    """The text in wide letters."""
    parts, end = [], 0
    for kept in KEPT.finditer(text):
        parts += [_wide(text[end : kept.start()]), kept[0]]
        end = kept.end()
    return "".join([*parts, _wide(text[end:])])


def _wide(text: str) -> str:
    return "".join(chr(ord(letter) + 0xFEE0) if letter.isascii() and letter.isalpha() else letter for letter in text)


def language(forgotten: list[str]) -> dict[tuple[str, str], str]:
    """Every text that translators get, by context, in wide letters."""
    return {(context, text): widened(text) for context, texts in all_texts().items() for text in texts if text not in forgotten}


def install(words: dict[tuple[str, str], str]):
    """Qt's translator for these words; it must be kept."""
    from PySide6 import QtCore

    class Translator(QtCore.QTranslator):
        """Looks texts up by context, as Qt's own does in a compiled file."""

        def isEmpty(self):
            return False

        def translate(self, context, text, disambiguation=None, n=-1):
            return words.get((context, text))

    translator = Translator()
    QtCore.QCoreApplication.installTranslator(translator)
    return translator


class Reader:
    """Reads what a user can see, and keeps what is in English."""

    def __init__(self, names: list[str]):
        self.found: dict[str, str] = {}
        self._names = names
        self._widgets = {each.get("name") for path in MODULE.rglob("*.ui") for each in ElementTree.parse(path).iter("widget")}

    def read(self, where: str, text: str) -> None:
        text = text.replace("\u2060", "")  # a word joiner is not seen
        rest = text
        for name in self._names:
            rest = rest.replace(name, "")
        if re.search("[A-Za-z]", NAMES.sub("", rest)):
            self.found.setdefault(text, where)

    def know(self, path: str) -> None:
        self._names += [path, Path(path).name] if path else []

    def panel(self, step: str) -> None:
        from PySide6 import QtWidgets

        for widget in QtWidgets.QApplication.allWidgets():
            name = widget.objectName()
            if name not in self._widgets:
                continue
            for key in SHOWN:
                value = widget.property(key)
                entered = key == "text" and isinstance(widget, QtWidgets.QLineEdit | QtWidgets.QAbstractSpinBox)
                if isinstance(value, str) and not entered:
                    self.read(f"{name}.{key}, {step}", value)
            for filters in widget.property("nameFilters") or ():
                self.read(f"{name}.nameFilters, {step}", filters.split("(")[0])
            for tab in range(widget.count()) if isinstance(widget, QtWidgets.QTabWidget) else ():
                self.read(f"{name} tab {tab}, {step}", widget.tabText(tab))
            if isinstance(widget, QtWidgets.QComboBox):
                for row in range(widget.count()):
                    self.read(f"{name} item {row}, {step}", widget.itemText(row))

    def dialogs(self, step: str, dialogs) -> None:
        for dialog in dialogs.shown:
            # The title is Slicer's own, and what is behind "Show details" is for programmers
            self.read(f"{dialog.kind}, {step}", dialog.text.split("\nTraceback")[0])
        for text in dialogs.progress:
            self.read(f"progress, {step}", text)
        dialogs.clear()


def walk(host, reader: Reader, folder: Path) -> None:
    """The panel's main paths: opened, a recording that cannot be read, a sweep, a volume, a report, a comparison, a cancel, a live scan."""
    import slicer
    import tinyScene

    module = slicer.util.getModule("AIFRecon")
    for text in (module.title, module.helpText, module.acknowledgementText):
        reader.read("the module", text)
    widget = host.open("AIFRecon")
    ui, parameters = widget.ui, widget._parameterNode
    reader.panel("opened")

    broken = folder / "\u03c8.mha"
    broken.write_bytes(b"ObjectType = Image\nNDims = 3\n")
    parameters.recordingPath = folder / "\u03c9.mha"
    reader.panel("a recording that is not there")
    parameters.recordingPath = broken
    ui.loadButton.click()
    reader.dialogs("a recording that cannot be read", host.dialogs)
    parameters.recordingPath = Path()

    parameters.sweep = tinyScene.addSweep("\u03a3")
    reader.panel("a sweep without bone")
    ct, bone, registration = tinyScene.addCT()
    for node, name in ((ct, "\u03a9"), (bone, "\u0392"), (registration, "\u03a4")):
        node.SetName(name)
    bone.GetSegmentation().GetNthSegment(0).SetName("\u03a8")
    parameters.ctVolume, parameters.bone, parameters.spacing = ct, bone, 1.0
    ui.trackingMoreButton.checked = True
    reader.panel("ready")
    ui.applyButton.click()
    reader.panel("done")
    ui.compareButton.click()
    reader.panel("compared")
    reader.dialogs("done", host.dialogs)
    host.dialogs.cancel_progress()
    ui.applyButton.click()
    reader.panel("canceled")

    parameters.apexColumn, parameters.clipColumn, parameters.clipWidth, parameters.clipHeight = 0, 500, 4, 4
    ui.applyButton.click()
    reader.dialogs("an error of the library", host.dialogs)
    parameters.clipWidth = parameters.clipHeight = 0

    parameters.livePort = 9
    ui.liveStartButton.click()
    until = time.monotonic() + 3.0
    while time.monotonic() < until and "\uff26" not in ui.liveStatisticsLabel.text and "9" not in ui.liveStatisticsLabel.text:
        host.process_events()
    reader.know(ui.liveRecordedLabel.toolTip)
    reader.panel("live")
    ui.liveStopButton.click()
    reader.know(ui.liveRecordedLabel.toolTip)
    reader.panel("live, stopped")
    reader.dialogs("live", host.dialogs)


def main(arguments=None) -> int:
    """Walk through the panel; returns the exit status."""
    parser = argparse.ArgumentParser(description="Name every visible text of the panel that cannot be translated.")
    parser.add_argument("--forget", metavar="TEXT", action="append", default=[], help="a text that the language lacks")
    options = parser.parse_args(arguments)
    if reason := missing():
        print(f"The panel cannot be shown here: {reason}.", file=sys.stderr)
        return 2
    host = runHost()
    with tempfile.TemporaryDirectory() as folder:
        reader = Reader([str(Path(folder).resolve()), folder, ".mha", "127.0.0.1", "localhost"])
        translator = install(language(options.forget))
        host.start(MODULE / "AIFRecon.py")
        walk(host, reader, Path(folder))
    for text, where in reader.found.items():
        print(f"{where}: {text!r}")
    del translator
    return int(bool(reader.found))


if __name__ == "__main__":
    sys.exit(main())
