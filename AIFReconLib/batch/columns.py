"""The columns of a table of cases: the options of reconstruct, register, coverage and evaluate, read from a cell each.

The options are declared by the functions that declare them for those commands, so a new one is a new column.
"""

from __future__ import annotations

import argparse
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

YES, NO = ("yes", "y", "true", "1", "x"), ("no", "n", "false", "0", "")

NOT_A_COLUMN = ("save_settings",)
"""Options of a single reconstruction: the volumes of every case keep their settings."""


class CellParser(OneLineParser):
    """The options of a case; an error is raised and not printed."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong with a cell, without the name of the option: the column is known."""
        words = message.partition(": ")[2] if message.startswith("argument ") else message
        raise SettingsError(f"{words.rstrip('.')}.")


def case_parser() -> CellParser:
    """The options of a case as a parser."""
    parser = CellParser(prog=CASE, add_help=False)
    parser.add_argument("--register", action="store_true", help="find where the CT belongs on the sweep, from bone_transform if given")
    add_placing_options(parser)
    add_setting(parser, METHOD)
    add_tracking_options(parser, several=True)
    add_sequence_options(parser)
    add_reconstruction_options(parser)
    add_settings_options(parser)
    add_beam_option(parser)
    parser.add_argument("--bone", type=Path, help="true segmentation to measure against, in the frame of bone_labels, which stand in")
    parser.add_argument("--preview", action="store_false", help="no: draw no picture of the volume")
    return parser


class Columns:
    """What a cell may say, by the name of its column.

    Attributes
    ----------
    defaults : Namespace
        Of a case whose row says nothing.
    names : tuple of str
    """

    def __init__(self) -> None:
        self._parser = case_parser()
        self.defaults_from = self._parser.defaults_from
        self._parser.defaults_from = None
        self._actions = {
            action.dest: action for action in self._parser._actions if action.option_strings and action.dest not in NOT_A_COLUMN
        }
        self.defaults = self._parser.parse_args([])
        self.names = (CASE, SWEEPS, *self._actions)
        self._known: dict[tuple[str, str], object] = {}
        self.rivals = [tuple(action.dest for action in group._group_actions) for group in self._parser._mutually_exclusive_groups]
        """Columns of which a row may fill one."""

    def read(self, column: str, text: str, folder: Path) -> object:
        """What a cell says; None where it is empty.

        Raises SettingsError with what the column takes.

        Parameters
        ----------
        column, text : str
        folder : Path
            Which paths are relative to.
        """
        text = text.strip()
        if not text:
            return None
        if column == SWEEPS:
            return [folder / each for each in _several(text)]
        action = self._actions[column]
        if column in SIDE_OUTPUTS or action.nargs == 0:
            return _yes_or_no(text)
        if isinstance(action, NamedFileAction):
            given = self._parsed(column, [f"{action.option_strings[0]}={each}" for each in _several(text)])
            return {name: folder / path for name, path in dict(given).items()}  # type: ignore[call-overload]  # of a NamedFileAction
        if action.type is Path:
            several = [folder / each for each in _several(text)]
            if isinstance(action, argparse._AppendAction | FilesAction):
                return several
            if len(several) > 1:
                raise SettingsError(f"{column} takes one file, got {len(several)}.")
            return several[0]
        if (column, text) not in self._known:
            option = action.option_strings[0]
            if column == METHOD:
                read: object = tuple(self._method(each) for each in _several(text))
            elif isinstance(action.nargs, int):
                read = self._parsed(column, [option, *text.replace(SEPARATOR, " ").split()])
            else:
                read = self._parsed(column, [f"{option}={text.replace(SEPARATOR, ' ')}"])
            self._known[column, text] = read
        return self._known[column, text]

    def _method(self, name: str) -> object:
        """A method. One of the user's own is known already, or refused: a table, as any file, has no module imported."""
        if is_own_method(name):
            try:
                method_named(name)
            except MethodError:
                raise MethodError(
                    f"{name} is a method of your own, which no table brings in by itself. Give it as in aifrecon batch --method {name} too."
                ) from None
        return self._parsed(METHOD, [f"--{METHOD}={name}"])

    def _parsed(self, column: str, words: list[str]) -> object:
        return getattr(self._parser.parse_args(words), column)


def _several(text: str) -> list[str]:
    return [each.strip() for each in text.split(SEPARATOR) if each.strip()]


def _yes_or_no(text: str) -> bool:
    word = text.lower()
    if word in YES:
        return True
    if word in NO:
        return False
    raise SettingsError(f"must be yes or no; got {text!r}.")
