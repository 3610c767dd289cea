"""Import paths that the documentation once named go on working."""

from __future__ import annotations

import importlib
import sys
from importlib.util import find_spec

import pytest

from AIFReconLib.machine.moved import MOVED, find_moved_modules


@pytest.mark.parametrize(("old", "new"), MOVED.items())
def test_an_old_path_gives_the_very_same_things(old, new, monkeypatch):
    monkeypatch.delitem(sys.modules, old, raising=False)
    with pytest.warns(DeprecationWarning, match=f"{old} is {new} now"):
        before = importlib.import_module(old)
    now = importlib.import_module(new)
    names = [name for name, value in vars(now).items() if getattr(value, "__module__", None) == new]
    assert names
    assert all(getattr(before, name) is getattr(now, name) for name in names)


def test_a_path_that_never_was_is_not_found():
    assert find_spec("AIFReconLib.no_such_room") is None


def test_the_finder_is_there_once():
    count = len(sys.meta_path)
    find_moved_modules()
    assert len(sys.meta_path) == count
