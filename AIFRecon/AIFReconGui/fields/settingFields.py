"""The fields of the library's settings: digits, range and unit as it declares them, and a field for each that the .ui file has none for."""

import qt
from AIFReconScene.inputs.parameters import CHOICES, PARAMETERS, camelCase, rangeOf
from slicer.parameterNodeWrapper import SlicerParameterNamePropertyName

from AIFReconLib.recipe.rules import FLAG, WHOLE

MOST = 10_000_000
"""What a field takes where the library names no largest number."""


def dressSettings(ui) -> None:
    """Make the fields of all settings what the library says of them; those that are missing come below the advanced ones."""
    fields = {widget.property(SlicerParameterNamePropertyName): widget for widget in vars(ui).values()}
    for name, rule in PARAMETERS.items():
        field = fields.get(camelCase(name)) or getattr(ui, f"{camelCase(name)}ComboBox", None) or _added(ui, name, rule)
        if name in CHOICES or rule["kind"] == FLAG:
            continue
        least, most = rangeOf(name)
        if rule["kind"] != WHOLE:
            field.decimals = rule["decimals"]
        field.minimum, field.maximum = least, MOST if most is None else most
        field.suffix = f" {rule['unit']}" if rule["unit"] else ""


def _added(ui, name: str, rule: dict):
    """A new field with its label."""
    kinds = {FLAG: qt.QCheckBox, WHOLE: qt.QSpinBox}
    field = qt.QComboBox() if name in CHOICES else kinds.get(rule["kind"], qt.QDoubleSpinBox)()
    label = qt.QLabel(rule["label"])
    field.objectName, label.objectName = f"{camelCase(name)}Field", f"{camelCase(name)}Label"
    field.setProperty(SlicerParameterNamePropertyName, camelCase(name))
    field.toolTip = label.toolTip = rule["help"]
    label.setBuddy(field)
    ui.advancedGroupBox.layout().addRow(label, field)
    setattr(ui, field.objectName, field)
    return field
