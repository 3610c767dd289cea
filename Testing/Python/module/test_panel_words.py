"""The panel says what to do in the words on its own controls."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest_plugins = ["host_fixture"]

MODULE = Path(__file__).resolve().parents[3] / "AIFRecon"


def test_every_control_that_is_named_exists(host):
    from AIFReconScene.panelWords import asControl

    shown = "".join(path.read_text("utf-8") for suffix in ("ui", "py") for path in MODULE.rglob(f"*.{suffix}") if path.stem != "panelWords")
    labels = asControl().args[0]
    named = {label for name, label in labels.items() if label}
    assert len(named) > 20
    assert {label for label in named if label not in shown} == set()


@pytest.mark.parametrize(
    ("advice", "words"),
    [
        ("Give {probe:linear}.", "Give “Probe” (linear)."),
        ("Give {clip_px:X Y W H}.", "Give “Clip rectangle”."),
        ("Give {per_segment}.", "Give per segment."),
    ],
)
def test_a_sentence_names_controls(host, advice, words):
    from AIFReconScene.panelWords import inPanelWords

    from AIFReconLib.message import Sentence

    assert inPanelWords(Sentence("Late.", advice)) == f"Late. {words}"


def test_labels_go_by_the_names_of_their_segments(host):
    from AIFReconScene.panelWords import withNames

    from AIFReconLib.registration.agreement import Agreement, LabelAgreement

    warning = Agreement(0.8, 0.3, 1000, 0, {1: LabelAgreement(0.9, 0.3, 800), 2: LabelAgreement(0.1, 4.0, 200)}).warning()
    assert withNames(warning, {1: "L3", 2: "L4"}).startswith("Not on its echoes: L4.")
    assert withNames(warning, {}) == withNames(warning, {1: "L3"}) == warning
