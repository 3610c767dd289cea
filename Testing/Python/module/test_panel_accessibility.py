"""The panel can be read and used at 400 px, with large letters, in dark colors, on dense and small screens, and by keyboard alone.

`Testing/host/panel_looks.py` opens the panel and looks; the tests here say what must hold. Needs PySide6 and slicer-core.
"""

from __future__ import annotations

import importlib.util
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).resolve().parents[3]
MODULE = REPOSITORY / "AIFRecon"
PROGRAM = REPOSITORY / "Testing" / "host" / "panel_looks.py"
STATES = REPOSITORY / "AIFRecon" / "AIFReconGui" / "signals.py"
COLOR = re.compile(r"#[0-9a-fA-F]{6}\b|\brgba?\(|\bcolor:|QColor|setForeground|setPalette")


def looked(scale: str) -> dict:
    """What the program finds with so many pixels for a point."""
    for package, name in (("PySide6", "PySide6-Essentials"), ("slicer", "slicer-core")):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{name} is not installed: pip install '.[test]'")
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen", "QT_SCALE_FACTOR": scale}
    done = subprocess.run([sys.executable, str(PROGRAM)], cwd=REPOSITORY, env=environment, capture_output=True, text=True, errors="replace")
    if "cannot run here" in done.stderr:
        pytest.skip(done.stderr.strip().splitlines()[-1])
    assert done.returncode == 0, done.stderr[-3000:]
    return json.loads(done.stdout[done.stdout.index("{") :])


@pytest.fixture(scope="module")
def found():
    """On a usual screen."""
    return looked("1")


@pytest.fixture(scope="module")
def found_dense():
    """On a screen with two pixels for a point."""
    return looked("2")


@pytest.mark.parametrize(
    "look",
    ["without inputs", "light", "open", "large letters", "dark", "live", "live, large letters", "live, dark", "after a reconstruction"],
)
def test_no_text_is_cut_at_400_px(found, look):
    assert found["cut"][look] == []


def test_no_text_is_cut_on_a_dense_screen(found_dense):
    assert found_dense["pixels per point"] == 2.0
    assert [cut for cuts in found_dense["cut"].values() for cut in cuts] == []


@pytest.mark.parametrize("tab", ["recorded", "live"])
def test_the_panel_of_a_newcomer_is_seen_whole_on_a_small_screen(found, tab):
    assert 200 < found["newcomer"][tab] <= 700


@pytest.mark.parametrize("look", ["light", "dark", "live", "live, dark"])
def test_every_label_stands_out_from_what_is_behind_it(found, look):
    assert found["faint"][look] == []


@pytest.mark.parametrize("path", sorted([*MODULE.rglob("*.py"), *MODULE.rglob("*.ui")]), ids=lambda path: path.name)
def test_colors_are_left_to_the_palette(path):
    """Signs and drawing alone have colors of their own, and bring their background along; volumes and models are no widgets."""
    if path == STATES or "AIFReconScene" in path.parts:
        return
    text = path.read_text("utf-8")
    assert COLOR.findall(text.partition("def _drawSweep(")[0] if path.name == "importDialog.py" else text) == []


def test_letters_stand_out_on_every_sign_of_the_panel():
    colors = re.findall(r'\("#([0-9a-f]{6})", "#([0-9a-f]{6})"\)', STATES.read_text("utf-8"))
    assert len(colors) == 4
    for pair in colors:
        dark, light = sorted(map(luminance, pair))
        assert (light + 0.05) / (dark + 0.05) >= 4.5


def luminance(color: str) -> float:
    """Relative luminance of RRGGBB as the WCAG define it, 0 to 1."""
    shares = [int(color[i : i + 2], 16) / 255 for i in (0, 2, 4)]
    linear = [c / 12.92 if c <= 0.03928 else ((c + 0.055) / 1.055) ** 2.4 for c in shares]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def test_tab_reaches_everything_that_can_be_used(found):
    assert found["keyboard"]["walked"] > 50
    assert found["keyboard"]["unreached"] == []


def test_the_focus_is_seen(found):
    assert found["keyboard"]["unmarked"] == []


def test_everything_that_tab_reaches_has_a_name_for_a_screen_reader(found):
    assert found["keyboard"]["unnamed"] == []


def test_a_small_screen_scrolls_the_panel_down_and_not_across(found):
    assert found["scrolls"]["across"] == 0
    assert found["scrolls"]["down"] > 100
