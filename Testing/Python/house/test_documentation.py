"""README.md and docs/ tell the truth: every command runs, every option, file, link and name exists."""

from __future__ import annotations

import ast
import importlib
import re
import shutil
import signal
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest
from doc_pages import PAGES, REPOSITORY, ROOTS, SOURCES, Block, anchors, blocks, code_spans, emphasized, first_column, links, name_of, paths
from doc_workplace import make_workplace, serve
from measured import FOLDER as MEASURED
from measured import pages as pages_of_measured
from measured import renewed

from AIFReconLib.commands.parser import COMMANDS, main, parser_of
from AIFReconLib.compounding.methods.table import METHODS, OWN_METHOD
from AIFReconLib.recipe.recipe import DEFAULT_SPACING, ReconstructionSettings

LONG_RUNNING = {
    "demo": "commands/test_demo.py",
    "benchmark": "commands/test_benchmark.py",
    "simulate": "commands/test_demo.py",
    "register": "commands/test_register_command.py",
    "calibrate": "commands/test_calibrate_command.py",
    "plan": "guidance/test_plan.py",
    "batch": "batch/test_batch_command.py",
}
"""Commands that are only parsed here, for they take long or more than the workplace's made-up images, and where they are run."""

BLOCKS = [block for page in PAGES for block in blocks(page)]
SHELL = [block for block in BLOCKS if block.commands()]
PYTHON = [block for block in BLOCKS if block.language == "python"]
GUIDES = [REPOSITORY / "docs" / f"{name}.md" for name in ("slicer", "slicer-data", "slicer-live")]
OF_SLICER = {"Edit", "Application Settings", "Modules", "Additional module paths", "Extensions Manager", "Install from file"}
"""Menus and labels that the guide names and that are Slicer's own."""


PARSERS = {name: parser_of(name) for name in COMMANDS}
OPTIONS = {name: set(parser.spelled) for name, parser in PARSERS.items()}
CHOICES = {
    **{
        word: set(each.words["choices"])
        for parser in PARSERS.values()
        for word, each in parser.spelled.items()
        if each.words.get("choices")
    },
    "--method": {*METHODS, OWN_METHOD},
}
EVERY_OPTION = set().union(*OPTIONS.values()) | {"--version"}


def aifrecon(words: list[str]) -> list[str] | None:
    """The arguments of `aifrecon`, however it is called; None for another program."""
    if words[0] == "aifrecon":
        return words[1:]
    if "AIFReconLib" in words:
        return words[words.index("AIFReconLib") + 1 :]
    return None


def unknown_options(arguments: list[str]) -> list[str]:
    """Options that the command does not have; the command itself where that does not exist."""
    command, *rest = arguments
    if command.startswith("-"):
        return [word for word in arguments if word not in EVERY_OPTION | {"--help"}]
    if command not in OPTIONS:
        return [command]
    given = {word for argument in rest for word in re.findall(r"(?<![\w-])--[a-z][a-z-]*", argument.split("=")[0])}
    return sorted(given - OPTIONS[command])


def make_targets() -> set[str]:
    """What the Makefile can make."""
    return set(re.findall(r"^([a-z][\w-]*):", (REPOSITORY / "Makefile").read_text("utf-8"), flags=re.MULTILINE))


@pytest.fixture(scope="session")
def originals(tmp_path_factory) -> Path:
    """The files of all commands, made once."""
    return make_workplace(tmp_path_factory.mktemp("workplace"))


@pytest.fixture
def workplace(originals, tmp_path, monkeypatch) -> Path:
    """A copy of them, which is the current folder."""
    folder = tmp_path / "here"
    shutil.copytree(originals, folder)
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(folder)
    return folder


def run_live(arguments: list[str], folder: Path) -> None:
    """`aifrecon live` against our own server, and with an end."""
    server = serve(folder)
    try:
        here = ["--host", "127.0.0.1", "--port", str(server.port), "--frames", "5", "--scout-seconds", "0.1"]
        assert main([*arguments, *here]) == 0
    finally:
        server.stop()


def run_replay(arguments: list[str]) -> None:
    """`aifrecon replay` in a process of its own, on a free port, until it listens."""
    command = [sys.executable, "-m", "AIFReconLib", *arguments, "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None
        said = process.stdout.readline()
        process.send_signal(signal.SIGINT) if sys.platform != "win32" else process.terminate()
    assert said.startswith("Listening on 127.0.0.1"), said


@pytest.mark.parametrize("block", SHELL, ids=lambda block: block.name)
def test_every_command_runs(block: Block, workplace, capsys):
    for words in block.commands():
        arguments = aifrecon(words)
        if arguments is None:
            continue
        assert unknown_options(arguments) == []
        if any("[" in word for word in arguments):  # an overview of the options, not a command
            continue
        PARSERS[arguments[0]].parse(arguments[1:])
        if arguments[0] == "live":
            run_live(arguments, workplace)
        elif arguments[0] == "replay":
            run_replay(arguments)
        elif arguments[0] not in LONG_RUNNING:
            assert main(arguments) == 0, capsys.readouterr().err


def test_every_make_target_and_extra_of_a_command_exists():
    words = [command for block in SHELL for command in block.commands()]
    wanted = {word for command in words if command[0] == "make" for word in command[1:] if "=" not in word}
    assert wanted - make_targets() == set()
    project = (REPOSITORY / "pyproject.toml").read_text("utf-8")
    extras = {extra for command in words for word in command for extra in re.findall(r"^(?:\.|aifrecon)\[([\w,]+)\]$", word)}
    assert [extra for extra in extras if not re.search(rf"^{extra} = \[", project, flags=re.MULTILINE)] == []


# The sweep of the workplace is of no patient
@pytest.mark.filterwarnings("ignore::AIFReconLib.errors.DisagreementWarning")
@pytest.mark.parametrize("block", [block for block in PYTHON if "AIFReconLogic" not in block.text], ids=lambda block: block.name)
def test_every_python_block_runs(block: Block, workplace):
    exec(compile(block.text, block.name, "exec"), {})
    assert (workplace / "volume.nrrd").stat().st_size > 0


def test_what_is_only_parsed_here_is_run_elsewhere():
    assert [name for name, file in LONG_RUNNING.items() if not (REPOSITORY / "Testing" / "Python" / file).is_file()] == []
    assert set(LONG_RUNNING) <= set(OPTIONS)


def test_every_link_leads_somewhere():
    broken = []
    for page in PAGES:
        for link in links(page):
            path, _, anchor = link.partition("#")
            target = (page.parent / path).resolve() if path else page
            if not re.match(r"[a-z]+:", path) and (not target.exists() or (anchor and anchor not in anchors(target))):
                broken.append(f"{name_of(page)}: {link}")
    assert broken == []


def wrong_in_running_text(page: Path) -> list[str]:
    """Commands, options, choices, make targets and paths that a page names and that do not exist."""
    spans = code_spans(page)
    options = {word for span in spans for word in re.findall(r"^--[a-z][a-z-]*", span)} - EVERY_OPTION
    commands = [bad for span in spans if re.match(r"aifrecon [a-z]", span) for bad in unknown_options(span.split()[1:])]
    pairs = [span.split() for span in spans if re.fullmatch(r"--[a-z-]+ [a-z][\w-]*", span)]
    choices = [choice for option, choice in pairs if CHOICES.get(option) and choice not in CHOICES[option]]
    made = {span.split()[1] for span in spans if re.match(r"make [a-z]", span)} - make_targets()
    missing = [path for path in paths(page) if not any((root / path).exists() for root in ROOTS)]
    return [*commands, *sorted(options), *choices, *sorted(made), *missing]


def test_everything_that_pages_docstrings_and_the_gallery_name_exists():
    assert {name_of(source): wrong for source in [*PAGES, *SOURCES] if (wrong := wrong_in_running_text(source))} == {}


def test_the_table_of_parameters_states_option_default_and_range_of_their_fields():
    page = (REPOSITORY / "docs" / "parameters.md").read_text("utf-8")
    rows = re.findall(r"^\| `(--[a-z-]+)` \| `([a-z_]+)` \| (.+?) \| (.+?) \|$", page, re.MULTILINE)
    rules = {spec.name: spec.metadata for spec in fields(ReconstructionSettings)}
    number = r"[0-9.]+(?:e-?[0-9]+)?"
    assert {"alpha", "beta", "bone_gain", "weight_floor", "hole_limit", "spacing"} <= {field for _, field, _, _ in rows}
    for option, field, default, bounds in rows:
        if field != "method":
            rule = rules[field]
            assert option == "--" + field.replace("_", "-")
            expected = DEFAULT_SPACING if field == "spacing" else rule["default"]
            shown = "none" if expected is None else f"`{expected}`" if isinstance(expected, str) else expected
            assert (default if isinstance(shown, str) else float(re.findall(number, default)[0])) == shown
            limits = [n for n in (rule["minimum"], rule["maximum"]) if n is not None]
            choices = tuple(re.findall(r"`([^`]+)`", bounds))
            assert choices == rule["choices"] if rule["choices"] else [float(n) for n in re.findall(number, bounds)] == limits


def test_everything_that_the_gallery_imports_exists():
    texts = [source.read_text("utf-8") for source in SOURCES if source.parent.name == "examples"]
    for node in (node for text in texts for node in ast.walk(ast.parse(text))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("AIFReconLib"):
            module = importlib.import_module(node.module)
            assert [alias.name for alias in node.names if not hasattr(module, alias.name)] == []


def test_every_room_has_a_page_in_the_api_reference():
    tree = ast.parse((REPOSITORY / "docs" / "site" / "api_pages.py").read_text("utf-8"))
    [rooms] = [node.value for node in tree.body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "ROOMS"]
    listed = [word.value for word in ast.walk(rooms) if isinstance(word, ast.Constant)]
    library = REPOSITORY / "AIFReconLib"
    there = {path.stem for path in library.iterdir() if path.suffix == ".py" or (path / "__init__.py").is_file()} - {"__init__", "__main__"}
    assert (sorted(listed), len(listed)) == (sorted(there), len(set(listed)))


@pytest.mark.parametrize("head", ["Method", ""], ids=["in words", "as formulas"])
def test_the_tables_of_methods_are_complete(head):
    assert sorted(first_column(REPOSITORY / "docs" / "method.md", head)) == sorted(METHODS)


def test_what_was_measured_stands_in_the_pages_as_the_machine_wrote_it():
    stands = [page for page in pages_of_measured() if renewed(text := page.read_text("utf-8")) != text]
    assert stands == [], "run: python Testing/measured.py"
    shown = {name for page in pages_of_measured() for name in re.findall(r"<!-- measured: ([\w-]+) -->", page.read_text("utf-8"))}
    assert shown == {path.stem for path in MEASURED.glob("*.md")}


def test_the_table_of_commands_is_complete():
    listed = [span.removeprefix("aifrecon ") for span in first_column(REPOSITORY / "docs" / "index.md", "Command")]
    assert sorted(listed) == sorted(OPTIONS)


@pytest.mark.parametrize("guide", GUIDES, ids=name_of)
def test_every_label_that_the_guide_names_is_in_the_panel(guide):
    sources = [path for suffix in ("*.py", "*.ui") for path in (REPOSITORY / "AIFRecon").rglob(suffix)]
    words = " ".join(path.read_text("utf-8") for path in sources).replace("&amp;", "").lower()
    named = [part.strip() for label in emphasized(guide) for part in label.split(">")]
    assert [label for label in named if label not in OF_SLICER and label.lower() not in words] == []


def test_every_page_of_docs_is_on_the_map():
    on_the_map = {(REPOSITORY / "docs" / link.partition("#")[0]).resolve() for link in links(REPOSITORY / "docs" / "index.md")}
    assert [
        name_of(page) for page in PAGES if page.parent.name in ("docs", "decisions") and page.name != "index.md" and page not in on_the_map
    ] == []


def test_every_page_of_docs_is_in_the_site_s_menus():
    tree = ast.parse((REPOSITORY / "docs" / "site" / "conf.py").read_text("utf-8"))
    [tables] = [node.value for node in tree.body if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "TABLES"]
    listed = {word.value for word in ast.walk(tables) if isinstance(word, ast.Constant)}
    assert [page.stem for page in PAGES if page.parent.name == "docs" and page.stem != "index" and page.stem not in listed] == []


SAYS_THE_MARKED_SIDE = re.compile(r"\b([MU])[FN][AD]?\b[^.|]*?\bmarked side\b[^.|]*?\b(left|right)\b")


def test_the_marked_side_is_where_columns_increase_to_wherever_a_page_or_docstring_says_it():
    texts = [*PAGES, *SOURCES, *(REPOSITORY / "Resources").rglob("*.xml")]
    said = {path.name: SAYS_THE_MARKED_SIDE.findall(" ".join(path.read_text("utf-8").split())) for path in texts}
    assert {pair for pairs in said.values() for pair in pairs} == {("M", "right"), ("U", "left")}, said


# ---- the checks themselves can fail


def test_what_does_not_exist_is_seen(tmp_path):
    assert unknown_options(["reconstruct", "sweep.igs.mha", "--spacing", "1", "--spcaing", "2"]) == ["--spcaing"]
    assert unknown_options(["info", "sweep.igs.mha", "--hole-limit", "1"]) == ["--hole-limit"]
    source = tmp_path / "source.py"
    source.write_text('def f():\n    """See `--no-such-option`, ``aifrecon reconstrut`` and `make nothing`."""\n', "utf-8")
    assert wrong_in_running_text(source) == ["reconstrut", "--no-such-option", "nothing"]
