"""How a scan's display is drawn, and a run's: nothing until all steps are taken, and always in the end."""

import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "AIFRecon"))

from AIFReconScene.display.viewByView import drawnViewByView  # noqa: E402 - needs slicer
from AIFReconScene.live.inSteps import InSteps  # noqa: E402


class Views:
    """An application without views that counts what keeps it from drawing."""

    def __init__(self):
        self.paused = 0
        self.did = []

    def pauseRender(self):
        """Draw nothing more."""
        self.paused += 1

    def resumeRender(self):
        """Draw again, if nobody else has paused it."""
        self.paused -= 1

    def layoutManager(self):
        """There is none."""

    def steps(self, *names):
        """Steps that note their names, and how often drawing is paused."""
        for name in names:
            if name is ValueError:
                raise ValueError
            self.did.append((name, self.paused))
            yield


@pytest.fixture
def views(monkeypatch):
    """The application, in the place of Slicer's."""
    views = Views()
    monkeypatch.setattr(slicer, "app", views, raising=False)
    return views


def test_nothing_is_drawn_until_all_steps_are_taken(views):
    in_steps = InSteps()
    in_steps.begin(views.steps("first", "second"))
    assert (in_steps.isUnderWay, views.did) == (True, [])
    while in_steps.isUnderWay:
        in_steps.goOn()
    assert (views.did, views.paused) == ([("first", 1), ("second", 1)], 0)


def test_steps_that_are_interrupted_leave_views_drawn(views):
    in_steps = InSteps()
    in_steps.begin(views.steps("first", "second"))
    assert in_steps.goOn()
    in_steps.interrupt()
    assert not in_steps.goOn()
    assert (views.did, views.paused) == ([("first", 1)], 0)


def test_a_step_that_fails_ends_them_and_leaves_views_drawn(views):
    in_steps = InSteps()
    in_steps.begin(views.steps("first", ValueError))
    assert in_steps.goOn()
    with pytest.raises(ValueError):
        in_steps.goOn()
    assert not in_steps.isUnderWay
    assert views.paused == 0


class View:
    """A view that notes when it is drawn."""

    def __init__(self, name, noted):
        self.name, self.noted = name, noted

    def pauseRender(self):
        """Draw nothing more."""

    def resumeRender(self):
        """Draw."""
        self.noted.append(self.name)


def test_what_a_run_shows_is_drawn_view_by_view_and_told_after_each(views, monkeypatch):
    noted = []
    layout = SimpleNamespace(
        sliceViewNames=lambda: ["Red", "Green"],
        sliceWidget=lambda name: View(name, noted),
        threeDViewCount=1,
        threeDWidget=lambda number: View("3D", noted),
    )
    monkeypatch.setattr(views, "layoutManager", lambda: layout)
    with drawnViewByView(lambda fraction, message: noted.append("told")):
        assert views.paused == 1
        noted.append("shown")
    assert noted == ["shown", "3D", "told", "Green", "told", "Red", "told"]
    assert views.paused == 0


def test_what_goes_wrong_while_a_run_shows_something_leaves_views_drawn(views):
    with pytest.raises(ValueError), drawnViewByView():
        raise ValueError
    assert views.paused == 0


def test_views_that_somebody_else_has_paused_stay_paused(views):
    views.pauseRender()
    in_steps = InSteps()
    in_steps.begin(views.steps())
    assert not in_steps.goOn()
    assert views.paused == 1
