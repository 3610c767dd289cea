"""Sentences for the user that a program with another language than English can still translate."""

from __future__ import annotations

import re
import string
from collections.abc import Callable, Iterable
from html import escape
from pathlib import PurePath

LONGEST_QUOTE = 500
"""Characters of a text that a sentence repeats at most."""


class Message(str):
    """An English sentence that remembers what it was made of.

    It is a `str`, the English one, wherever a string is wanted: the command line prints it as it is. A translation needs the
    sentence before its values were filled in.

    Parameters
    ----------
    template : str
        The sentence, with its values as `str.format` takes them: ``"frame {number} is missing"``. Without values it is taken as it is.
    **values
        What the template names. A `Message`, or an error that holds one, is translated along with the sentence around it. Text and paths
        may come from a file: they are shown on one line, and text is cut to `LONGEST_QUOTE` characters.

    Examples
    --------
    >>> message = Message("frame {number} is missing", number=3)
    >>> message
    'frame 3 is missing'
    >>> message.translated({"frame {number} is missing": "Bild {number} fehlt"}.get)
    'Bild 3 fehlt'
    """

    template: str
    values: dict[str, object]

    def __new__(cls, template: str, /, **values: object) -> Message:
        values = {name: _shown(value) for name, value in values.items()}
        message = super().__new__(cls, template.format(**values) if values else template)
        message.template = template
        message.values = values
        return message

    def translated(self, translate: Callable[[str], str]) -> str:
        """The sentence with `translate` applied to its template, and to the templates of its values.

        A translation whose placeholders are not those of the template is a translator's mistake; the English template then stands in.
        """
        template = translate(self.template)
        if not self.values:
            return template
        if _placeholders(template) != _placeholders(self.template):
            template = self.template
        return template.format(**{name: translated(value, translate) for name, value in self.values.items()})


def listed(items: Iterable[object], separator: str = ", ") -> Message:
    """Several messages as one, which is translated item by item."""
    values = {f"item{number}": item for number, item in enumerate(items)}
    return Message(separator.join(f"{{{name}}}" for name in values), **values)


def one_line(text: str) -> str:
    """`text` with everything that a terminal cannot show on one line replaced by a question mark."""
    return "".join(character if character.isprintable() else "?" for character in text)


def shorten(text: str, length: int = 60) -> str:
    """`text` cut to `length` characters, for quoting it in a message."""
    return text if len(text) <= length else text[: length - 3] + "..."


class _OneLine(str):
    """Text from elsewhere that a message shows as `one_line` does; ``!r`` shows it as it is, for that escapes what cannot be printed."""

    def __format__(self, form: str) -> str:
        return one_line(super().__format__(form))


def _shown(value: object) -> object:
    """A value as a sentence shows it: plain text and paths on one line, errors as `said`, anything else as it is."""
    if isinstance(value, BaseException) and value.args and isinstance(value.args[0], Message):
        return value.args[0]
    if isinstance(value, PurePath):
        return value if str(value).isprintable() else _OneLine(value)
    if type(value) is str:
        return _OneLine(shorten(value, LONGEST_QUOTE))
    return value


def _placeholders(template: str) -> set[tuple[str | None, str | None, str | None]] | None:
    """Names, conversions and formats in braces; None where the braces do not match."""
    try:
        return {(name, conversion, form) for _, name, form, conversion in string.Formatter().parse(template) if name is not None}
    except ValueError:
        return None


def said(error: BaseException) -> Message:
    """What an error says: the `Message` that it was raised with, where it was raised with one."""
    return error.args[0] if error.args and isinstance(error.args[0], Message) else Message(str(error))


def translated(value: object, translate: Callable[[str], str]) -> object:
    """`value`, translated where it is a `Message` or an error that was raised with one; anything else as it is."""
    if isinstance(value, BaseException):
        value = said(value)
    return value.translated(translate) if isinstance(value, Message) else value


IN_PYTHON = {
    "--probe linear, or --probe sector with --apex-px COLUMN ROW": (
        'probe=ProbeGeometry("linear"), or probe=ProbeGeometry("sector", (column, row))'
    ),
    "--probe linear": 'probe=ProbeGeometry("linear")',
    "--probe sector": 'probe=ProbeGeometry("sector", (column, row))',
    "--apex-px COLUMN ROW": 'probe=ProbeGeometry("sector", (column, row))',
    "--clip-px {x} {y} {width} {height}": "region=ImageRegion(ClipRectangle(({x}, {y}), ({width}, {height})))",
    "--clip-px X Y W H": "region=ImageRegion(ClipRectangle((x, y), (width, height)))",
    "--clip-px": "region",
    "--transform-sequence NAME=FILE": "read_sequence(path, transform_sequences=...)",
    "--config PlusDeviceSet.xml": 'read_sequence(path, config="PlusDeviceSet.xml")',
    "--bone-labels": "BoneMap.from_labels",
    "them as --bone-probability": "them to BoneMap.from_probability",
    "--bone-probability": "BoneMap.from_probability",
    "Start nearer with --bone-transform": "Give a start nearer to it",
    "start nearer with --bone-transform": "give a start nearer to it",
    "take it as it is with --accept": "use its transform as it is",
    "take the best with --accept": "use its transform",
    "in --report": "in alternatives",
    "--level N": "level",
    "--bone-transform": "the transform of the CT",
    "--grid-like": "grid",
    ", or name it with --method": "",
}
"""What options are in Python, where that is not their name with underscores."""


def in_python_words(template: str) -> str:
    """A sentence with the command line's options as who calls the library from Python knows them; whole commands stay as they are."""
    for option, word in IN_PYTHON.items() if "--" in template else ():
        template = template.replace(option, word)
    command = r"(?P<command>pip install .*|aifrecon [a-z][^.,;]*|\{command\}.*)"
    option = r"(?<![\w-])--(?P<option>[a-z][a-z-]*)(?: [A-Z][A-Z0-9]*\b)*"
    return re.sub(f"{command}|{option}", lambda found: found["command"] or found["option"].replace("-", "_"), template)


def html_table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """Names and values as a small table for a notebook."""
    body = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th><td style='text-align:left'>{escape(str(value))}</td></tr>"
        for name, value in rows
    )
    return f"<table><caption style='text-align:left'><b>{escape(title)}</b></caption>{body}</table>"


class Described:
    """Shows itself in a line, and in a notebook as a table, by what `_facts` tells."""

    def _facts(self) -> list[tuple[str, str]]:
        raise NotImplementedError

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {', '.join(f'{name} {value}' for name, value in self._facts())}>"

    def _repr_html_(self) -> str:
        return html_table(type(self).__name__, self._facts())


def columns(rows: Iterable[Iterable[str]], indent: str = "  ") -> str:
    """Rows of words as aligned columns, one line each."""
    table = [[str(cell) for cell in row] for row in rows]
    widths = [max((len(row[c]) for row in table if c < len(row)), default=0) for c in range(max(map(len, table), default=0))]
    return "\n".join((indent + "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=False))).rstrip() for row in table)
