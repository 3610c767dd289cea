"""What the stand-ins offer is what CTK's and Slicer's headers let PythonQt offer: no more.

The headers are looked for in AIFRECON_CTK_SOURCE and AIFRECON_SLICER_SOURCE, checkouts of commontk/CTK and Slicer/Slicer.
"""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Any

import pytest

pytest_plugins = ["host_fixture"]

CTK = ("AIFRECON_CTK_SOURCE", ("Libs/Widgets",))
SLICER = ("AIFRECON_SLICER_SOURCE", ("Libs/MRML/Widgets", "Base/QTGUI", "Base/QTCore", "Base/QTApp"))

# From the decorators in Base/QTCore/qSlicerBaseQTCorePythonQtDecorators.h, Base/QTGUI/qSlicerBaseQTGUIPythonQtDecorators.h and
# Base/QTApp/qSlicerBaseQTAppPythonQtDecorators: not in the class's own header
DECORATED = {"testingEnabled", "widgetRepresentation", "createNewWidgetRepresentation"}


def header(class_name: str) -> str:
    """The text of a class's header; skips where the sources are not there."""
    variable, folders = CTK if class_name.startswith("ctk") else SLICER
    root = os.environ.get(variable)
    if not root:
        pytest.skip(f"no headers to compare with (set {variable})")
    for folder in folders:
        path = Path(root) / folder / f"{class_name}.h"
        if path.is_file():
            return path.read_text("utf-8")
    pytest.skip(f"{variable} has no {class_name}.h")
    return ""


MACROS = r"^\s*#.*$|Q_OBJECT|QVTK_OBJECT|Q_(?:DECLARE_FLAGS|FLAGS|ENUMS?)\(.*?\)|Q_PROPERTY\(.*?\)\s*;?$"
LABEL = re.compile(r"^(public|protected|private|signals|Q_SIGNALS)\s*(slots|Q_SLOTS)?\s*:(?!:)")


def parameter_type(declaration: str) -> str:
    """A parameter's type as in a normalized signature: no name, no const, no reference, no default."""
    words = declaration.split("=")[0].replace("*", " * ").replace("&", " ").split()
    words = [word for word in words if word != "const"]
    return "".join(words[:-1] if len(words) > 1 and words[-1] != "*" else words)


def public_api(text: str, class_name: str) -> dict:
    """What PythonQt shows of a class: properties, public slots and invokable methods, signals, enumeration values; and its bases."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.S)
    [(bases, inside), *_] = re.findall(rf"class\s+(?:\w+\s+)?{class_name}\s*(:[^{{;]*)?\{{(.*?)\n\}};", text, flags=re.S)
    enums = re.findall(r"enum\s+\w*\s*\{(.*?)\}", inside, flags=re.S)
    api: dict[str, Any] = {
        "bases": re.findall(r"public\s+(?:virtual\s+)?(\w+)", bases),
        "properties": set(re.findall(r"Q_PROPERTY\(\s*\w[\w:<>]*[\s*]+(\w+)\s+READ", inside)),
        "methods": set(),
        "signals": set(),
        "enums": {word.split("=")[0].strip() for body in enums for word in body.split(",")},
    }
    section = "private"
    body = re.sub(MACROS, "", inside, flags=re.M)
    # A label heads what follows it; what it heads ends with ; or a body
    for line in re.split(r"[;{}]", body):
        line = " ".join(line.split())
        while label := LABEL.match(line):
            section = "slots" if label[1] == "public" and label[2] else label[1]
            line = line[label.end() :].strip()
        method = re.search(r"(\w+)\s*\(([^()]*(?:\([^()]*\)[^()]*)*)\)", line)
        if method and (section == "slots" or line.startswith("Q_INVOKABLE")):
            api["methods"].add(method[1])
        elif method and section in ("signals", "Q_SIGNALS"):
            api["signals"].add(f"{method[1]}({','.join(parameter_type(each) for each in method[2].split(',') if each.strip())})")
    return api


def with_bases(class_name: str) -> dict:
    """`public_api` with that of the bases whose headers are there."""
    api = public_api(header(class_name), class_name)
    for base in api["bases"]:
        if base.startswith(("ctk", "qMRML", "qSlicer")):
            try:
                inherited = with_bases(base)
            except pytest.skip.Exception:
                continue
            for key in ("properties", "methods", "signals", "enums"):
                api[key] |= inherited[key]
    return api


def stand_ins() -> dict[str, type]:
    """Every stand-in class by name."""
    from host import application, modules, qt_modules, views, widgets_collapsible, widgets_ctk, widgets_qmrml, windows

    found: dict[str, type] = {}
    for module in (widgets_collapsible, widgets_ctk, widgets_qmrml, application, modules, views, windows):
        found |= qt_modules.stand_ins(module)
    return found


def own_properties(kind: type) -> set[str]:
    """The Qt properties that a stand-in declares itself."""
    from PySide6 import QtCore

    own = [base for base in kind.__mro__ if not base.__module__.startswith(("PySide6", "Shiboken"))]
    return {name for base in own for name, value in vars(base).items() if isinstance(value, QtCore.Property)}


def check(part: str, offered) -> None:
    """Compares what each stand-in offers with its header; names what the header lacks."""
    excess, compared = {}, 0
    for name, kind in stand_ins().items():
        try:
            known = with_bases(name)[part]
        except pytest.skip.Exception as reason:
            skipped = str(reason)
            continue
        compared += 1
        if more := set(offered(kind)) - known - (DECORATED if part == "methods" else set()):
            excess[name] = sorted(more)
    if not compared:
        pytest.skip(skipped)
    assert (excess, compared > 10) == ({}, True)


def test_no_stand_in_has_a_property_that_the_header_lacks(host):
    check("properties", own_properties)


def test_no_stand_in_offers_a_method_that_pythonqt_would_not(host):
    check("methods", lambda kind: kind.__dict__["api"].get("methods", ()))


def test_no_stand_in_has_a_signal_that_the_header_lacks(host):
    check("signals", lambda kind: kind.__dict__["api"].get("signals", {}))


def test_no_stand_in_has_an_enumeration_value_that_the_header_lacks(host):
    check("enums", lambda kind: kind.__dict__["api"].get("enums", ()))


HEADER = """
class EXPORT ctkThing : public QWidget
{
  Q_OBJECT
  Q_PROPERTY(double value READ value WRITE setValue NOTIFY valueChanged)
public:
  enum Kind { Small = 1, Large };
  explicit ctkThing(QWidget* parent = 0);
  double value() const;
  Q_INVOKABLE vtkMRMLNode* node(int index = 0) const;
public Q_SLOTS:
  virtual void setValue(double value);
Q_SIGNALS:
  void valueChanged(double value);
  void nodeChanged(vtkMRMLNode* node);
  void told(const QString& text);
protected Q_SLOTS:
  void hidden();
};
"""


def test_a_header_is_understood():
    api = public_api(HEADER, "ctkThing")
    assert api["properties"] == {"value"}
    assert api["methods"] == {"node", "setValue"}
    assert api["signals"] == {"valueChanged(double)", "nodeChanged(vtkMRMLNode*)", "told(QString)"}
    assert {"Small", "Large"} <= api["enums"]
