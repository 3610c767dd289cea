"""Sentences that can be translated after their values were filled in."""

import ast
import pickle
import re
import sys
from pathlib import Path

import pytest

from AIFReconLib import errors
from AIFReconLib.errors import AIFReconError, BeamGeometryError, OutputError, SettingsError
from AIFReconLib.message import Message, in_python_words, listed, said, translated

sys.path.append(str(Path(__file__).resolve().parents[1]))
import write_translations

GERMAN = {
    "frame {number} is missing": "Bild {number} fehlt",
    "{path}: {problem}.": "Datei {path}: {problem}!",
    "Give {name!r}, in {unit}.": "{unit}: {name!r} angeben.",
}

DOMAIN_ERRORS = [kind for kind in vars(errors).values() if isinstance(kind, type) and issubclass(kind, AIFReconError)]


def german(template):
    return GERMAN.get(template, template)


def test_a_message_is_the_english_text():
    assert Message("frame {number} is missing", number=3) == "frame 3 is missing"


def test_a_message_is_translated_with_its_values():
    assert Message("Give {name!r}, in {unit}.", name="a", unit="mm").translated(german) == "mm: 'a' angeben."


def test_messages_within_a_message_are_translated_too():
    inner = Message("frame {number} is missing", number=3)
    assert Message("{path}: {problem}.", path="a.mha", problem=inner).translated(german) == "Datei a.mha: Bild 3 fehlt!"


def test_an_error_within_a_message_is_translated_too():
    inner = SettingsError("frame {number} is missing", number=3)
    assert Message("{path}: {problem}.", path="a.mha", problem=inner).translated(german) == "Datei a.mha: Bild 3 fehlt!"


def test_without_values_braces_mean_nothing():
    assert Message("{a: 1} is not JSON") == "{a: 1} is not JSON"
    assert Message("{a: 1} is not JSON").translated(german) == "{a: 1} is not JSON"


def test_values_with_braces_stay_as_they_are():
    assert Message("{path}: {problem}.", path="{0}", problem="{x").translated(german) == "Datei {0}: {x!"


def test_other_values_are_not_translated():
    assert translated(3, german) == 3
    assert translated("frame {number} is missing", german) == "frame {number} is missing"


@pytest.mark.parametrize("kind", DOMAIN_ERRORS)
def test_every_error_keeps_its_template_through_a_process_boundary(kind):
    error = pickle.loads(pickle.dumps(kind("frame {number} is missing", number=3)))
    assert str(error) == "frame 3 is missing"
    assert translated(error, german) == "Bild 3 fehlt"


@pytest.mark.parametrize("kind", DOMAIN_ERRORS)
def test_every_error_comes_back_from_a_worker_of_dask(kind):
    # What Dask does with every kind of error as soon as it is imported
    pytest.importorskip("tblib.pickling_support").install(kind)
    error = pickle.loads(pickle.dumps(kind("frame {number} is missing", number=3)))
    assert translated(error, german) == "Bild 3 fehlt"


def test_an_error_made_of_another_message_keeps_it():
    error = OutputError(SettingsError("frame {number} is missing", number=3).args[0])
    assert translated(error, german) == "Bild 3 fehlt"


@pytest.mark.parametrize(
    "wrong", ["Bild {nummer} fehlt", "Bild fehlt", "Bild {number fehlt", "Bild {number:d} fehlt", "Bild {number!r} fehlt"]
)
def test_a_translation_with_other_placeholders_is_not_used(wrong):
    assert Message("frame {number} is missing", number=3).translated(lambda template: wrong) == "frame 3 is missing"


def test_placeholders_may_change_places():
    swapped = {"{first} before {last}": "{last} nach {first}"}.get
    assert Message("{first} before {last}", first=1, last=2).translated(swapped) == "2 nach 1"


def test_several_messages_are_translated_one_by_one():
    items = listed([Message("frame {number} is missing", number=3), "a.mha", Message("frame {number} is missing", number=4)], "; ")
    assert items == "frame 3 is missing; a.mha; frame 4 is missing"
    assert items.translated(german) == "Bild 3 fehlt; a.mha; Bild 4 fehlt"


def test_nothing_listed_says_nothing():
    assert listed([]) == ""


def test_what_an_error_says_is_the_message_that_it_was_raised_with():
    assert said(SettingsError("frame {number} is missing", number=3)).template == "frame {number} is missing"


def test_what_another_error_says_is_its_text():
    assert said(ValueError("no number")) == "no number"


# ---- in the words of who is spoken to


def test_no_option_of_the_command_line_is_left_in_what_python_is_told():
    sentences, errors_raised = set(), write_translations.error_classes()
    for path in write_translations.python_files(write_translations.LIBRARY):
        if path.relative_to(write_translations.LIBRARY).parts[0] not in write_translations.COMMAND_LINE:
            calls = write_translations.template_calls(ast.parse(path.read_text("utf-8")), errors_raised)
            sentences |= {text for _, template in calls if "--" in (text := write_translations.literal(template) or "")}
    assert len(sentences) > 30
    whole_commands = r"pip install.*|\{command\}.*|aifrecon [^.,;]*"
    assert [text for text in sentences if "--" in re.sub(whole_commands, "", in_python_words(text))] == []


def test_python_and_the_command_line_are_told_the_same_in_their_own_words():
    error = BeamGeometryError("Not known. Give --probe linear, or --probe sector with --apex-px COLUMN ROW.")
    assert str(error) == 'Not known. Give probe=ProbeGeometry("linear"), or probe=ProbeGeometry("sector", (column, row)).'
    assert said(error) == "Not known. Give --probe linear, or --probe sector with --apex-px COLUMN ROW."


def test_the_words_of_a_file_s_name_stay():
    assert (
        str(SettingsError("{path}: too short. Use a smaller --skip.", path="a --skip b.mha"))
        == "a --skip b.mha: too short. Use a smaller skip."
    )


def test_an_error_within_another_is_put_into_the_same_words():
    inner = SettingsError("Give --hole-limit MM.")
    outer = OutputError("{path}: {problem}", path="a.mha", problem=inner)
    assert (str(outer), said(outer)) == ("a.mha: Give hole_limit.", "a.mha: Give --hole-limit MM.")


def test_whole_commands_stay():
    text = "Install it: pip install 'numba>=0.60' --force-reinstall."
    assert str(SettingsError(text)) == text
    assert (
        str(SettingsError("Say it with aifrecon convert --orientation: it mirrors."))
        == "Say it with aifrecon convert --orientation: it mirrors."
    )
