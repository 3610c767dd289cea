"""Writes what translators work on: every visible text of the module and the library, in the format of Qt Linguist.

    python Testing/write_translations.py

The file is made when it is wanted and not kept in git. It is named as Slicer's language tools name that of an extension
(``AIFRecon_en-US.ts``, see SlicerLanguagePacks). Their own search, Qt's lupdate, finds `_()`, `translate()` and the .ui file; that the
library's errors and messages are translated, and when, it cannot see.
Contexts are those that are looked up at run time: that of `slicer.i18n` for a file, the class of a .ui file, and one for the library.
Texts of the command line stay English and are left out.
"""

from __future__ import annotations

import ast
import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from xml.sax.saxutils import escape

REPOSITORY = Path(__file__).resolve().parents[1]
MODULE, LIBRARY = REPOSITORY / "AIFRecon", REPOSITORY / "AIFReconLib"
TARGET = REPOSITORY / "Resources" / "Translations" / "AIFRecon_en-US.ts"

LIBRARY_CONTEXT = "AIFReconLib"
COMMAND_LINE = ("batch", "commands", "terminal", "__main__.py")
"""Of the library: what only its command line says."""

Texts = dict[str, dict[str, set[str]]]
"""Context, text, and the files it is in."""


def python_files(folder: Path) -> list[Path]:
    """Every Python file below a folder, in order."""
    return sorted(path for path in folder.rglob("*.py") if "__pycache__" not in path.parts)


def context_of(path: Path) -> str:
    """The context under which `slicer.i18n.tr` looks up the texts of a file."""
    return f"{path.parent.name}.{path.stem}" if (path.parent / "__init__.py").is_file() else path.stem


def called(call: ast.Call) -> str:
    """The name of what is called, without what it belongs to."""
    return call.func.id if isinstance(call.func, ast.Name) else getattr(call.func, "attr", "")


def error_classes() -> set[str]:
    """The names of every class that is an AIFReconError, wherever it is defined."""
    bases: dict[str, set[str]] = {}
    for folder in (LIBRARY, MODULE):
        for path in python_files(folder):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.ClassDef):
                    bases[node.name] = {getattr(base, "id", "") for base in node.bases}
    known = {"AIFReconError"}
    while more := {name for name, above in bases.items() if above & known} - known:
        known |= more
    return known


def template_calls(tree: ast.Module, errors: set[str]) -> Iterator[tuple[ast.Call, ast.expr]]:
    """Every call in a file that is given the template of a message, with the expression that it is given as template.

    Notes
    -----
    These are `Message`, under whatever name it was imported; the classes of errors, also where a variable named `error` holds one; the
    `failure` of the readers; and `report`, for what is being done.
    """
    messages = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[-1] == "message"
        for alias in node.names
        if alias.name == "Message"
    }
    for call in ast.walk(tree):
        if not isinstance(call, ast.Call) or not call.args:
            continue
        name = called(call)
        if name in messages | errors | {"failure"} or (name == "error" and isinstance(call.func, ast.Name)):
            # An attribute comes before the template where the failure is one of XML
            yield call, call.args[-1]
        elif name == "report" and len(call.args) == 3:
            yield call, call.args[2]


def has_words(text: str) -> bool:
    """Whether there is anything to translate outside the placeholders."""
    depth, letters = 0, False
    for character in text:
        depth += (character == "{") - (character == "}")
        letters = letters or (depth == 0 and character.isalpha())
    return letters


def literal(expression: ast.expr) -> str | None:
    """The text that an expression spells out; None for any other."""
    return expression.value if isinstance(expression, ast.Constant) and isinstance(expression.value, str) else None


def library_texts(texts: Texts) -> None:
    """Add the templates of the library, and of what the module says in the same way."""
    errors = error_classes()
    files = [path for path in python_files(LIBRARY) if path.relative_to(LIBRARY).parts[0] not in COMMAND_LINE]
    for path in (*files, *python_files(MODULE)):
        for _, template in template_calls(ast.parse(path.read_text(encoding="utf-8")), errors):
            add(texts, LIBRARY_CONTEXT, literal(template) or "", path)


def module_texts(texts: Texts) -> None:
    """Add what the module gives to `_()` and `translate()`."""
    for path in python_files(MODULE):
        for call in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not isinstance(call, ast.Call):
                continue
            given = [literal(argument) or "" for argument in call.args]
            if called(call) == "_" and len(given) == 1 and given[0]:
                add(texts, context_of(path), given[0], path)
            elif called(call) == "translate" and len(given) == 2 and all(given):
                add(texts, given[0], given[1], path)


def ui_texts(texts: Texts) -> None:
    """Add the strings of the .ui files, those excepted that Designer marks as not translatable."""
    for path in sorted(MODULE.rglob("*.ui")):
        root = ElementTree.parse(path).getroot()
        for element in (*root.iter("property"), *root.iter("attribute")):
            for child in element:
                if child.tag in ("string", "stringlist") and child.get("notr") != "true":
                    for text in [child.text] if child.tag == "string" else [item.text for item in child]:
                        add(texts, root.findtext("class", ""), text or "", path)


def add(texts: Texts, context: str, text: str, path: Path) -> None:
    """Add a text with words in it."""
    if has_words(text):
        texts.setdefault(context, {}).setdefault(text, set()).add(path.relative_to(REPOSITORY).as_posix())


def all_texts() -> Texts:
    """Every text that can be translated, by context."""
    texts: Texts = {}
    module_texts(texts)
    ui_texts(texts)
    library_texts(texts)
    return texts


def to_ts(texts: Texts) -> str:
    """The texts as a translation source file, in an order that depends on nothing else."""
    lines = ['<?xml version="1.0" encoding="utf-8"?>', "<!DOCTYPE TS>", '<TS version="2.1" language="en_US" sourcelanguage="en_US">']
    for context in sorted(texts):
        lines += ["<context>", f"    <name>{escape(context)}</name>"]
        for text, files in sorted(texts[context].items()):
            lines.append("    <message>")
            lines += [f'        <location filename="../../{file}"/>' for file in sorted(files)]
            lines.append(f"        <source>{escape(text)}</source>")
            lines += ['        <translation type="unfinished"></translation>', "    </message>"]
        lines.append("</context>")
    return "\n".join([*lines, "</TS>", ""])


def write(target: Path = TARGET) -> None:
    """Write the file."""
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(to_ts(all_texts()), encoding="utf-8", newline="\n")


if __name__ == "__main__":
    write()
    print(f"wrote {TARGET.relative_to(REPOSITORY).as_posix()}")
