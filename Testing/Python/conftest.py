"""Fixtures for all tests: where the real recordings are."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from files import write_patient
from hypothesis import HealthCheck, settings

# How fast a machine is decides nothing
settings.register_profile("any speed", deadline=None, max_examples=50, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any speed")

REPOSITORY = Path(__file__).resolve().parents[2]
# The small scene of the module's self tests serves here too
sys.path.append(str(REPOSITORY / "Testing" / "Slicer"))

# Shells start jobs in the background so that they ignore Ctrl-C, nohup so that they ignore the end of the terminal. Programs that tests
# start and interrupt would inherit that, and never end
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP") and signal.getsignal(signal.SIGHUP) is signal.SIG_IGN:
    signal.signal(signal.SIGHUP, signal.SIG_DFL)


LONG = ("test_the_self_tests_pass", "test_faults.py", "test_worker_of_slicer.py", "test_fuzz.py", "test_panel_accessibility.py")
"""What takes minutes."""


def pytest_collection_modifyitems(items):
    """What takes minutes comes first: nobody waits at the end for what was begun last."""
    items.sort(key=lambda item: not any(name in item.nodeid for name in LONG))


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The folder of real recordings: AIFRECON_DATA_DIR, else shared/data beside the repository."""
    given = os.environ.get("AIFRECON_DATA_DIR")
    folder = Path(given) if given else REPOSITORY.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"no real recordings in {folder} (set AIFRECON_DATA_DIR)")
    return folder


@pytest.fixture(scope="session")
def real_data(data_dir: Path) -> Callable[[str], Path]:
    """The path of a real recording by its name; skips the test where it is not there."""

    def find(name: str) -> Path:
        path = data_dir / name
        if not path.is_file():
            pytest.skip(f"{path} is not there")
        return path

    return find


@pytest.fixture(params=["numpy", "numba"])
def engine(request) -> str:
    """Each of both."""
    return request.param


@pytest.fixture
def patient(tmp_path):
    folder = tmp_path / "inputs"
    folder.mkdir()
    return write_patient(folder)


@pytest.fixture
def results(tmp_path):
    folder = tmp_path / "results"
    folder.mkdir()
    return folder


@pytest.fixture
def scene():
    """A new MRML scene as Slicer's application sets it up; it is `slicer.mrmlScene` while the test runs."""
    slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")
    from host import i18n
    from host.mrml_scene import createScene

    sys.modules.setdefault("slicer.i18n", i18n)
    before = getattr(slicer, "mrmlScene", None)
    made = slicer.mrmlScene = createScene()
    yield made
    slicer.mrmlScene = before
    made.host.close()
