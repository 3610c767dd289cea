"""A line for a file, kept alike with a parameter: Slicer's own connector shows an empty path as a dot."""

import pathlib

from slicer.i18n import translate

from .choosers import Follower

PATHS = ("recordingPath", "configurationPath", "liveRecordPath", "importanceMaskPath", "boneModelPath")
"""The parameters that are files."""


class PathField(Follower):
    """Keeps a ctkPathLineEdit and the `pathlib.Path` parameter of a name alike; the empty path is an empty line."""

    def __init__(self, lineEdit, name: str):
        # Qt's loader translates the strings of a .ui file, but not its lists of strings
        lineEdit.nameFilters = [translate("AIFRecon", words) for words in lineEdit.nameFilters]
        self._lineEdit = lineEdit
        self._name = name
        # Not of the path: CTK tells only those that fit its filters, so neither an emptied line nor a suffix in capitals
        lineEdit.comboBox().connect("editTextChanged(QString)", self._onChanged)

    def update(self) -> None:
        """Show the parameter."""
        path = getattr(self._parameterNode, self._name)
        text = "" if path == pathlib.Path() else str(path)
        if self._lineEdit.currentPath != text:
            self._lineEdit.currentPath = text

    def _onChanged(self, text: str) -> None:
        if self._parameterNode is not None and getattr(self._parameterNode, self._name) != pathlib.Path(text):
            setattr(self._parameterNode, self._name, pathlib.Path(text))
