"""The host shows Qt as PythonQt does: what Slicer refuses is refused here too."""

from __future__ import annotations

import pytest

pytest_plugins = ["host_fixture"]


def test_a_property_is_an_attribute(qt):
    button = qt.QPushButton("Apply")
    button.enabled = False
    assert (button.text, button.enabled) == ("Apply", False)


def test_a_property_s_getter_cannot_be_called(qt):
    with pytest.raises(TypeError, match="not callable"):
        qt.QPushButton("Apply").text()


def test_a_property_s_setter_can_be_called(qt):
    button = qt.QPushButton()
    button.setText("Apply")
    assert button.text == "Apply"


def test_name_stands_for_the_object_name(qt):
    button = qt.QPushButton()
    button.name = "applyButton"
    assert button.objectName == "applyButton"


def test_an_unknown_attribute_cannot_be_read(qt):
    with pytest.raises(AttributeError, match="QPushButton has no attribute named 'colour'"):
        _ = qt.QPushButton().colour


def test_an_unknown_attribute_cannot_be_set(qt):
    with pytest.raises(AttributeError, match="creating new attributes on C\\+\\+ objects is not allowed"):
        qt.QPushButton().colour = "red"


def test_a_method_cannot_be_overwritten(qt):
    with pytest.raises(AttributeError, match="Slot 'setText' can not be overwritten"):
        qt.QPushButton().setText = print


def test_a_read_only_property_cannot_be_set(qt):
    with pytest.raises(AttributeError, match="not writable"):
        qt.QComboBox().count = 3


def test_a_value_of_the_wrong_type_is_refused(qt):
    with pytest.raises(AttributeError, match="'value' of type 'int' does not accept an object of type str"):
        qt.QSpinBox().value = "three"


def test_a_float_is_cut_for_a_whole_number(qt):
    box = qt.QSpinBox()
    box.value = 2.7
    assert box.value == 2


def test_keyword_arguments_are_refused(qt):
    with pytest.raises(TypeError):
        qt.QPushButton(text="Apply")


def test_a_dynamic_property_is_an_attribute(qt):
    button = qt.QPushButton()
    button.setProperty("SlicerParameterName", "alpha")
    assert button.SlicerParameterName == "alpha"


def test_a_child_is_found_by_its_name(qt):
    outer = qt.QWidget()
    inner = qt.QLabel("hello", outer)
    inner.name = "greeting"
    assert outer.greeting is inner


def test_a_wrapper_is_the_same_object_every_time(qt):
    outer = qt.QWidget()
    inner = qt.QLabel("hello", outer)
    assert inner.parent() is outer
    assert outer.children() == (inner,)


def test_a_class_is_no_instance_of_its_base_class(qt):
    # As in Slicer, where each wrapped class derives from PythonQt's own alone
    assert not isinstance(qt.QPushButton(), qt.QWidget)


def test_the_kind_of_a_widget_is_its_class(qt):
    assert type(qt.QPushButton()) is qt.QPushButton


def test_a_destroyed_object_says_so(host, qt):
    outer = qt.QWidget()
    inner = qt.QLabel("hello", outer)
    outer.delete()
    assert not inner
    with pytest.raises(ValueError, match="Trying to read property 'text' from a destroyed QLabel object"):
        _ = inner.text


def test_a_property_of_a_destroyed_object_cannot_be_set(host, qt):
    button = qt.QPushButton()
    button.delete()
    with pytest.raises(AttributeError, match="Trying to set property 'enabled' on a destroyed QPushButton object"):
        button.enabled = True


def test_a_method_of_a_destroyed_object_fails_when_it_is_called(host, qt):
    button = qt.QPushButton()
    button.delete()
    click = button.click
    with pytest.raises(ValueError, match="Trying to call 'click' on a destroyed QPushButton object"):
        click()


def test_a_python_class_may_add_attributes(qt):
    class Panel(qt.QWidget):
        def __init__(self):
            super().__init__()
            self.answer = 42

    assert Panel().answer == 42


def test_enumeration_values_belong_to_the_class(qt):
    assert int(qt.QMessageBox.Ok | qt.QMessageBox.Cancel) == 0x400 | 0x400000


def test_an_enumeration_value_is_a_number(qt):
    assert qt.Qt.Checked == 2


def test_an_enumeration_has_no_scoped_values(qt):
    with pytest.raises(AttributeError):
        _ = qt.QMessageBox.StandardButton.Ok


def test_an_enumeration_value_is_taken_back(qt):
    policy = qt.QSizePolicy(qt.QSizePolicy.Expanding, qt.QSizePolicy.Fixed)
    assert policy.horizontalPolicy() == qt.QSizePolicy.Expanding


def test_exec_is_found_with_its_python_2_name(host, qt):
    assert qt.QDialog().exec_() == 0


def test_pyside_s_own_helpers_are_not_there(qt):
    with pytest.raises(AttributeError):
        _ = qt.Signal


def test_a_list_comes_as_a_tuple(qt):
    box = qt.QComboBox()
    assert isinstance(box.children(), tuple)


@pytest.mark.parametrize(
    ("signature", "received"), [("clicked(bool)", [(False,)]), ("clicked()", [()])], ids=["with its argument", "without it"]
)
def test_a_signal_is_connected_by_its_signature(qt, signature, received):
    button, calls = qt.QPushButton(), []
    button.connect(signature, lambda *args: calls.append(args))
    button.click()
    assert calls == received


def test_a_signal_is_connected_by_its_name(qt):
    box, calls = qt.QSpinBox(), []
    box.valueChanged.connect(calls.append)
    box.value = 5
    assert calls == [5]


def test_a_slot_gets_no_more_arguments_than_it_takes(qt):
    button, calls = qt.QPushButton(), []
    button.clicked.connect(lambda: calls.append("clicked"))
    button.click()
    assert calls == ["clicked"]


def test_a_default_value_of_a_slot_is_overwritten_by_the_signal(qt):
    button, calls = qt.QPushButton(), []
    for number in (1, 2):
        button.clicked.connect(lambda number=number: calls.append(number))
    button.click()
    assert calls == [False, False]


def test_a_signal_that_does_not_exist_is_refused(qt):
    with pytest.raises(RuntimeError, match="'pressedTwice\\(\\)' does not exist on QPushButton"):
        qt.QPushButton().connect("pressedTwice()", print)


def test_a_signature_that_does_not_exist_is_refused(qt):
    with pytest.raises(RuntimeError, match="it has"):
        qt.QPushButton().connect("clicked(int)", print)


def test_disconnect_ends_it(qt):
    button, calls = qt.QPushButton(), []

    def slot():
        calls.append(1)

    button.connect("clicked()", slot)
    assert button.disconnect("clicked()", slot) is True
    button.click()
    assert calls == []


def test_a_method_is_disconnected_though_each_look_makes_a_new_object(qt):
    class Listener:
        def __init__(self):
            self.calls = 0

        def slot(self):
            self.calls += 1

    button, listener = qt.QPushButton(), Listener()
    button.clicked.connect(listener.slot)
    button.clicked.disconnect(listener.slot)
    button.click()
    assert listener.calls == 0


def test_disconnecting_what_was_not_connected_says_false(qt):
    assert qt.QPushButton().disconnect("clicked()", print) is False


def test_a_signal_can_be_connected_to_a_slot_of_qt(qt):
    button, label = qt.QPushButton(), qt.QLineEdit("hello")
    button.connect("clicked()", label, "clear()")
    button.click()
    assert label.text == ""


def test_an_exception_in_a_slot_is_kept(host, qt, capsys):
    button = qt.QPushButton()
    button.clicked.connect(lambda: 1 / 0)
    button.click()
    assert [type(error) for error in host.take_slot_errors()] == [ZeroDivisionError]
    assert "ZeroDivisionError" in capsys.readouterr().err


def test_a_timer_calls_a_python_function(host, qt):
    calls = []
    qt.QTimer.singleShot(0, lambda: calls.append(1))
    host.process_events()
    assert calls == [1]


def test_settings_do_not_touch_the_user_s(host, qt):
    qt.QSettings().setValue("Developer/DeveloperMode", "true")
    assert host._folder.name in qt.QSettings().fileName()


@pytest.mark.parametrize(
    ("class_name", "method"),
    [
        ("ctkCollapsibleButton", "setCollapsed"),
        ("ctkSliderWidget", "setRange"),
        ("ctkSliderWidget", "spinBox"),
        ("ctkPathLineEdit", "setFilters"),
        ("ctkComboBox", "forceDefault"),
    ],
)
def test_a_c_plus_plus_method_that_pythonqt_does_not_show_is_not_there(ctk, class_name, method):
    with pytest.raises(AttributeError):
        getattr(getattr(ctk, class_name)(), method)


@pytest.mark.parametrize("method", ["setNodeTypes", "setNoneEnabled", "nodes", "model", "comboBox"])
def test_a_c_plus_plus_method_of_the_node_selector_is_not_there(host, method):
    import slicer

    with pytest.raises(AttributeError):
        getattr(slicer.qMRMLNodeComboBox(), method)


def test_a_ctk_widget_is_made_with_a_parent_only(ctk):
    with pytest.raises(ValueError, match="with a parent only"):
        ctk.ctkCollapsibleButton("Section")


def test_a_stand_in_hides_its_python_side(ctk):
    with pytest.raises(AttributeError):
        _ = ctk.ctkSliderWidget()._spin


@pytest.mark.parametrize("name", ["loadVolume", "pip_install", "app_", "import_module"])
def test_slicer_has_no_functions_of_slicer_util(host, name):
    import slicer

    assert not hasattr(slicer, name)
