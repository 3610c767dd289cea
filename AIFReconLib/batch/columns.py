"""The columns of a table of cases: the options of reconstruct, register, coverage and evaluate, read from a cell each.

The options are declared by the functions that declare them for those commands, so a new one is a new column.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Annotated, ClassVar

from ..compounding.methods.table import is_own_method, method_named
from ..errors import MethodError, SettingsError
from ..evaluation.visibility import BEAM_THICKNESS
from ..terminal.arguments import OneLineParser, Settings, path, positive, rivals_of, spelling
from ..terminal.labels_options import PlacingOptions
from ..terminal.reconstruction_options import SIDE_OUTPUTS, ReconstructionOptions
from ..terminal.refusing import WrongArguments
from ..terminal.sequence_options import SweepOptions

CASE, SWEEPS, METHOD = "case", "sweeps", "method"
REQUIRED = (CASE, SWEEPS)

SEPARATOR = ";"
"""Between several values in a cell."""

YES, NO = ("yes", "y", "true", "1", "x"), ("no", "n", "false", "0")

NOT_A_COLUMN = ("save_settings", "help", "help_all", "quiet", "verbose", "log")
"""Options of a single reconstruction, the volumes of every case keep their settings; and of a program."""


class CaseOptions(PlacingOptions, ReconstructionOptions, SweepOptions):
    """What a row may say of its case.

    Parameters
    ----------
    sweeps
        one or more recordings
    register
        find where the CT belongs on the sweep, from bone_transform if given
    beam_thickness
        mm, of the beams across the image plane
    bone
        true segmentation to measure against, in the frame of bone_labels, which stand in
    preview
        no: draw no picture of the volume
    """

    sweeps: list[Path] = []
    register: bool = False
    beam_thickness: Annotated[float, positive] = BEAM_THICKNESS
    bone: Path | None = None
    preview: bool = True  # type: ignore[assignment]  # a file, of a single reconstruction

    SETTINGS: ClassVar[Settings] = ("motion",)


class Columns:
    """What a cell may say, by the name of its column: the options of a case.

    Attributes
    ----------
    names : tuple of str
    """

    def __init__(self) -> None:
        self._parser = OneLineParser(CaseOptions, CASE)
        self._of_column = {name: each for name, each in self._parser.declared.items() if name not in NOT_A_COLUMN}
        self.names = (CASE, *self._of_column)
        self._parsed = cache(self._parse)

    def rivals(self) -> set[tuple[str, ...]]:
        """Columns of which a row may fill one."""
        return {names for name in self._of_column if (names := rivals_of(CaseOptions, name))}

    def read(self, column: str, text: str, folder: Path) -> object:
        """What a cell says.

        Raises SettingsError with what the column takes.

        Parameters
        ----------
        column, text : str
        folder : Path
            Which paths are relative to.
        """
        several = tuple(each.strip() for each in text.split(SEPARATOR) if each.strip())
        words = self._of_column[column].words
        if column in SIDE_OUTPUTS or ("type" not in words and "choices" not in words):
            return _yes_or_no(text)
        if column == METHOD:
            return tuple(self._method(each) for each in several)
        if isinstance(words.get("nargs"), int):
            return self._parsed(column, (spelling(CaseOptions, column)[0], *" ".join(several).split()))
        if words.get("action") not in ("append", "extend"):
            if words.get("type") is path and len(several) > 1:
                raise SettingsError(f"{column} takes one file, got {len(several)}.")
            several = (" ".join(several),)
        return _beside(folder, self._parsed(column, tuple(f"{spelling(CaseOptions, column)[0]}={each}" for each in several)))

    def _method(self, name: str) -> object:
        """A method. One of the user's own is known already, or refused: a table, as any file, has no module imported."""
        if is_own_method(name):
            try:
                method_named(name)
            except MethodError:
                raise MethodError(
                    f"{name} is a method of your own, which no table brings in by itself. Give it as in aifrecon batch --method {name} too."
                ) from None
        return self._parsed(METHOD, (f"--{METHOD}={name}",))

    def _parse(self, column: str, words: tuple[str, ...]) -> object:
        try:
            return vars(self._parser.read(words))[column]
        except WrongArguments as wrong:
            # The column is known
            message = str(wrong)
            message = message.partition(": ")[2] if message.startswith("argument ") else message
            raise SettingsError(f"{message.rstrip('.')}.") from None


def _beside(folder: Path, value: object) -> object:
    """The value with its paths within the folder."""
    if isinstance(value, list):
        return [_beside(folder, each) for each in value]
    if isinstance(value, tuple):
        return tuple(_beside(folder, each) for each in value)
    return folder / value if isinstance(value, Path) else value


def _yes_or_no(text: str) -> bool:
    word = text.lower()
    if word not in (*YES, *NO):
        raise SettingsError(f"must be yes or no; got {text!r}.")
    return word in YES
