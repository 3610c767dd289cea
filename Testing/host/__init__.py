"""A headless stand-in for the Slicer application, to run a scripted module with its panel on real MRML nodes and real Qt.

Real: the MRML scene, nodes and logics (slicer-core); VTK; Qt with its layouts, signals, property system and .ui loader (PySide6);
`slicer.util` (slicer-core ships Slicer's own file); the module and its .ui file.

Stood in, as small as can be: PythonQt's way of showing Qt (`pythonqt.py`, `connections.py`); CTK's and MRML's widgets (`widgets_ctk.py`,
`widgets_qmrml.py`), whose accepted names a test compares with what the running application told of them; the
application object, its window, views and module list (`application.py`, `windows.py`, `views.py`, `modules.py`);
`slicer.ScriptedLoadableModule`, `slicer.parameterNodeWrapper`, `slicer.i18n` and the part of `SampleData` that registers data.

As in Slicer, a module's panel lies in a scroll area that its size hints widen (`windows.py`); slice views fit their field of view to their
widget, 3D cameras stay where they are until they are reset (`views.py`), and widgets answer to no name that the application's list lacks.

Modules come and go as in Slicer: they are made in the order of their names, each loadable one bringing its classes into `slicer`, before
any is loaded (`start_up.py`); closing the window or `slicer.util.exit` unloads them and destroys their panels within that very call, in the
middle of whatever Python does (`SlicerHost.run`), and a destroyed widget raises what PythonQt raises.

What it cannot show: nothing is drawn in views, so no displayable manager, no interaction and no picture of a slice; no readers or
writers of the application (`slicer.util.loadVolume` fails), no panels of C++ modules, no other language, no packaging, no packages
installed (`pip_install` refuses). The look is Qt's Fusion style, with what CTK draws itself drawn alike. Which node a selector falls
back to when its node goes is that of a plain list. Python classes that derive from Qt classes cannot override their C++ methods.
Parameters are of the types, and with the rules, that the module has.

Stricter than Slicer: where Slicer prints an error and goes on (a signal that does not exist, an unknown class or property in a .ui
file, an exception in `setup`, `enter` or `exit`), the host raises; exceptions in slots and VTK observers are kept for the test
(`take_slot_errors`). Conversions of arguments are PySide6's, which accepts less than PythonQt. Modal dialogs never wait: `dialogs`
says what was shown and gives the answers.

Use: `host = runHost(); host.start("AIFRecon/AIFRecon.py"); widget = host.open("AIFRecon")`. One host per process.
"""

from .slicer_host import SlicerHost, missing, runHost

__all__ = ["SlicerHost", "missing", "runHost"]
