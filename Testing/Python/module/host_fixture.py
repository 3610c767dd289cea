"""What the tests of the host share: the host itself, skipped with the reason where it cannot run."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="session")
def the_host():
    """The host of this process."""
    from host import missing, runHost

    if reason := missing():
        pytest.skip(f"the Slicer host cannot run here: {reason}")
    return runHost()


@pytest.fixture
def host(the_host):
    """The host with an empty scene; a slot that raised without the test asking for it fails the test."""
    import slicer

    before = slicer.mrmlScene
    slicer.mrmlScene = the_host.scene
    the_host.reset()
    yield the_host
    errors = the_host.take_slot_errors()
    the_host.reset()
    slicer.mrmlScene = before
    assert errors == [], "a slot raised"


@pytest.fixture
def qt(host):
    """The module `qt`."""
    import qt

    return qt
