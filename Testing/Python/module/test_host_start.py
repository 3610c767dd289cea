"""The host starts modules as Slicer does: made in the order of their names, loaded when all are made, told when it is done."""

from __future__ import annotations

import pytest

pytest_plugins = ["host_fixture"]

MODULE = """
import slicer
from slicer.ScriptedLoadableModule import ScriptedLoadableModule

log = []


def look(moment):
    there = [name for name in ("vtkMRMLScalarVolumeNode", "vtkMRMLSequenceBrowserNode") if hasattr(slicer, name)]
    log.append((moment, *there, *(name for name in ("sequences",) if hasattr(slicer.modules, name))))


look("imported")
{extra}


class {name}(ScriptedLoadableModule):
    def __init__(self, parent):
        ScriptedLoadableModule.__init__(self, parent)
        parent.title = "{name}"
        parent.dependencies = {dependencies}
        look("made")
        slicer.app.connect("startupCompleted()", lambda: look("started"))

    def setup(self):
        look("set up")
"""

CORE, LOADABLE = "vtkMRMLScalarVolumeNode", "vtkMRMLSequenceBrowserNode"


@pytest.fixture
def write(host, tmp_path):
    """Writes a module that notes what there is at each moment of its life; all are unloaded afterwards."""
    names = []

    def written(name, extra="", dependencies=()):
        names.append(name)
        path = tmp_path / f"{name}.py"
        path.write_text(MODULE.format(name=name, extra=extra, dependencies=list(dependencies)), "utf-8")
        return path

    yield written
    import sys

    import slicer

    for name in names:
        if hasattr(slicer.modules, name.lower()):
            host.unload_module(name)
        sys.modules.pop(name, None)


def moments(name):
    import importlib

    return {moment: there for moment, *there in importlib.import_module(name).log}


def test_a_module_that_comes_before_a_loadable_one_finds_none_of_its_classes(host, write):
    host.start(write("Aaa"))
    assert moments("Aaa")["imported"] == moments("Aaa")["made"] == [CORE]


def test_a_module_that_comes_after_a_loadable_one_finds_its_classes(host, write):
    host.start(write("Zzz"))
    assert moments("Zzz")["imported"] == [CORE, LOADABLE]


def test_importing_a_class_too_early_fails_as_in_slicer(host, write):
    import slicer

    with pytest.raises(ImportError, match="cannot import name 'vtkMRMLSequenceBrowserNode' from 'slicer'"):
        host.start(write("Aaa", "from slicer import vtkMRMLSequenceBrowserNode"))
    assert hasattr(slicer, LOADABLE)
    assert hasattr(slicer.modules, "sequences")


def test_sample_data_is_not_there_before_its_turn(host, write):
    with pytest.raises(ImportError, match="SampleData"):
        host.start(write("Aaa", "import SampleData"))


def test_all_classes_are_there_when_a_module_is_set_up(host, write):
    host.start(write("Aaa"))
    assert moments("Aaa")["set up"] == [CORE, LOADABLE]


def test_what_a_module_depends_on_is_loaded_before_it(host, write):
    host.start(write("Aaa", dependencies=["Sequences"]))
    assert moments("Aaa")["set up"] == [CORE, LOADABLE, "sequences"]


def test_a_module_that_depends_on_one_that_is_not_there_is_refused(host, write):
    with pytest.raises(LookupError, match="Nothing"):
        host.start(write("Aaa", dependencies=["Nothing"]))


def test_startup_is_told_when_all_modules_are_loaded(host, write):
    host.start(write("Aaa"))
    assert moments("Aaa")["started"] == [CORE, LOADABLE, "sequences"]


def test_a_module_that_is_loaded_later_finds_everything_and_is_not_told(host, write):
    host.load_module(write("Aaa"))
    assert moments("Aaa")["imported"] == [CORE, LOADABLE, "sequences"]
    assert "started" not in moments("Aaa")
