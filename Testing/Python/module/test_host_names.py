"""The stand-ins have no name that Slicer's Python lacks, as told by the running application.

shared/reference/slicer-widgets.json holds what Qt's meta objects and Python's `dir` say of the real widgets. It is Slicer's and not part of
this repository.
"""

from __future__ import annotations

import json
from typing import Any

import pytest

pytest_plugins = ["host_fixture"]

OF_BASE = {"qMRMLLayoutManager": "qSlicerLayoutManager", "qMRMLThreeDWidget": "qMRMLThreeDWidget"}
"""Classes of the list, and the stand-ins that derive from them in Slicer."""


@pytest.fixture(scope="module")
def told(data_dir):
    """Properties, signals and Python names by class, from the application."""
    path = data_dir.parent / "reference" / "slicer-widgets.json"
    if not path.is_file():
        pytest.skip(f"{path} is not there: it was read from the running Slicer")
    return json.loads(path.read_text("utf-8"))["classes"]


@pytest.fixture
def compared(told, host):
    """Pairs of stand-in, or class of Qt, and what was told of it."""
    from host import application, modules, qt_modules, views, widgets_collapsible, widgets_ctk, widgets_qmrml, windows
    from PySide6 import QtWidgets

    known: dict[str, type] = {}
    for module in (widgets_collapsible, widgets_ctk, widgets_qmrml, application, modules, views, windows):
        known |= qt_modules.stand_ins(module)
    pairs = [(known.get(OF_BASE.get(name, name)) or getattr(QtWidgets, name, None), each) for name, each in told.items()]
    return [(kind, each) for kind, each in pairs if kind is not None]


def properties(kind) -> set[str]:
    """The Qt properties of a class."""
    # A class of its own: the wrapper of a class that other tests have used may have gone with their objects
    own: Any = type(kind.__name__, (kind,), {})
    meta = own.staticMetaObject
    return {meta.property(i).name() for i in range(meta.propertyCount())}


def names(kind) -> list[str]:
    """What PythonQt shows of a class; it takes a name with an underscore behind it for the name, which Python may have reserved."""
    from host.pythonqt import is_offered

    return [name for name in dir(kind) if not name.startswith("_") and not name.endswith("_") and is_offered(kind, name)]


def signals(kind) -> dict[str, str]:
    return kind.__dict__.get("api", {}).get("signals", {})


@pytest.mark.parametrize(
    ("offered", "told_as"), [(properties, ["properties"]), (names, ["python_names", "properties"]), (signals, ["signals"])]
)
def test_no_widget_has_what_slicer_s_python_lacks(compared, offered, told_as):
    assert len(compared) >= 18
    excess = {kind.__name__: sorted(set(offered(kind)) - {name for key in told_as for name in each[key]}) for kind, each in compared}
    assert {name: more for name, more in excess.items() if more} == {}
