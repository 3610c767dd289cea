"""The Slicer module as files: what CMake packages, what Qt Designer holds, what is imported at start-up. Slicer is not needed here."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from AIFReconLib.recipe.recipe import RULES

REPOSITORY = Path(__file__).resolve().parents[3]
MODULE = REPOSITORY / "AIFRecon"
MODULE_FILES = sorted(MODULE.rglob("*.py"))
UI = ElementTree.parse(MODULE / "Resources" / "UI" / "AIFRecon.ui").getroot()
WIDGETS = {widget.get("name"): widget for widget in UI.iter("widget")}
PASSIVE = {"QLabel", "qMRMLWidget", "ctkCollapsibleButton", "QWidget", "QFrame", "QTabWidget", "ctkCollapsibleGroupBox", "QProgressBar"}
HEAVY = {"scipy", "SimpleITK", "matplotlib", "numba", "pyigtl"}
LABELS = {re.sub("_(.)", lambda found: found[1].upper(), name): rule["label"] for name, rule in RULES.items() if rule["label"]}
"""Of the fields of the library's settings, by the names of the panel's parameters."""


def name_of(path: Path) -> str:
    return path.relative_to(REPOSITORY).as_posix()


def listed(cmake: Path, variable: str) -> list[str]:
    """What a CMake file sets a list to."""
    found = re.findall(rf"set\({variable}\n(.*?)\n\s*\)", cmake.read_text("utf-8"), re.DOTALL)
    return [line.strip().replace("${MODULE_NAME}", "AIFRecon") for line in found[0].splitlines()]


def relative(folder: Path, files) -> list[str]:
    return sorted(path.relative_to(folder).as_posix() for path in files if "__pycache__" not in path.parts)


def property_of(widget, name: str) -> str | None:
    """Text of a widget's property in the .ui file."""
    found = widget.find(f"property[@name='{name}']")
    return None if found is None else "".join(found.itertext()).strip()


def imports_of(nodes) -> set[str]:
    """The packages that some statements import."""
    packages = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            packages |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            packages.add((node.module or "").split(".")[0])
    return packages


@pytest.mark.parametrize(
    ("folder", "variable", "kinds"),
    [
        ("AIFReconLib", "MODULE_PYTHON_SCRIPTS", ["*.py"]),
        ("AIFReconLib", "MODULE_PYTHON_RESOURCES", ["*.json", "*.css", "*.html", "*.pyi"]),
        ("AIFRecon", "MODULE_PYTHON_SCRIPTS", ["*.py"]),
        ("AIFRecon", "MODULE_PYTHON_RESOURCES", ["Resources/**/*.*"]),
    ],
)
def test_every_file_is_packaged(folder, variable, kinds):
    root = REPOSITORY / folder
    files = [path for kind in kinds for path in root.rglob(kind) if path.is_file()]
    assert sorted(listed(root / "CMakeLists.txt", variable)) == relative(root, files)


def test_every_self_test_is_registered():
    folder = REPOSITORY / "Testing" / "Slicer"
    registered = re.findall(r"slicer_add_python_unittest\(SCRIPT (\S+)\)", (folder / "CMakeLists.txt").read_text("utf-8"))
    assert sorted(registered) == relative(folder, folder.glob("*Test.py"))


@pytest.mark.parametrize("path", MODULE_FILES, ids=name_of)
def test_a_file_of_the_module_starts_light_is_short_and_completes_texts_after_their_translation(path):
    """And the files that know the scene know no Qt."""
    text = path.read_text("utf-8")
    tree = ast.parse(text)
    assert imports_of(tree.body) & HEAVY == set()
    if "AIFReconScene" in path.parts:
        assert imports_of(ast.walk(tree)) & {"qt", "ctk", "PySide6"} == set()
    assert len(text.splitlines()) < 400
    translated = [node for node in ast.walk(tree) if isinstance(node, ast.Call) and ast.unparse(node.func) == "_"]
    assert [call.lineno for call in translated if not all(isinstance(argument, ast.Constant) for argument in call.args)] == []


def test_what_the_module_imports_of_the_library_loads_nothing_that_computes():
    """That is the worker's; compiled code in Slicer's own process could end it."""
    nodes = [node for path in MODULE_FILES for node in ast.walk(ast.parse(path.read_text("utf-8"))) if isinstance(node, ast.ImportFrom)]
    names = sorted({node.module for node in nodes if node.level == 0 and (node.module or "").startswith("AIFReconLib.")})
    code = "import importlib, sys\nfor name in sys.argv[1:]:\n    importlib.import_module(name)\n    heavy = {heavy} & set(sys.modules)\n"
    code += "    assert not heavy, (name, heavy)"
    heavy = {"scipy", "SimpleITK", "numba", "onnxruntime", "matplotlib", "vtkmodules"}
    assert "AIFReconLib.worker.reconstructing" in names
    done = subprocess.run(
        [sys.executable, "-c", code.replace("{heavy}", repr(heavy)), *names], cwd=REPOSITORY, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("name", [name for name, widget in WIDGETS.items() if widget.get("class") not in PASSIVE])
def test_a_widget_says_what_it_is_for(name):
    assert property_of(WIDGETS[name], "toolTip")


@pytest.mark.parametrize("name", [name for name, widget in WIDGETS.items() if widget.attrib["class"].startswith("qMRMLNode")])
def test_a_node_selector_is_given_the_scene(name):
    receivers = [
        connection.findtext("receiver")
        for connection in UI.iter("connection")
        if connection.findtext("signal") == "mrmlSceneChanged(vtkMRMLScene*)"
        and connection.findtext("slot") == "setMRMLScene(vtkMRMLScene*)"
        and connection.findtext("sender") == "AIFRecon"
    ]
    assert name in receivers


def test_every_input_and_section_is_in_the_tab_order_from_top_to_bottom():
    stops = [name for name, widget in WIDGETS.items() if widget.get("class") not in PASSIVE or "Collapsible" in widget.get("class")]
    assert [stop.text for stop in UI.iter("tabstop")] == stops


def test_a_bound_widget_names_a_parameter_that_no_other_one_has():
    tree = ast.parse((MODULE / "AIFReconGui" / "parameterNode.py").read_text("utf-8"))
    node = next(node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == "AIFReconParameterNode")
    parameters = {*LABELS, *(field.target.id for field in node.body if isinstance(field, ast.AnnAssign))}
    bound = [name for widget in WIDGETS.values() if (name := property_of(widget, "SlicerParameterName"))]
    assert set(bound) - parameters == set()
    assert len(bound) == len(set(bound))


@pytest.mark.parametrize("name", [name for name in LABELS if f"{name}Label" in WIDGETS])
def test_a_setting_is_called_as_the_library_calls_it(name):
    assert property_of(WIDGETS[f"{name}Label"], "text") == LABELS[name]


def test_every_custom_widget_is_declared():
    declared = {custom.findtext("class") for custom in UI.iter("customwidget")}
    assert {name for widget in WIDGETS.values() if (name := widget.get("class"))[0] in "qc"} == declared
