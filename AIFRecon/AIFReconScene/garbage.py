"""Python's garbage is left alone while windows must not stand still."""

import contextlib
import gc

MANY = 3
"""Rounds of young objects, some 20,000 each, that a run makes before it looks at all that it has made."""

_within = 0


@contextlib.contextmanager
def leftAlone():
    """Within, no garbage is looked for among the objects that there are already.

    Notes
    -----
    Now and then Python looks at all objects for garbage, on whatever thread makes the next one: at an application's for 0.1 s, in which
    nothing else of Python runs. What comes within is looked at as ever, and all is again after it. The main thread's alone.
    """
    global _within
    if not _within:
        gc.freeze()
    _within += 1
    try:
        yield
    finally:
        _within -= 1
        if not _within:
            gc.unfreeze()


def lookInTime() -> bool:
    """Look for garbage among what came within, before it is too much for one look; True where that was done, never in a scan.

    Python by itself waits until what came is a quarter of all, and what numba makes in a first run, to compile it, is then looked at for
    0.3 s.
    """
    due = _within == 1 and gc.get_count()[2] > MANY
    if due:
        gc.collect()
    return due
