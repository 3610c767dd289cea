"""How a scan's display is drawn: nothing until all steps are taken, and always in the end."""

import sys
from pathlib import Path

import pytest

slicer = pytest.importorskip("slicer", reason="slicer-core is not installed")

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "AIFRecon"))

from AIFReconScene.live.inSteps import InSteps  # noqa: E402 - needs slicer


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
    assert in_steps.begin(views.steps("first", "second"))
    while in_steps.isUnderWay:
        in_steps.goOn()
    assert (views.did, views.paused) == ([("first", 1), ("second", 1)], 0)


def test_steps_that_are_interrupted_leave_views_drawn(views):
    in_steps = InSteps()
    in_steps.begin(views.steps("first", "second"))
    in_steps.interrupt()
    assert not in_steps.goOn()
    assert (views.did, views.paused) == ([("first", 1)], 0)


def test_a_step_that_fails_ends_them_and_leaves_views_drawn(views):
    in_steps = InSteps()
    in_steps.begin(views.steps("first", ValueError))
    with pytest.raises(ValueError):
        in_steps.goOn()
    assert not in_steps.isUnderWay
    assert views.paused == 0


def test_views_that_somebody_else_has_paused_stay_paused(views):
    views.pauseRender()
    assert not InSteps().begin(views.steps())
    assert views.paused == 1
