"""How the terminal writes settings, wherever an advice names them."""

from __future__ import annotations

import re

from ..message import COMMANDS, advised


def as_option(name: str, value: str = "") -> str:
    """A setting as an option of the command line, or another command."""
    if name in COMMANDS:
        return f"aifrecon {name}"
    return f"--{name.replace('_', '-')} {value}".rstrip()


def in_options(sentence: object) -> str:
    """A sentence or an error, and what to do about it, for the terminal."""
    return advised(sentence, as_option)


def in_columns(sentence: object) -> str:
    """The same for who fills in the table of a batch, whose columns are named as the options."""
    command, option = r"(?P<command>pip install .*|aifrecon [a-z][^.,;]*)", r"(?<![\w-])--(?P<option>[a-z][a-z-]*)"
    return re.sub(f"{command}|{option}", lambda found: found["command"] or found["option"].replace("-", "_"), in_options(sentence))
