"""What the library computes with is loaded beside the windows, and read from the disk before that."""

import subprocess
import sys
from pathlib import Path

import pytest

from AIFReconLib.errors import OperationCanceled

MODULE = Path(__file__).resolve().parents[3] / "AIFRecon"
sys.path.insert(0, str(MODULE))

from AIFReconScene import loading  # noqa: E402 - of the module

FIRST_RUN = """
import sys
from AIFReconScene import loading

read = []
loading.readCompiled = lambda package, progress: read.append((package, package in sys.modules))
loading.importLibrary()
assert read == [(package, False) for package in loading.LARGE], read
assert "SimpleITK" in sys.modules and "scipy.ndimage" in sys.modules
"""


@pytest.fixture
def opened(monkeypatch):
    """Names of the files that were opened."""
    names, opens = [], Path.open

    def noted(path, *arguments, **named):
        names.append(path.name)
        return opens(path, *arguments, **named)

    monkeypatch.setattr(Path, "open", noted)
    return names


@pytest.fixture
def package(tmp_path, monkeypatch, request):
    """A package with compiled libraries, by a name of its own: what was read once is not read again."""
    name = f"compiled_{abs(hash(request.node.name))}"
    folder = tmp_path / name
    (folder / "inner").mkdir(parents=True)
    files = ("__init__.py", "words.txt", "_core.abi3.so", "inner/core.pyd", "inner/libcore.so.1.32.0", "libcore.dylib", "core.dll")
    for file in files:
        (folder / file).write_bytes(b"\0" * (3 * loading.AT_ONCE // 2))
    monkeypatch.syspath_prepend(str(tmp_path))
    return name


def test_all_compiled_libraries_of_a_package_are_read_once(package, opened):
    for _ in range(2):
        loading.readCompiled(package)
    assert sorted(opened) == ["_core.abi3.so", "core.dll", "core.pyd", "libcore.dylib", "libcore.so.1.32.0"]


def test_what_is_loaded_already_is_not_read(package, opened, monkeypatch):
    monkeypatch.setitem(sys.modules, package, sys)
    loading.readCompiled(package)
    assert opened == []


def test_a_cancel_ends_the_reading_which_is_done_anew_later(package, opened):
    with pytest.raises(OperationCanceled):
        loading.readCompiled(package, lambda fraction, message: False)
    assert len(opened) == 1
    loading.readCompiled(package, lambda fraction, message: True)
    assert len(opened) == 6


def test_libraries_are_read_before_anything_is_imported():
    paths = [str(MODULE), str(MODULE.parent)]
    subprocess.run([sys.executable, "-c", f"import sys; sys.path[:0] = {paths!r}\n{FIRST_RUN}"], check=True)
