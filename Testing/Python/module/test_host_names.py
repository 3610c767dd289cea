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


def excess(compared, offered, allowed) -> dict:
    """By class: what is offered beyond what is allowed."""
    found = {kind.__name__: sorted(set(offered(kind)) - set(allowed(each))) for kind, each in compared}
    return {name: names for name, names in found.items() if names}


def properties(kind) -> set[str]:
    """The Qt properties of a class."""
    # A class of its own: the wrapper of a class that other tests have used may have gone with their objects
    own: Any = type(kind.__name__, (kind,), {})
    meta = own.staticMetaObject
    return {meta.property(i).name() for i in range(meta.propertyCount())}


def test_most_of_the_classes_are_compared(compared):
    assert len(compared) >= 18


def test_no_widget_has_a_property_that_slicer_s_lacks(compared):
    assert excess(compared, properties, lambda each: each["properties"]) == {}


def test_no_widget_answers_to_a_name_that_slicer_s_python_lacks(compared):
    from host.pythonqt import is_offered

    def offered(kind):
        # PythonQt takes a name with an underscore behind it for the name, which Python may have reserved
        return [name for name in dir(kind) if not name.startswith("_") and not name.endswith("_") and is_offered(kind, name)]

    assert excess(compared, offered, lambda each: [*each["python_names"], *each["properties"]]) == {}


def test_no_widget_has_a_signal_that_slicer_s_lacks(compared):
    assert excess(compared, lambda kind: kind.__dict__.get("api", {}).get("signals", {}), lambda each: each["signals"]) == {}


def test_a_name_that_only_pyside_has_is_refused(host, qt):
    with pytest.raises(AttributeError, match="isTopLevel"):
        qt.QLabel("words").isTopLevel  # noqa: B018 - asking for it is the test
