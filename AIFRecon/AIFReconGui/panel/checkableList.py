"""A list with check marks that follows the parameters: parameterNodeWrapper has no connector for checkable lists."""

import qt


class CheckableList:
    """Items of a combo box, each with a check mark; hidden with its label where there are none.

    Parameters
    ----------
    comboBox : ctkCheckableComboBox
    label : QLabel
    onChecked : callable
        Called with the keys of the checked items when the user changes them.
    """

    def __init__(self, comboBox, label, onChecked):
        self._comboBox = comboBox
        self._label = label
        self._onChecked = onChecked
        self._updating = False
        comboBox.connect("checkedIndexesChanged()", self._onIndexes)
        self.show([], [])

    def show(self, items, checked) -> None:
        """Show items, as (key, name), and check those of these keys."""
        self._updating = True
        self._comboBox.clear()
        for key, name in items:
            self._comboBox.addItem(name, key)
        for row, (key, _name) in enumerate(items):
            self._comboBox.setCheckState(self._index(row), qt.Qt.Checked if key in checked else qt.Qt.Unchecked)
        self._comboBox.visible = self._label.visible = bool(items)
        self._updating = False

    def _index(self, row: int):
        return self._comboBox.model().index(row, self._comboBox.modelColumn)

    def _onIndexes(self) -> None:
        if not self._updating:
            rows = [row for row in range(self._comboBox.count) if self._comboBox.checkState(self._index(row)) == qt.Qt.Checked]
            self._onChecked([self._comboBox.itemData(row) for row in rows])
