"""The notebooks of the pages run from the first cell to the last, and are kept without what they answer."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

NOTEBOOKS = sorted((Path(__file__).resolve().parents[3] / "docs" / "examples").glob("*.ipynb"))


def cells(path, kind):
    return [cell for cell in json.loads(path.read_text("utf-8"))["cells"] if cell["cell_type"] == kind]


def test_own_arrays_become_a_figure_and_a_volume_whose_bone_masks_make_brighter(tmp_path, monkeypatch):
    pytest.importorskip("matplotlib", reason="matplotlib is not installed")
    [path], names = [path for path in NOTEBOOKS if path.stem == "own_arrays"], {"__name__": "__main__"}
    monkeypatch.chdir(tmp_path)
    for cell in cells(path, "code"):
        exec(compile("".join(cell["source"]), path.name, "exec"), names)
    assert {path.name for path in tmp_path.iterdir()} == {"weighted.nrrd", "figure.pdf", "figure.png"}
    assert (tmp_path / "figure.pdf").read_bytes().startswith(b"%PDF")
    brightest = {name: float(np.percentile(np.asarray(volume), 99.5)) for name, volume in names["volumes"].items()}
    assert brightest["weighted"] > 1.5 * brightest["average"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_one_page_without_answers(path):
    code = cells(path, "code")
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
    assert sum(len(cell["source"]) for cell in json.loads(path.read_text("utf-8"))["cells"]) <= 90
