"""What the library says is wrong, and what each door says of the remedy."""

from __future__ import annotations

import ast
import pickle
import re
from pathlib import Path

from AIFReconLib.commands.parser import COMMANDS as COMMANDS_OF_THE_TERMINAL
from AIFReconLib.commands.parser import parser_of
from AIFReconLib.errors import AIFReconError, OutputError, SettingsError
from AIFReconLib.message import COMMANDS, LONGEST_SENTENCE, Sentence, advised, as_label, message_of
from AIFReconLib.terminal.remedies import as_option, in_columns, in_options

LIBRARY = Path(__file__).resolve().parents[2] / "AIFReconLib"
HOLES = "Give {hole_limit:MM}."
CHAIN = "Say which one is right, as in {image_to_reference:{chain}}."
OF_THE_TERMINAL = ("batch", "commands", "terminal")


def test_each_door_says_the_remedy_in_its_own_words():
    error = SettingsError("got 0.", HOLES)
    assert (str(error), in_options(error), in_columns(error), message_of(error)) == (
        "got 0. Give hole_limit=mm.",
        "got 0. Give --hole-limit MM.",
        "got 0. Give hole_limit MM.",
        "got 0.",
    )
    assert issubclass(SettingsError, (ValueError, AIFReconError))
    sentence = Sentence("No probe is known.", "Give {probe:linear} or {method} of {these}.", these="x")
    assert (sentence, sentence.settings) == ("No probe is known.", ("probe", "method"))
    labels = {"probe": "Probe"}
    spelled = [as_label(labels, *each) for each in (("probe", "linear"), ("probe", "NAME"), ("per_segment", ""))]
    assert spelled == ["“Probe” (linear)", "“Probe”", "per segment"]
    assert [advised(each) for each in ("text", Sentence("text"), SettingsError("text"), ValueError("text"))] == ["text"] * 4


SPELLED = {
    "{probe:linear}": ('probe="linear"', "--probe linear"),
    "{clip_px:5 3 29.5 -2}": ("clip_px=(5, 3, 29.5, -2)", "--clip-px 5 3 29.5 -2"),
    "{apex_px:COLUMN ROW}": ("apex_px=(column, row)", "--apex-px COLUMN ROW"),
    '{columns:"time x"}': ('columns="time x"', '--columns "time x"'),
    "{bone_from_sweep}": ("Recipe(bone_from_sweep=True)", "--bone-from-sweep"),
    "{grid_like}": ("grid=", "--grid-like"),
}


def test_a_setting_and_its_value_are_written_as_each_door_does():
    assert {text: (advised(Sentence("", text)), in_options(Sentence("", text))) for text in SPELLED} == SPELLED


LATE = SettingsError("late.", HOLES)


CHAINED = SettingsError("0.", CHAIN, chain="AToB")
SAID = {
    "details": (Sentence("Two.", CHAIN, chain="AToB"), "Two. Say which one is right, as in --image-to-reference AToB."),
    "through a pickle": (pickle.loads(pickle.dumps(CHAINED)), "0. Say which one is right, as in --image-to-reference AToB."),
    "an error of a sentence": (SettingsError(Sentence("late.", HOLES)), "late. Give --hole-limit MM."),
    "braces in a name": (SettingsError("{x}.mha: late.", HOLES), "{x}.mha: late. Give --hole-limit MM."),
    "about an error": (OutputError(f"a.mha: {message_of(LATE)}", LATE), "a.mha: late. Give --hole-limit MM."),
    "about a sentence": (OutputError(f"a.mha: {Sentence('late.', HOLES)}", Sentence("late.", HOLES)), "a.mha: late. Give --hole-limit MM."),
}


def test_the_terminal_says_what_to_do():
    assert {what: in_options(said) for what, (said, _) in SAID.items()} == {what: expected for what, (_, expected) in SAID.items()}


def test_what_a_file_holds_cannot_command_a_terminal_nor_fill_it():
    said_of_it = str(SettingsError(f"bad \x1b[2J\n{'x' * 10**6}", HOLES))
    assert re.fullmatch(r"bad \?\[2J\?x+\.\.\. Give hole_limit=mm\.", said_of_it)
    assert len(said_of_it) < LONGEST_SENTENCE + 100


# ---- the advice that the library gives


def texts(tree: ast.Module) -> list[str]:
    """Every string of a file but docstrings."""
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [
        node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told
    ]


def advice_in(path: Path) -> set[str]:
    """Every advice of a file that names a setting."""
    strings = [text for text in texts(ast.parse(path.read_text("utf-8"))) if "{needed}" not in text]
    return {text for text in strings if re.match(r"[A-Z].*\{[a-z_]+(:[^}]*)?\}.*\.$", text)}


ADVICE = set().union(*map(advice_in, LIBRARY.rglob("*.py")))
DETAILS = {
    "choice", "frame", "frames", "fits", "first", "unit", "word", "example", "offset", "methods",
    "or_calibration", "across", "along", "name",
}  # fmt: skip
"""What is no setting in an advice."""


def named() -> set[str]:
    """The settings that an advice names."""
    return {name for text in ADVICE for name in Sentence("", text).settings} - DETAILS - {"module", *COMMANDS}


def test_every_setting_of_an_advice_is_an_option():
    known = {word for name in COMMANDS_OF_THE_TERMINAL for word in parser_of(name).spelled}
    assert len(named()) > 30
    assert {name for name in named() if as_option(name) not in known} == set()


def test_every_command_of_an_advice_is_one():
    assert set(COMMANDS) <= set(COMMANDS_OF_THE_TERMINAL)
    assert all(any(f"{{{command}" in text for text in ADVICE) for command in COMMANDS)
    sentence = Sentence("Off.", "See {calibrate}.")
    assert (in_options(sentence), advised(sentence)) == ("Off. See aifrecon calibrate.", "Off. See calibrate.")


OF_OTHERS = ("--force-reinstall", "rosbags-convert", "--exclude-topic", "{ ")
"""In what is said of other programs."""


def test_the_library_names_no_option_outside_the_terminal():
    offenders = [
        f"{path.relative_to(LIBRARY)}: {text}"
        for path in LIBRARY.rglob("*.py")
        if path.relative_to(LIBRARY).parts[0] not in (*OF_THE_TERMINAL, "__main__.py")
        for text in texts(ast.parse(path.read_text("utf-8")))
        if re.search(r"(^|[ (])--[a-z]", text) and not any(known in text for known in OF_OTHERS)
    ]
    assert offenders == []
