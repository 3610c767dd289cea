"""The panel can be read and used at 400 px, with large letters, in dark colors, on dense and small screens, and by keyboard alone.

`Testing/host/panel_looks.py` opens the panel and looks; the tests here say what must hold. Needs PySide6 and slicer-core.
"""

from __future__ import annotations

import json
import re

import pytest
from host_process import REPOSITORY, run_on_host

MODULE = REPOSITORY / "AIFRecon"
PROGRAM = REPOSITORY / "Testing" / "host" / "panel_looks.py"
STATES = REPOSITORY / "AIFRecon" / "AIFReconGui" / "signals.py"
COLOR = re.compile(r"#[0-9a-fA-F]{6}\b|\brgba?\(|\bcolor:|QColor|setForeground|setPalette")


@pytest.fixture(scope="module")
def found():
    """What the program finds by the pixels for a point: on a usual screen and on a dense one."""
    seen = {}
    for scale in ("1", "2"):
        done = run_on_host(PROGRAM, QT_SCALE_FACTOR=scale)
        assert done.returncode == 0, done.stderr[-3000:]
        seen[scale] = json.loads(done.stdout[done.stdout.index("{") :])
    return seen


@pytest.mark.parametrize("scale", ["1", "2"])
def test_no_text_is_cut_at_400_px_on_a_usual_screen_and_on_a_dense_one(found, scale):
    assert found[scale]["pixels per point"] == float(scale)
    assert len(found[scale]["cut"]) == 7
    assert [cut for cuts in found[scale]["cut"].values() for cut in cuts] == []


def test_a_small_screen_shows_a_newcomer_all_of_the_panel(found):
    assert all(200 < found["1"]["newcomer"][tab] <= 700 for tab in ("recorded", "live"))


def test_tab_reaches_everything_that_can_be_used_and_a_screen_reader_has_a_name_for_it(found):
    keyboard = found["1"]["keyboard"]
    assert keyboard["walked"] > 50
    assert (keyboard["unreached"], keyboard["unnamed"]) == ([], [])


@pytest.mark.parametrize("path", sorted([*MODULE.rglob("*.py"), *MODULE.rglob("*.ui")]), ids=lambda path: path.name)
def test_colors_are_left_to_the_palette(path):
    """Signs and drawing alone have colors of their own, and bring their background along; volumes and models are no widgets."""
    if path == STATES or path.name == "painting.py" or "AIFReconScene" in path.parts:
        return
    assert COLOR.findall(path.read_text("utf-8")) == []


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
