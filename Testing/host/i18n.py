"""Translation as `slicer.i18n` has it. No language is installed: texts are those of the source."""

from __future__ import annotations


def translate(context, text):
    """The text in the application's language."""
    return text


def tr(text):
    """The text in the application's language."""
    return text
