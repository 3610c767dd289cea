"""Designer files are loaded as Slicer does, and what would silently not work there is refused."""

from __future__ import annotations

import pytest
import tiny_module

pytest_plugins = ["host_fixture"]


@pytest.fixture
def load(host, tmp_path):
    """Loads a .ui file given by changes of the small module's one."""
    import slicer

    def loaded(**changes):
        path = tmp_path / "Tiny.ui"
        path.write_text(tiny_module.ui(**changes), "utf-8")
        return slicer.util.loadUI(str(path))

    return loaded


def item(kind, properties="", name="extra"):
    """A further widget of the layout."""
    return f'<item><widget class="{kind}" name="{name}">{properties}</widget></item>'


def test_the_outermost_widget_is_of_its_class(load):
    import slicer

    assert type(load()) is slicer.qMRMLWidget


def test_every_named_widget_is_found(load):
    import slicer

    ui = slicer.util.childWidgetVariables(load())
    assert {name for _, name, _, _ in tiny_module.WIDGETS} <= set(vars(ui))


def test_connected_widgets_get_the_scene(load):
    import slicer

    panel = load()
    panel.setMRMLScene(slicer.mrmlScene)
    assert slicer.util.childWidgetVariables(panel).volumeSelector.mrmlScene() is slicer.mrmlScene


def test_a_widget_that_is_not_connected_does_not_get_the_scene(load):
    import slicer

    panel = load(connected=("volumeSelector",))
    panel.setMRMLScene(slicer.mrmlScene)
    assert slicer.util.childWidgetVariables(panel).shapeSelector.mrmlScene() is None


def test_a_property_of_a_stand_in_is_set(load):
    import slicer

    more = item("ctkSliderWidget", '<property name="suffix"><string> mm</string></property>')
    assert slicer.util.childWidgetVariables(load(more=more)).extra.suffix == " mm"


def test_an_enumeration_of_a_stand_in_is_understood(load):
    import slicer
    from host.widgets_ctk import ctkPathLineEdit

    more = item("ctkPathLineEdit", '<property name="filters"><set>ctkPathLineEdit::Files|ctkPathLineEdit::Readable</set></property>')
    filters = slicer.util.childWidgetVariables(load(more=more)).extra.filters
    assert filters == ctkPathLineEdit.Files | ctkPathLineEdit.Readable


def test_a_collapsed_section_starts_with_its_contents_hidden(load):
    import slicer

    inside = f'<property name="collapsed"><bool>true</bool></property><layout class="QVBoxLayout">{item("QLabel", name="inside")}</layout>'
    ui = slicer.util.childWidgetVariables(load(more=item("ctkCollapsibleButton", inside)))
    assert ui.inside.isHidden()


def test_a_class_that_nobody_knows_is_refused(load):
    with pytest.raises(RuntimeError, match="extra is a qMRMLNodeCombBox, which the host does not know"):
        load(more=item("qMRMLNodeCombBox"))


def test_a_property_that_the_class_lacks_is_refused(load):
    with pytest.raises(RuntimeError, match=r"extra \(QLabel\) has no property suffix"):
        load(more=item("QLabel", '<property name="suffix"><string>mm</string></property>'))


def test_a_connection_with_a_wrong_signal_is_refused(load):
    wrong = (
        "<connection><sender>Tiny</sender><signal>mrmlSceneChanges(vtkMRMLScene*)</signal>"
        "<receiver>volumeSelector</receiver><slot>setMRMLScene(vtkMRMLScene*)</slot></connection>"
    )
    with pytest.raises(RuntimeError, match="mrmlSceneChanges"):
        load(connections=wrong)


def test_a_connection_with_a_wrong_slot_is_refused(load):
    wrong = (
        "<connection><sender>Tiny</sender><signal>mrmlSceneChanged(vtkMRMLScene*)</signal>"
        "<receiver>countSpinBox</receiver><slot>setMRMLScene(vtkMRMLScene*)</slot></connection>"
    )
    with pytest.raises(RuntimeError, match="QSpinBox has no slot setMRMLScene"):
        load(connections=wrong)


def test_a_connection_of_qt_works(load):
    import slicer

    link = (
        "<connection><sender>brightCheckBox</sender><signal>toggled(bool)</signal>"
        "<receiver>countSpinBox</receiver><slot>setEnabled(bool)</slot></connection>"
    )
    ui = slicer.util.childWidgetVariables(load(connections=link))
    ui.brightCheckBox.checked = True
    ui.brightCheckBox.checked = False
    assert ui.countSpinBox.enabled is False


def test_a_file_that_is_not_there_is_named(host, tmp_path):
    import slicer

    with pytest.raises(RuntimeError, match="file not found"):
        slicer.util.loadUI(str(tmp_path / "none.ui"))


def test_a_picture_has_the_width_that_was_asked_for(host, load, tmp_path):
    size = host.grab(load(), tmp_path / "panel.png", width=400)
    assert size[0] == 400
    assert (tmp_path / "panel.png").read_bytes()[:4] == b"\x89PNG"


def test_a_picture_shows_text(host, qt, tmp_path):
    label = qt.QLabel("Reconstruct")
    host.grab(label, tmp_path / "text.png", width=200, height=40)
    image = qt.QImage(str(tmp_path / "text.png"))
    colors = {image.pixelColor(x, y).name() for x in range(200) for y in range(40)}
    assert len(colors) > 4
