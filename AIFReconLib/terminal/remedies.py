"""How the terminal writes settings, wherever an advice names them."""

from __future__ import annotations

from ..message import advised


def as_option(name: str, value: str = "") -> str:
    """A setting as an option of the command line."""
    return f"--{name.replace('_', '-')} {value}".rstrip()


def as_column(name: str, value: str = "") -> str:
    """A setting as a column of the table of a batch."""
    return f"{name} {value}".rstrip()


def in_options(sentence: object) -> str:
    """A sentence or an error, and what to do about it, for the terminal."""
    return advised(sentence, as_option)


def in_columns(sentence: object) -> str:
    """The same for who fills in the table of a batch."""
    return advised(sentence, as_column)
