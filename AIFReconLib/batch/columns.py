"""The columns of a table of cases: the options of reconstruct, register, coverage and evaluate, read from a cell each.

The options are declared by the functions that declare them for those commands, so a new one is a new column.
"""

from __future__ import annotations

import argparse
from functools import cache
from pathlib import Path
from typing import NoReturn

from ..compounding.methods.table import is_own_method, method_named
from ..errors import MethodError, SettingsError
from ..terminal.one_line_parser import FilesAction, OneLineParser
from ..terminal.options import add_beam_option, add_placing_options
from ..terminal.recipe_options import add_setting
from ..terminal.reconstruction_options import SIDE_OUTPUTS, add_reconstruction_options
from ..terminal.sequence_options import NamedFileAction, add_sequence_options, add_tracking_options
from ..terminal.settings_options import add_settings_options

CASE, SWEEPS, METHOD = "case", "sweeps", "method"
REQUIRED = (CASE, SWEEPS)

SEPARATOR = ";"
"""Between several values in a cell."""

YES, NO = ("yes", "y", "true", "1", "x"), ("no", "n", "false", "0")

NOT_A_COLUMN = ("save_settings",)
"""Options of a single reconstruction: the volumes of every case keep their settings."""


class Columns(OneLineParser):
    """What a cell may say, by the name of its column: the options of a case, whose errors are raised and not printed.

    Attributes
    ----------
    defaults : Namespace
        Of a case whose row says nothing.
    names : tuple of str
    """

    def __init__(self) -> None:
        super().__init__(prog=CASE, add_help=False)
        self.add_argument(f"--{SWEEPS}", type=Path, action="append", default=[], help="one or more recordings")
        self.add_argument("--register", action="store_true", help="find where the CT belongs on the sweep, from bone_transform if given")
        add_placing_options(self)
        add_setting(self, METHOD)
        add_tracking_options(self, several=True)
        add_sequence_options(self)
        add_reconstruction_options(self)
        add_settings_options(self)
        # Of the settings of a row that is read whole, not of each cell
        self.kept_settings, self.defaults_from = self.defaults_from, None
        add_beam_option(self)
        self.add_argument("--bone", type=Path, help="true segmentation to measure against, in the frame of bone_labels, which stand in")
        self.add_argument("--preview", action="store_false", help="no: draw no picture of the volume")
        self._of_column = {action.dest: action for action in self._actions if action.dest not in NOT_A_COLUMN}
        self.names = (CASE, *self._of_column)
        self.defaults = self.parse_args([])
        self._parsed = cache(self._parse)

    def rivals(self) -> list[list[str]]:
        """Columns of which a row may fill one."""
        return [[action.dest for action in group._group_actions] for group in self._mutually_exclusive_groups]

    def error(self, message: str) -> NoReturn:
        """Say what is wrong with a cell, without the name of the option: the column is known."""
        words = message.partition(": ")[2] if message.startswith("argument ") else message
        raise SettingsError(f"{words.rstrip('.')}.")

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
        action = self._of_column[column]
        if column in SIDE_OUTPUTS or action.nargs == 0:
            return _yes_or_no(text)
        if column == METHOD:
            return tuple(self._method(each) for each in several)
        if isinstance(action.nargs, int):
            return self._parsed(column, (action.option_strings[0], *" ".join(several).split()))
        if not isinstance(action, argparse._AppendAction | FilesAction | NamedFileAction):
            if action.type is Path and len(several) > 1:
                raise SettingsError(f"{column} takes one file, got {len(several)}.")
            several = (" ".join(several),)
        return _beside(folder, self._parsed(column, tuple(f"{action.option_strings[0]}={each}" for each in several)))

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
        return getattr(self.parse_args(words), column)


def _beside(folder: Path, value: object) -> object:
    """The value with its paths within the folder."""
    if isinstance(value, list):
        return [_beside(folder, each) for each in value]
    if isinstance(value, dict):
        return {name: _beside(folder, each) for name, each in value.items()}
    return folder / value if isinstance(value, Path) else value


def _yes_or_no(text: str) -> bool:
    word = text.lower()
    if word not in (*YES, *NO):
        raise SettingsError(f"must be yes or no; got {text!r}.")
    return word in YES
