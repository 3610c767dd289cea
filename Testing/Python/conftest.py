"""Fixtures for all tests: where the real recordings are."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest
from files import write_patient

REPOSITORY = Path(__file__).resolve().parents[2]


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
    import scene_host  # noqa: F401, puts Testing/host on the path
    from mrml_scene import createScene

    before = getattr(slicer, "mrmlScene", None)
    made = slicer.mrmlScene = createScene()
    yield made
    slicer.mrmlScene = before
    made.host.close()
