"""What could execute, unpickle or fetch input is not in the code at all, or only where it is known to be harmless."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]
FILES = [path for folder in ("AIFReconLib", "AIFRecon") for path in sorted((REPOSITORY / folder).rglob("*.py"))]

PACKAGES = frozenset(
    [
        "pickle", "cPickle", "dill", "joblib", "marshal", "shelve", "pty", "code", "codeop", "runpy", "xmlrpc", "http", "ftplib", "smtplib",
        "telnetlib", "urllib.request", "requests", "httpx", "aiohttp", "webbrowser", "yaml", "xml.sax.expatreader", "xml.sax.make_parser",
        "xml.sax.parse", "xml.dom", "lxml", "h5py", "multiprocessing.managers",
    ]
)  # fmt: skip
"""None of these is needed, and each can do with its input what input must not do."""

CALLS = frozenset(
    [
        "eval", "exec", "compile", "__import__", "input", "os.system", "os.popen", "os.execv", "os.execvp", "os.spawnv", "os.startfile",
        "ElementTree.parse", "ElementTree.fromstring", "ElementTree.XML",
    ]
)  # fmt: skip

ALLOWED = {
    # ffmpeg, told to follow nothing; test_security.py
    ("AIFReconLib/io/foreign/video.py", "subprocess"),
    # this Python, for a model that must end nobody else
    ("AIFReconLib/bone/onnx_process.py", "subprocess"),
    # this Python, for ITK's reader of HDF5, which crashes
    ("AIFReconLib/io/transform/hdf5.py", "subprocess"),
    # how it is started
    ("AIFReconLib/machine/processes.py", "subprocess"),
    # the error of a failed installation is caught, nothing is started
    ("AIFRecon/AIFReconGui/packages.py", "subprocess"),
}


def name_of(path: Path) -> str:
    return path.relative_to(REPOSITORY).as_posix()


def called(node: ast.Call) -> str:
    return ast.unparse(node.func)


def keyword(node: ast.Call, name: str) -> ast.expr | None:
    return next((word.value for word in node.keywords if word.arg == name), None)


def is_false(node: ast.expr | None) -> bool:
    return isinstance(node, ast.Constant) and node.value is False


def imported(tree: ast.AST) -> set[str]:
    """Dotted names of everything imported, and of what is imported from it."""
    names = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            names |= {node.module or "", *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


def forbidden(path: str, tree: ast.AST) -> list[str]:
    """What must not be there, each with its line."""
    found = []
    for name in sorted(imported(tree)):
        if any(name == package or name.startswith(f"{package}.") for package in PACKAGES):
            found.append(f"import {name}")
        if name.split(".")[0] == "subprocess" and (path, "subprocess") not in ALLOWED:
            found.append(f"import {name}")
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = called(node)
        if name in CALLS:
            found.append(f"{node.lineno}: {name}")
        if name in ("np.load", "numpy.load", "np.save", "numpy.save", "np.savez") and not is_false(keyword(node, "allow_pickle")):
            found.append(f"{node.lineno}: {name} without allow_pickle=False")
        if (shell := keyword(node, "shell")) is not None and not is_false(shell):
            found.append(f"{node.lineno}: {name} with shell")
        if name.endswith(".open") and "image" in name.lower() and keyword(node, "formats") is None:
            found.append(f"{node.lineno}: {name} without formats")
    return found


@pytest.mark.parametrize("path", FILES, ids=name_of)
def test_nothing_in_the_code_could_execute_or_fetch_input(path):
    assert forbidden(name_of(path), ast.parse(path.read_text("utf-8"))) == []


def test_what_is_allowed_is_still_needed():
    """An exception that nobody needs any more is a gap."""
    needed = {
        (name_of(path), "subprocess")
        for path in FILES
        if any(name.split(".")[0] == "subprocess" for name in imported(ast.parse(path.read_text("utf-8"))))
    }
    assert needed == ALLOWED


@pytest.mark.parametrize(
    "text",
    [
        "import pickle",
        "from urllib.request import urlopen",
        "from urllib import request",
        "import subprocess",
        "def f():\n    import http.client",
        "eval(text)",
        "np.load(path)",
        "np.load(path, allow_pickle=True)",
        "run(['a'], shell=True)",
        "image_module.open(path)",
    ],
)
def test_the_rule_sees_it(text):
    assert forbidden("AIFReconLib/some.py", ast.parse(text)) != []


@pytest.mark.parametrize(
    "text", ["np.load(path, allow_pickle=False)", "from urllib.parse import unquote", "run(['a'], shell=False)", "expression.compile()"]
)
def test_the_rule_lets_it_pass(text):
    assert forbidden("AIFReconLib/some.py", ast.parse(text)) == []
