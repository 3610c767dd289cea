"""The stand-ins for CTK's and Slicer's widgets behave as a user of Slicer sees them."""

from __future__ import annotations

import pytest

pytest_plugins = ["host_fixture"]


@pytest.fixture
def selector(host):
    """A node selector for volumes with the scene."""
    import slicer

    made = slicer.qMRMLNodeComboBox()
    made.nodeTypes = ["vtkMRMLScalarVolumeNode"]
    made.noneEnabled = True
    made.setMRMLScene(slicer.mrmlScene)
    return made


def add(kind="vtkMRMLScalarVolumeNode", name="node"):
    """A node in the scene."""
    import slicer

    return slicer.mrmlScene.AddNewNodeByClass(kind, name)


def texts(selector):
    """What the selector's list shows."""
    box = selector.children()[0]
    return [box.itemText(i) for i in range(box.count) if box.itemText(i)]


# ---- node selector


def test_a_selector_without_a_scene_is_disabled_and_empty(host):
    import slicer

    add()
    selector = slicer.qMRMLNodeComboBox()
    selector.nodeTypes = ["vtkMRMLScalarVolumeNode"]
    assert (selector.enabled, selector.nodeCount(), selector.currentNode()) == (False, 0, None)


def test_a_node_chosen_before_the_scene_comes_is_selected_then(host):
    import slicer

    node = add()
    selector = slicer.qMRMLNodeComboBox()
    selector.nodeTypes = ["vtkMRMLScalarVolumeNode"]
    selector.setCurrentNode(node)
    selector.setMRMLScene(slicer.mrmlScene)
    assert selector.currentNode() is node


def test_nodes_of_other_classes_are_not_listed(selector):
    add("vtkMRMLModelNode")
    assert selector.nodeCount() == 0


def test_nodes_of_derived_classes_are_listed(selector):
    add("vtkMRMLLabelMapVolumeNode")
    assert selector.nodeCount() == 1


def test_nodes_of_derived_classes_can_be_left_out(selector):
    add("vtkMRMLLabelMapVolumeNode")
    selector.showChildNodeTypes = False
    assert selector.nodeCount() == 0


def test_one_derived_class_can_be_left_out(selector):
    add("vtkMRMLLabelMapVolumeNode")
    selector.hideChildNodeTypes = ["vtkMRMLLabelMapVolumeNode"]
    assert selector.nodeCount() == 0


def test_hidden_nodes_are_listed_on_demand_only(selector):
    add().SetHideFromEditors(True)
    hidden = selector.nodeCount()
    selector.showHidden = True
    assert (hidden, selector.nodeCount()) == (0, 1)


def test_nodes_without_the_attribute_are_not_listed(selector):
    selector.addAttribute("vtkMRMLScalarVolumeNode", "LabelMap", "1")
    add()
    assert selector.nodeCount() == 0


def test_with_none_a_node_that_comes_is_not_selected(selector):
    add()
    assert selector.currentNode() is None


def test_without_none_the_first_node_is_selected(host):
    import slicer

    node = add()
    selector = slicer.qMRMLNodeComboBox()
    selector.nodeTypes = ["vtkMRMLScalarVolumeNode"]
    selector.setMRMLScene(slicer.mrmlScene)
    assert selector.currentNode() is node


def test_the_change_is_told_with_the_node(selector):
    node, told = add(), []
    selector.connect("currentNodeChanged(vtkMRMLNode*)", told.append)
    selector.setCurrentNode(node)
    selector.setCurrentNode(None)
    assert told == [node, None]


def test_the_same_node_again_is_no_change(selector):
    node, told = add(), []
    selector.setCurrentNode(node)
    selector.currentNodeChanged.connect(told.append)
    selector.setCurrentNode(node)
    assert told == []


def test_whether_there_is_a_node_is_told_too(selector):
    node, told = add(), []
    selector.connect("currentNodeChanged(bool)", told.append)
    selector.setCurrentNode(node)
    assert told == [True]


def test_the_id_selects_a_node(selector):
    node = add()
    selector.currentNodeID = node.GetID()
    assert selector.currentNode() is node


def test_an_unknown_id_selects_none(selector):
    selector.setCurrentNode(add())
    selector.setCurrentNodeID("vtkMRMLScalarVolumeNode999")
    assert selector.currentNode() is None


def test_a_removed_node_is_selected_no_more(selector):
    import slicer

    node = add()
    selector.setCurrentNode(node)
    slicer.mrmlScene.RemoveNode(node)
    assert selector.currentNode() is None


def test_closing_the_scene_empties_the_selector(selector):
    import slicer

    selector.setCurrentNode(add())
    slicer.mrmlScene.Clear()
    assert (selector.currentNode(), selector.nodeCount()) == (None, 0)


def test_a_new_name_is_shown(selector):
    node = add(name="old")
    node.SetName("new")
    assert "new" in texts(selector)


def test_create_new_makes_a_node_with_the_base_name_and_selects_it(selector):
    selector.baseName = "Reconstruction"
    node = selector.addNode()
    assert node.GetName().startswith("Reconstruction")
    assert selector.currentNode() is node


def test_a_user_creates_a_node_by_the_menu(selector):
    told = []
    selector.nodeAddedByUserAction.connect(told.append)
    box = selector.children()[0]
    row = next(i for i in range(box.count) if box.itemText(i).startswith("Create new"))
    box.currentIndex = row
    box.activated(row)
    assert told == [selector.currentNode()]


def test_a_user_selects_a_node_by_the_menu(selector):
    node, told = add(), []
    selector.nodeActivated.connect(told.append)
    selector.children()[0].activated(1)
    assert (selector.currentNode(), told) == (node, [node])


def test_actions_that_are_not_enabled_are_not_in_the_menu(selector):
    selector.addEnabled = selector.removeEnabled = False
    assert texts(selector) == ["None"]


def test_none_has_the_name_that_it_is_given(selector):
    selector.noneDisplay = "Create a new volume"
    assert texts(selector)[0] == "Create a new volume"


def test_a_node_by_its_id_is_no_node(selector):
    with pytest.raises(TypeError):
        selector.setCurrentNode("vtkMRMLScalarVolumeNode1")


# ---- CTK


def test_collapsing_hides_the_contents(host, ctk, qt):
    section = ctk.ctkCollapsibleButton()
    label = qt.QLabel("inside", section)
    section.show()
    section.collapsed = True
    assert label.isHidden()
    section.collapsed = False
    assert not label.isHidden()


def test_what_was_hidden_stays_hidden_when_a_section_is_opened(ctk, qt):
    section = ctk.ctkCollapsibleButton()
    label = qt.QLabel("inside", section)
    label.hide()
    section.collapsed = True
    section.collapsed = False
    assert label.isHidden()


def test_a_collapsed_section_is_not_checked(ctk):
    section = ctk.ctkCollapsibleButton()
    section.collapsed = True
    assert section.checked is False


def test_a_section_takes_less_room_when_collapsed(ctk, qt):
    section = ctk.ctkCollapsibleButton()
    layout = qt.QVBoxLayout(section)
    for _ in range(5):
        layout.addWidget(qt.QLabel("inside"))
    height = section.sizeHint.height()
    section.collapsed = True
    assert section.sizeHint.height() < height / 2


def test_a_group_is_collapsed_by_its_title(ctk, qt):
    group = ctk.ctkCollapsibleGroupBox()
    label = qt.QLabel("inside", group)
    group.checked = False
    assert (group.collapsed, label.isHidden()) == (True, True)


def test_a_slider_limits_and_rounds_its_value(ctk):
    slider = ctk.ctkSliderWidget()
    slider.minimum, slider.maximum, slider.decimals = 0, 1, 2
    slider.value = 0.128
    rounded = slider.value
    slider.value = 7
    assert (rounded, slider.value) == (0.13, 1.0)


def test_a_slider_tells_its_value(ctk):
    slider, told = ctk.ctkSliderWidget(), []
    slider.valueChanged.connect(told.append)
    slider.value = 3
    assert told == [3.0]


def test_pulling_the_slider_sets_the_value(ctk, qt):
    slider = ctk.ctkSliderWidget()
    slider.maximum, slider.singleStep = 10, 0.5
    slider.findChild(qt.QSlider).value = 500
    assert slider.value == 5.0


def test_a_path_is_told(ctk):
    line, told = ctk.ctkPathLineEdit(), []
    line.currentPathChanged.connect(told.append)
    line.currentPath = "sweep.mha"
    assert told == ["sweep.mha"]


def test_a_path_stays_in_the_history(ctk):
    line = ctk.ctkPathLineEdit()
    line.settingKey = "recording"
    line.currentPath = "sweep.mha"
    line.addCurrentPathToHistory()
    other = ctk.ctkPathLineEdit()
    other.settingKey = "recording"
    other.retrieveHistory()
    assert other.currentPath == "sweep.mha"


def test_browsing_takes_the_path_that_the_user_picks(host, ctk):
    host.dialogs.answers.append("picked.mha")
    line = ctk.ctkPathLineEdit()
    line.browse()
    assert line.currentPath == "picked.mha"


def test_the_checked_items_of_a_checkable_list(ctk, qt):
    box, told = ctk.ctkCheckableComboBox(), []
    box.addItems(["L1", "L2"])
    box.checkedIndexesChanged.connect(lambda: told.append(1))
    box.setCheckState(box.model().index(1, 0), qt.Qt.Checked)
    assert ([index.data() for index in box.checkedIndexes()], box.allChecked(), told) == (["L2"], False, [1])


# ---- dialogs


def test_an_error_display_is_noted_and_waits_for_nobody(host):
    import slicer

    slicer.util.errorDisplay("It failed.")
    assert host.dialogs.messages() == ["It failed."]


def test_a_question_is_answered_with_no_unless_the_test_says_otherwise(host, qt):
    import slicer

    host.dialogs.answers += [qt.QMessageBox.Yes]
    assert slicer.util.confirmYesNoDisplay("Sure?") is True
    assert slicer.util.confirmYesNoDisplay("Sure?") is False


def test_cancel_is_pressed_in_a_progress_dialog(host):
    import slicer

    host.dialogs.cancel_progress(after=2)
    dialog = slicer.util.createProgressDialog(maximum=10)
    dialog.value = 1
    before = dialog.wasCanceled
    dialog.value = 2
    dialog.value = 3
    assert (before, dialog.wasCanceled) == (False, True)
    dialog.close()


def test_the_texts_of_a_progress_dialog_are_noted(host):
    import slicer

    dialog = slicer.util.createProgressDialog(labelText="Reading")
    dialog.labelText = "Writing"
    dialog.close()
    assert host.dialogs.progress == ["Reading", "Writing"]


def test_a_static_dialog_gives_the_prepared_answer(host, qt):
    host.dialogs.answers.append("file.mha")
    assert qt.QFileDialog.getOpenFileName(None, "Open") == "file.mha"


def test_an_error_leaves_no_wait_cursor(host, qt):
    import slicer

    with pytest.raises(ValueError), slicer.util.tryWithErrorDisplay("It failed.", waitCursor=True):
        raise ValueError("broken")
    assert qt.QApplication.overrideCursor() is None
    assert "broken" in host.dialogs.messages()[0]
