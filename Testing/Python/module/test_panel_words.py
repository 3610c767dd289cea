"""The panel speaks of its own widgets: no sentence of the library that can reach it names an option of the command line."""

from __future__ import annotations

import ast
import functools
import re
import sys
from pathlib import Path

import pytest

pytest_plugins = ["host_fixture"]

REPOSITORY = Path(__file__).resolve().parents[3]
for _folder in ("Testing", "AIFRecon"):
    if str(REPOSITORY / _folder) not in sys.path:
        sys.path.append(str(REPOSITORY / _folder))
import write_translations  # noqa: E402 - the folder must be known first

OF_COMMANDS_ALONE = (
    "compounding/engines",  # its option is one of pip
    "inspection/offset_estimate",  # aifrecon time-offset
    "io/foreign",  # aifrecon import and convert
    "io/sequence/transforms",
    "live/replay",  # aifrecon replay
    "sweep/edits",  # aifrecon convert
)
"""Files and rooms whose sentences never reach the panel."""


@functools.cache
def templates() -> list[str]:
    """The templates of the library that may reach the panel."""
    errors = write_translations.error_classes()
    found = []
    for path in write_translations.python_files(write_translations.LIBRARY):
        place = path.relative_to(write_translations.LIBRARY).with_suffix("")
        alone = any(place.is_relative_to(other) for other in OF_COMMANDS_ALONE)
        if alone or {place.parts[0], f"{place}.py"} & set(write_translations.COMMAND_LINE):
            continue
        for _, template in write_translations.template_calls(ast.parse(path.read_text(encoding="utf-8")), errors):
            found.append(write_translations.literal(template) or "")
    return list(dict.fromkeys(found))


def sentences() -> list[str]:
    """Those that name an option."""
    return [text for text in templates() if re.search(r"--[a-z]|aifrecon [a-z]", text)]


def test_sentences_that_name_options_are_found():
    assert len(sentences()) > 15


@pytest.mark.parametrize("template", sentences())
def test_no_option_of_the_command_line_is_named_in_the_panel(host, template):
    from AIFReconScene.panelWords import inPanelWords

    from AIFReconLib.message import Message

    said = inPanelWords(Message(template))
    assert not re.search(r"--[a-z]|aifrecon ", said)


def test_every_sentence_that_the_panel_puts_otherwise_is_one_of_the_library(host):
    from AIFReconScene.panelWords import _SENTENCES

    assert set(_SENTENCES) <= set(templates())


def test_labels_go_by_the_names_of_their_segments(host):
    from AIFReconScene.panelWords import inPanelWords

    from AIFReconLib.registration.agreement import Agreement, LabelAgreement

    warning = Agreement(0.8, 0.3, 1000, 0, {1: LabelAgreement(0.9, 0.3, 800), 2: LabelAgreement(0.1, 4.0, 200)}).warning()
    assert inPanelWords(warning, {1: "L3", 2: "L4"}).startswith("Not on its echoes: L4.")
    assert inPanelWords(warning, {}) == inPanelWords(warning, {1: "L3"}) == warning


def test_a_box_is_not_called_a_volume(host):
    from AIFReconScene.panelWords import inPanelWords

    from AIFReconLib.message import Message

    template = next(text for text in sentences() if "--grid-like" in text)
    said = inPanelWords(Message(template, sequence="sweep", reasons="outside: 3 frames"))
    assert "Like volume" not in said
    assert "region" in said
