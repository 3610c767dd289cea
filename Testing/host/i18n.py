"""Translation as `slicer.i18n` has it. No language is installed: texts are those of the source, unless a test installs a translator."""

from __future__ import annotations

import inspect
import re
from pathlib import Path


def getContext(sourceFile):
    """The context under which a file's words are translated: its name, after its package's where it is in one."""
    path = Path(sourceFile)
    return f"{path.parent.name}.{path.stem}" if (path.parent / "__init__.py").is_file() else path.stem


def translate(context, text):
    """The text in the application's language; as it is where there is a scene and no application."""
    import slicer

    app = getattr(slicer, "app", None)
    return text if app is None else app.translate(context, text)


def tr(text):
    """The text in the application's language; a translation that lost a placeholder is not used."""
    translated = translate(getContext(inspect.getsourcefile(inspect.currentframe().f_back) or ""), text)
    placeholders = [set(re.findall(r"(?<!\{)\{([^{}]+)\}(?!\})", each)) for each in (text, translated)]
    return translated if placeholders[0] == placeholders[1] else text
