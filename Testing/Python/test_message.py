"""What the library says is wrong, and what each door says of the remedy."""

from __future__ import annotations

import argparse
import ast
import pickle
import re
from pathlib import Path

import pytest

from AIFReconLib.commands.parser import build_parser
from AIFReconLib.errors import AIFReconError, OutputError, SettingsError
from AIFReconLib.message import LONGEST_SENTENCE, Sentence, advised, listed, one_line, said
from AIFReconLib.remedies import IN_PYTHON, Remedy
from AIFReconLib.terminal.remedies import IN_OPTIONS, in_columns, in_options

LIBRARY = Path(__file__).resolve().parents[2] / "AIFReconLib"
OF_THE_TERMINAL = ("batch", "commands", "terminal")


def test_a_sentence_is_the_text_alone():
    assert Sentence("No probe is known.", Remedy.NAME_THE_PROBE) == "No probe is known."


def test_each_door_says_the_remedy_in_its_own_words():
    error = SettingsError("got 0.", Remedy.HOLE_LIMIT)
    assert (str(error), in_options(error), in_columns(error), said(error)) == (
        "got 0. Give hole_limit in mm.",
        "got 0. Give --hole-limit MM.",
        "got 0. Give hole_limit MM.",
        "got 0.",
    )


def test_details_are_named_in_the_remedy():
    sentence = Sentence("Two ways.", Remedy.WHICH_CHAIN, chain="ImageToReference")
    assert in_options(sentence).endswith("as in --image-to-reference ImageToReference.")


@pytest.mark.parametrize("inner", [SettingsError("late.", Remedy.HOLE_LIMIT), Sentence("late.", Remedy.HOLE_LIMIT)])
def test_an_error_about_another_takes_its_remedy_over(inner):
    outer = OutputError(f"a.mha: {said(inner) if isinstance(inner, Exception) else inner}", inner)
    assert (str(outer), in_options(outer)) == ("a.mha: late. Give hole_limit in mm.", "a.mha: late. Give --hole-limit MM.")


def test_an_error_may_be_raised_with_a_sentence():
    assert in_options(SettingsError(Sentence("late.", Remedy.HOLE_LIMIT))) == "late. Give --hole-limit MM."


def test_what_names_no_remedy_is_said_as_it_is():
    assert [advised(each) for each in ("text", Sentence("text"), SettingsError("text"), ValueError("text"))] == ["text"] * 4


def test_braces_in_a_file_s_name_stay():
    assert in_options(SettingsError("{x}.mha: late.", Remedy.HOLE_LIMIT)) == "{x}.mha: late. Give --hole-limit MM."


def test_what_a_file_holds_cannot_command_a_terminal_nor_fill_it():
    said_of_it = str(SettingsError(f"bad \x1b[2J\n{'x' * 10**6}", Remedy.HOLE_LIMIT))
    assert re.fullmatch(r"bad \?\[2J\?x+\.\.\. Give hole_limit in mm\.", said_of_it)
    assert len(said_of_it) < LONGEST_SENTENCE + 100


def test_an_error_comes_through_a_pickle_with_its_remedy():
    error = pickle.loads(pickle.dumps(SettingsError("got 0.", Remedy.WHICH_CHAIN, chain="AToB")))
    assert (type(error), in_options(error)[-26:]) == (SettingsError, "--image-to-reference AToB.")


def test_the_kind_of_an_error_is_a_builtin_one_too():
    assert issubclass(SettingsError, (ValueError, AIFReconError))


def test_several_things_are_listed():
    assert (listed([1, "b"]), listed([1, "b"], " or "), listed([])) == ("1, b", "1 or b", "")


def test_one_line_is_left_of_several():
    assert one_line("a\nb\x00é") == "a?b?é"


# ---- the tables of remedies


@pytest.mark.parametrize("words", [IN_PYTHON, IN_OPTIONS], ids=["Python", "terminal"])
def test_every_remedy_has_words_and_all_doors_name_the_same_details(words):
    def details(text):
        return set(re.findall(r"(?<!\{)\{(\w+)", text))

    assert set(words) == set(Remedy)
    assert [each.name for each in Remedy if not details(words[each]) <= details(IN_PYTHON[each]) | {"module"}] == []


def options_of(parser: argparse.ArgumentParser) -> set[str]:
    options = set()
    for action in parser._actions:
        options |= set(action.option_strings)
        if isinstance(action, argparse._SubParsersAction):
            for command in action.choices.values():
                options |= options_of(command)
    return options


def test_every_option_that_a_remedy_names_exists():
    known = options_of(build_parser())
    assert {option for words in IN_OPTIONS.values() for option in re.findall(r"--[a-z][a-z-]*", words)} - known == set()


def names_in(path: Path) -> set[str]:
    """Functions, classes, parameters, fields and modules of a file of the library."""
    tree = ast.parse(path.read_text("utf-8"))
    found = {path.stem}
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            found.add(node.name)
        if isinstance(node, ast.FunctionDef):
            found |= {each.arg for each in (*node.args.args, *node.args.kwonlyargs)}
        if isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            found.add(node.target.id)
    return found


def test_every_name_of_python_that_a_remedy_names_exists():
    known = set().union(*map(names_in, LIBRARY.rglob("*.py")))
    named = {
        name
        for words in IN_PYTHON.values()
        for pair in re.findall(r"\b([a-z]+(?:_[a-z]+)+)\b|\b(\w+)[=(]", re.sub(r"\{\w+[^}]*\}", "", words))
        for name in pair
        if name
    }
    assert len(named) > 15
    assert named - known == set()


def texts(tree: ast.Module) -> list[str]:
    """Every string of a file but docstrings."""
    told = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [
        node.value for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in told
    ]


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


def test_every_remedy_is_named_where_something_is_wrong():
    told = "".join(path.read_text("utf-8") for path in LIBRARY.rglob("*.py") if path.name != "remedies.py")
    assert [each.name for each in Remedy if f"Remedy.{each.name}" not in told] == []
