"""The panel says what to do in the words on its own controls."""

from __future__ import annotations

import re
from pathlib import Path

pytest_plugins = ["host_fixture"]

MODULE = Path(__file__).resolve().parents[3] / "AIFRecon"


def test_every_remedy_has_words_in_the_panel(host):
    from AIFReconScene.panelWords import remedies

    from AIFReconLib.remedies import Remedy

    assert set(remedies()) == set(Remedy)


def test_no_option_of_the_command_line_is_named_in_the_panel(host):
    from AIFReconScene.panelWords import remedies

    commands = r"aifrecon [a-z-]+ --help"
    assert [words for words in remedies().values() if "--" in re.sub(commands, "", words)] == []


def test_every_control_that_a_remedy_names_exists(host):
    from AIFReconScene.panelWords import remedies

    shown = "".join(path.read_text("utf-8") for suffix in ("ui", "py") for path in MODULE.rglob(f"*.{suffix}") if path.stem != "panelWords")
    named = {name for words in remedies().values() for name in re.findall("“([^”]+)”", words)}
    assert len(named) > 10
    assert {name for name in named if name not in shown} == set()


def test_a_sentence_says_the_remedy(host):
    from AIFReconScene.panelWords import inPanelWords

    from AIFReconLib.message import Sentence
    from AIFReconLib.remedies import Remedy

    assert inPanelWords(Sentence("No frame falls into the volume.", Remedy.CHECK_THE_BOX)) == (
        "No frame falls into the volume. Check the region, and the transforms of the sweep."
    )


def test_labels_go_by_the_names_of_their_segments(host):
    from AIFReconScene.panelWords import withNames

    from AIFReconLib.registration.agreement import Agreement, LabelAgreement

    warning = Agreement(0.8, 0.3, 1000, 0, {1: LabelAgreement(0.9, 0.3, 800), 2: LabelAgreement(0.1, 4.0, 200)}).warning()
    assert withNames(warning, {1: "L3", 2: "L4"}).startswith("Not on its echoes: L4.")
    assert withNames(warning, {}) == withNames(warning, {1: "L3"}) == warning
