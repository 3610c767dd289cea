"""A scripted module lives on the host as in Slicer: loaded, opened, left, reloaded, its scene closed, unloaded."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
import tiny_module

pytest_plugins = ["host_fixture"]
RUNNER = Path(__file__).resolve().parents[2] / "host" / "run_self_tests.py"


@pytest.fixture
def module(host, tmp_path):
    """The small module, loaded; unloaded afterwards."""
    yield host.load_module(tiny_module.write_module(tmp_path))
    host.leave()
    host.unload_module("Tiny")


@pytest.fixture
def widget(host, module):
    """Its panel, opened."""
    return host.open("Tiny")


@pytest.fixture
def parameters(widget):
    """Its parameters."""
    return widget._parameterNode


def test_the_application_reads_what_the_module_says_of_itself(module):
    assert (module.name, module.title, module.categories) == ("Tiny", "Tiny", ("Examples",))


def test_the_module_is_found_by_its_lower_case_name(module):
    import slicer

    assert slicer.modules.tiny is module
    assert slicer.util.getModule("Tiny") is module


def test_opening_a_module_builds_its_panel_once(host, widget):
    host.leave()
    assert host.open("Tiny") is widget
    assert widget.log == ["setup", "enter", "exit", "enter"]


def test_the_panel_knows_whether_it_is_open(host, widget):
    inside = widget.parent.isEntered
    host.leave()
    assert (inside, widget.parent.isEntered) == (True, False)


def test_closing_the_scene_is_told(widget):
    import slicer

    slicer.mrmlScene.Clear()
    assert widget.log[-2:] == ["StartClose", "EndClose"]


def test_after_the_scene_closed_the_parameters_are_defaults_again(widget, parameters):
    import slicer

    parameters.count = 8
    slicer.mrmlScene.Clear()
    assert widget._parameterNode.count == 3


def test_reloading_makes_a_new_panel_and_ends_the_old_one(widget):
    import slicer

    widget.onReload()
    assert widget.log[-1] == "cleanup"
    assert slicer.modules.TinyWidget is not widget


def test_unloading_a_module_ends_its_panel(host, tmp_path):
    host.load_module(tiny_module.write_module(tmp_path))
    widget = host.open("Tiny")
    host.unload_module("Tiny")
    assert widget.log[-1] == "cleanup"


def test_a_mistake_in_a_module_reaches_the_test(host, tmp_path):
    path = tiny_module.write_module(tmp_path)
    path.write_text(tiny_module.SOURCE.replace("self.ui.applyButton.connect", "self.ui.aplyButton.connect"), "utf-8")
    host.load_module(path)
    with pytest.raises(AttributeError, match="aplyButton"):
        host.open("Tiny")
    host.unload_module("Tiny")


def test_the_self_tests_are_those_with_test_in_their_name(module):
    import slicer

    slicer.modules.TinyInstance.runTest()
    assert sys.modules["Tiny"].TinyTest.ran == ["first", "second"]


def test_a_run_can_be_canceled(host, widget):
    host.dialogs.cancel_progress(after=3)
    assert widget.logic.run(widget._parameterNode) == "canceled"


def test_a_progress_dialog_is_not_modal_by_itself(host):
    import slicer

    dialog = slicer.util.createProgressDialog(labelText="Begin")
    assert not dialog.modal
    dialog.close()


def test_an_error_in_a_run_is_shown(host, widget, parameters):
    import slicer

    parameters.volume = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    parameters.word = "one"
    widget.ui.applyButton.click()
    assert "Input word must not be one" in host.dialogs.messages()[0]
    assert len(host.take_slot_errors()) == 1


def test_translated_text_keeps_its_placeholders(host, module):
    assert sys.modules["Tiny"].Color.RED.label() == "Color red"


def test_an_exception_in_a_vtk_observer_is_kept(host, capsys):
    import slicer

    node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode")
    node.AddObserver("ModifiedEvent", lambda caller, event: 1 / 0)
    node.Modified()
    assert {type(error) for error in host.take_slot_errors()} == {ZeroDivisionError}
    assert "ZeroDivisionError" in capsys.readouterr().err


def test_an_observer_that_leads_only_to_its_node_outlives_the_collector(host):
    import gc

    import slicer

    calls = []

    def observe():
        node = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode", "observed")
        node.AddObserver("ModifiedEvent", lambda caller, event: calls.append(node.GetName()))

    observe()
    gc.collect()
    slicer.mrmlScene.GetFirstNodeByName("observed").Modified()
    assert calls == ["observed"]


def test_nothing_is_installed(host):
    import slicer

    with pytest.raises(RuntimeError, match="does not install packages: pyigtl"):
        slicer.util.pip_install("pyigtl")


# ---- parameters


def test_defaults_are_written_as_slicer_writes_them(parameters):
    node = parameters.parameterNode
    assert {name: node.GetParameter(name) for name in node.GetParameterNames()} == {
        "volume.1": "True",
        "shape.2": "True",
        "threshold": "2.5",
        "count": "3",
        "bright": "True",
        "color": "GREEN",
        "word": "two",
        "path": ".",
        "names.len": "0",
    }


def test_a_node_is_kept_as_a_reference(parameters):
    import slicer

    volume = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    parameters.shape = volume
    assert parameters.parameterNode.GetNodeReference("shape.0") is volume
    assert parameters.shape is volume


def test_the_type_of_a_node_decides_its_place_in_a_union(parameters):
    import slicer

    model = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLModelNode")
    parameters.shape = model
    assert parameters.parameterNode.HasParameter("shape.1")
    assert not parameters.parameterNode.HasParameter("shape.2")


def test_a_list_writes_its_changes(parameters):
    parameters.names = ["L1"]
    parameters.names.append("L2")
    parameters.names[0] = "T12"
    assert parameters.names == ["T12", "L2"]
    assert parameters.parameterNode.GetParameter("names.1") == "L2"


@pytest.mark.parametrize(
    ("name", "value", "error"),
    [
        ("threshold", 11, ValueError),
        ("count", 0, ValueError),
        ("count", 1.5, TypeError),
        ("bright", 1, TypeError),
        ("color", "RED", TypeError),
        ("word", "three", ValueError),
        ("volume", "a volume", TypeError),
        ("path", "a/b", TypeError),
    ],
)
def test_a_value_that_does_not_fit_is_refused(parameters, name, value, error):
    with pytest.raises(error):
        setattr(parameters, name, value)


def test_a_refused_value_leaves_the_parameter_as_it_was(parameters):
    with pytest.raises(ValueError):
        parameters.threshold = 11
    assert parameters.threshold == 2.5


@pytest.mark.parametrize(
    ("widget_name", "property_name", "value", "field", "expected"),
    [
        ("thresholdSlider", "value", 4, "threshold", 4.0),
        ("countSpinBox", "value", 7, "count", 7),
        ("brightCheckBox", "checked", False, "bright", False),
        ("wordComboBox", "currentIndex", 0, "word", "one"),
        ("pathLineEdit", "currentPath", "a/b", "path", Path("a/b")),
    ],
)
def test_a_widget_sets_its_parameter(widget, parameters, widget_name, property_name, value, field, expected):
    setattr(getattr(widget.ui, widget_name), property_name, value)
    assert getattr(parameters, field) == expected


def test_a_node_selector_sets_its_parameter(widget, parameters):
    import slicer

    volume = slicer.mrmlScene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    widget.ui.volumeSelector.setCurrentNode(volume)
    assert parameters.volume is volume


def test_a_parameter_shows_in_its_widget(widget, parameters):
    parameters.count = 9
    assert widget.ui.countSpinBox.value == 9


def test_an_enumeration_shows_its_labels(widget):
    assert widget.ui.colorComboBox.currentText == "Color green"


def test_the_range_of_a_parameter_becomes_the_widget_s(widget):
    assert (widget.ui.thresholdSlider.minimum, widget.ui.thresholdSlider.maximum) == (-10, 10)


def test_a_panel_that_was_left_sets_nothing(host, widget, parameters):
    host.leave()
    widget.ui.countSpinBox.value = 9
    assert parameters.count == 3


def test_a_saved_scene_brings_the_parameters_back(host, widget, parameters, tmp_path):
    import slicer

    parameters.count = 9
    slicer.mrmlScene.SetURL(str(tmp_path / "scene.mrml"))
    slicer.mrmlScene.Commit()
    slicer.mrmlScene.Clear()
    slicer.mrmlScene.SetURL(str(tmp_path / "scene.mrml"))
    slicer.mrmlScene.Import()
    assert widget.logic.getParameterNode().count == 9


def test_an_annotation_that_slicer_does_not_use_is_named(host, caplog):
    import typing

    from slicer.parameterNodeWrapper import Decimals, parameterNodeWrapper

    parameterNodeWrapper(type("Parameters", (), {"__annotations__": {"alpha": typing.Annotated[float, Decimals(2)]}}))
    assert "Unused annotations: [Decimals(value=2)]" in caplog.text


# ---- the runner


def run(tmp_path, source):
    """The runner's result on the small module with another source."""
    path = tiny_module.write_module(tmp_path)
    path.write_text(source, "utf-8")
    command = [sys.executable, str(RUNNER), "--module", str(path), "--tests", str(tmp_path / "none")]
    return subprocess.run(command, capture_output=True, text=True, timeout=300)


def test_the_runner_passes_where_every_self_test_passes(host, tmp_path):
    result = run(tmp_path, tiny_module.SOURCE)
    assert (result.returncode, "Ran 2 tests" in result.stdout) == (0, True), result.stdout + result.stderr


def test_the_runner_fails_where_a_self_test_fails(host, tmp_path):
    result = run(tmp_path, tiny_module.SOURCE.replace(".count, 3)", ".count, 4)"))
    assert result.returncode == 1, result.stdout + result.stderr
