"""Every visible text can be translated: templates are literal, translators get them all, a made-up language leaves no English."""

from __future__ import annotations

import ast
import importlib.util
import os
import shutil
import string
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

TESTING = Path(__file__).resolve().parents[2]
if str(TESTING) not in sys.path:
    sys.path.insert(0, str(TESTING))

import write_translations as translations  # noqa: E402 - the folder must be known first

SOURCES = [*translations.python_files(translations.LIBRARY), *translations.python_files(translations.MODULE)]
ERRORS = translations.error_classes()

FORGOTTEN = {
    "Reconstruct the volume, and judge tracking, registration and coverage": "a text of the module",
    "Settings": "a string of the .ui file",
    "Recorded": "the title of a tab",
    "{frames}, probe at {speed:.0f} mm/s": "a verdict",
    "{usable} of {frames} frames have a position.": "what is said of the sweep",
    "Reconstructing": "progress",
    "frames used": "the report",
    "Canceled. Nothing was changed.": "what was done",
    "the header ends without {key}: the file is cut short or is no MetaImage. Copy it again.": "an error of the library",
    "waiting to reconnect": "the live panel",
}
"""Texts of every kind that the walk through the panel must meet."""


def calls(path: Path):
    return translations.template_calls(ast.parse(path.read_text(encoding="utf-8")), ERRORS)


def parameters_around(path: Path) -> dict[ast.Call, set[str]]:
    """The parameters of the functions around each call of a file."""
    around: dict[ast.Call, set[str]] = {}

    def visit(node, names):
        if isinstance(node, ast.FunctionDef | ast.Lambda):
            names = names | {each.arg for each in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs)}
        if isinstance(node, ast.Call):
            around[node] = names
        for child in ast.iter_child_nodes(node):
            visit(child, names)

    visit(ast.parse(path.read_text(encoding="utf-8")), set())
    return around


def is_a_template(expression: ast.expr, parameters: set[str]) -> bool:
    """Whether an expression is a text that is spelled out, a message made of one, or what the caller of the function gives."""
    if isinstance(expression, ast.Call):
        return translations.called(expression) in ("Message", "Text")
    return translations.literal(expression) is not None or (isinstance(expression, ast.Name) and expression.id in parameters)


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(translations.REPOSITORY).as_posix())
def test_templates_are_spelled_out(path):
    around = parameters_around(path)
    by_place = {(call.lineno, call.col_offset): names for call, names in around.items()}
    wrong = [call.lineno for call, template in calls(path) if not is_a_template(template, by_place[call.lineno, call.col_offset])]
    assert wrong == [], "write the sentence out, with {names} for its values"


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: path.relative_to(translations.REPOSITORY).as_posix())
def test_templates_name_the_values_that_they_are_given(path):
    for call, template in calls(path):
        text, given = translations.literal(template), {keyword.arg for keyword in call.keywords}
        if text is not None and given and None not in given:
            named = {name for _, name, _, _ in string.Formatter().parse(text) if name is not None}
            assert named == given, f"line {call.lineno}"


@pytest.fixture(scope="module")
def texts() -> translations.Texts:
    """All texts by context."""
    return translations.all_texts()


@pytest.fixture(scope="module")
def lrelease() -> str:
    """Qt's program that compiles translations."""
    pyside = pytest.importorskip("PySide6", reason="PySide6-Essentials is not installed: pip install '.[test]'")
    program = shutil.which("lrelease", path=Path(pyside.__file__).parent)
    if program is None:
        pytest.skip("this PySide6 has no lrelease")
    tried = subprocess.run([program, "-version"], capture_output=True, text=True, check=False)
    if tried.returncode == 127:  # a system library is missing
        pytest.skip(f"lrelease does not start here: {tried.stderr.strip()}. On Debian: apt install libglib2.0-0")
    return program


@pytest.fixture(scope="module")
def written(tmp_path_factory) -> Path:
    """The translators' file."""
    path = tmp_path_factory.mktemp("resources") / "Translations" / translations.TARGET.name
    translations.write(path)
    return path


def test_the_translators_file_holds_every_text(written, texts):
    root = ElementTree.parse(written).getroot()
    read = {(context.findtext("name"), source.text) for context in root.iter("context") for source in context.iter("source")}
    assert read == {(context, text) for context, held in texts.items() for text in held}


def test_qt_reads_the_translators_file(written, texts, lrelease):
    done = subprocess.run([lrelease, written, "-qm", written.with_suffix(".qm")], capture_output=True, text=True, check=True)
    count = sum(map(len, texts.values()))
    assert f"{count} untranslated" in done.stdout


def test_translators_are_told_where_a_text_is(written):
    places = {place.get("filename") for place in ElementTree.parse(written).iter("location")}
    assert [place for place in places if not (translations.TARGET.parent / place).resolve().is_file()] == []


@pytest.mark.parametrize(
    ("context", "text"),
    [
        ("AIFRecon", "AIFRecon: Angle-weighted Ultrasound Reconstruction"),
        ("AIFRecon", "Plus configuration (*.xml)"),
        ("qSlicerAbstractCoreModule", "Ultrasound"),
        ("AIFReconGui.longWork", "Canceled. Nothing was changed."),
        ("AIFReconLib", "{name}: no frame has a position ({reasons}). Check the tracking of this recording."),
        ("AIFReconLib", "Filling gaps"),
        ("AIFReconLib", "waiting to reconnect"),
    ],
)
def test_texts_of_every_kind_are_found(context, text, texts):
    assert text in texts[context]


@pytest.mark.parametrize("text", ["{path}: {problem}", " > ", "{share:.1f}%"])
def test_what_has_no_words_is_left_out(text):
    assert not translations.has_words(text)


def walk(*arguments: str) -> subprocess.CompletedProcess:
    """The panel in a made-up language."""
    for package, name in (("PySide6", "PySide6-Essentials"), ("slicer", "slicer-core")):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{name} is not installed: pip install '.[test]'")
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "PYTHONIOENCODING": "utf-8"}
    done = subprocess.run(
        [sys.executable, "Testing/host/translated_panel.py", *arguments],
        cwd=translations.REPOSITORY,
        env=environment,
        capture_output=True,
        encoding="utf-8",
        errors="replace",
        timeout=600,
    )
    if done.returncode == 2 and "cannot be shown here" in done.stderr:
        pytest.skip(done.stderr.strip().splitlines()[-1])
    return done


def test_nothing_in_the_panel_stays_in_english():
    done = walk()
    assert (done.returncode, done.stdout) == (0, ""), done.stderr[-3000:]


def test_texts_that_are_not_translated_are_noticed():
    done = walk(*(word for text in FORGOTTEN for word in ("--forget", text)))
    assert done.returncode == 1, done.stderr[-3000:]
    missed = [kind for text, kind in FORGOTTEN.items() if not all(part in done.stdout for part in visible(text))]
    assert missed == []


def visible(text: str) -> list[str]:
    """What of a text is seen whatever its values are, in the case that the panel gives it."""
    parts = [part for part, *_ in string.Formatter().parse(text) if part.strip()]
    return [part[1:] for part in parts]


LANGUAGES = sorted((translations.MODULE / "Resources" / "Translations").glob("AIFRecon_*.ts"))
FIRST_SCREEN = (
    *("tabWidget", "openButton", "sampleButton", "sweepLabel", "otherSweepsLabel", "ctLabel", "boneLabel", "segmentsLabel", "applyButton"),
    *("placeButton", "trackingMoreButton", "settingsCollapsibleButton", "liveStartButton", "livePauseButton", "liveStopButton"),
    *(
        "liveResetButton",
        "liveUseBoxButton",
        "livePlaceButton",
        "liveRecordCheckBox",
        "liveGuidanceCheckBox",
        "connectionCollapsibleButton",
    ),
)
"""Widgets of both tabs that are seen before anything was opened."""


def sentences(path: Path) -> dict[tuple[str, str], str]:
    """Context and text to translation, of a .ts file."""
    contexts = ElementTree.parse(path).getroot().iter("context")
    return {
        (each.findtext("name", ""), message.findtext("source", "")): message.findtext("translation", "")
        for each in contexts
        for message in each.iter("message")
    }


def test_german_french_spanish_and_chinese_are_begun():
    assert [path.stem.partition("_")[2] for path in LANGUAGES] == ["de-DE", "es-ES", "fr-FR", "zh-CN"]


@pytest.mark.parametrize("path", LANGUAGES, ids=lambda path: path.stem)
def test_a_language_has_the_first_screen_and_nothing_that_is_no_longer_said(path):
    known, texts = sentences(path), translations.all_texts()
    assert [text for context, text in known if text not in texts.get(context, ())] == []
    root = ElementTree.parse(translations.MODULE / "Resources" / "UI" / "AIFRecon.ui").getroot()
    shown = [widget.find("property[@name='text']/string") for widget in root.iter("widget") if widget.get("name") in FIRST_SCREEN]
    tabs = [attribute.find("string") for attribute in root.iter("attribute") if attribute.get("name") == "title"]
    said = [each.text or "" for each in (*shown, *tabs) if each is not None]
    assert len(said) > 20
    assert [text for text in said if ("AIFRecon", text) not in known] == []


@pytest.mark.parametrize("path", LANGUAGES, ids=lambda path: path.stem)
def test_a_language_keeps_every_placeholder(path):
    def places(text):
        return sorted((name, form) for _, name, form, _ in string.Formatter().parse(text) if name is not None)

    assert [text for (_, text), said in sentences(path).items() if places(text) != places(said) or not said] == []


@pytest.mark.parametrize("path", LANGUAGES, ids=lambda path: path.stem)
def test_qt_speaks_the_language_once_it_is_compiled(path, tmp_path, lrelease):
    compiled = tmp_path / "language.qm"
    subprocess.run([lrelease, path, "-qm", compiled], capture_output=True, check=True)
    from PySide6 import QtCore

    translator = QtCore.QTranslator()
    assert translator.load(str(compiled))
    known = sentences(path)
    assert {key: translator.translate(*key) for key in known} == known
