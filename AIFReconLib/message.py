"""Sentences for the user that a program with another language than English can still translate."""

from __future__ import annotations

from collections.abc import Callable


class Message(str):
    """An English sentence that remembers what it was made of.

    It is a `str`, the English one, wherever a string is wanted: the command line prints it as it is. A translation needs the
    sentence before its values were filled in.

    Parameters
    ----------
    template : str
        The sentence, with its values as `str.format` takes them: ``"frame {number} is missing"``. Without values it is taken as it is.
    **values
        What the template names. A `Message`, or an error that holds one, is translated along with the sentence around it.

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
        message = super().__new__(cls, template.format(**values) if values else template)
        message.template = template
        message.values = values
        return message

    def translated(self, translate: Callable[[str], str]) -> str:
        """The sentence with `translate` applied to its template, and to the templates of its values."""
        template = translate(self.template)
        if not self.values:
            return template
        return template.format(**{name: translated(value, translate) for name, value in self.values.items()})


def translated(value: object, translate: Callable[[str], str]) -> object:
    """`value`, translated where it is a `Message` or an error that was raised with one; anything else as it is."""
    if isinstance(value, BaseException) and value.args and isinstance(value.args[0], Message):
        value = value.args[0]
    return value.translated(translate) if isinstance(value, Message) else value
