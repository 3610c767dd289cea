"""The list of methods: the library's own, and those that somebody has registered since Slicer was started."""

from AIFReconScene.inputs.parameters import Method, ownMethods


class MethodChooser:
    """Keeps the list and two parameters alike: `method`, and `ownMethod`, which comes before it where it is not empty.

    Parameters
    ----------
    comboBox : QComboBox
    """

    def __init__(self, comboBox):
        self._comboBox = comboBox
        self._parameterNode = None
        self._own = None
        self._updating = False
        comboBox.connect("currentIndexChanged(int)", self._onChanged)

    def setParameterNode(self, parameterNode) -> None:
        """Follow these parameters, or none."""
        self._parameterNode = parameterNode

    def update(self) -> None:
        """Show the methods that there are, and which is chosen; one that a scene was saved with is shown even where it is not known."""
        chosen, known = self._parameterNode.ownMethod, ownMethods()
        own = (*known, *((chosen,) if chosen and chosen not in known else ()))
        self._updating = True
        if own != self._own:
            self._own = own
            self._comboBox.clear()
            for label in (*(method.label() for method in Method), *own):
                self._comboBox.addItem(label)
        self._comboBox.currentIndex = len(Method) + own.index(chosen) if chosen else list(Method).index(self._parameterNode.method)
        self._updating = False

    def _onChanged(self, row: int) -> None:
        if self._updating or self._parameterNode is None or row < 0:
            return
        if row < len(Method):
            self._parameterNode.method = list(Method)[row]
        self._parameterNode.ownMethod = "" if row < len(Method) else self._own[row - len(Method)]
