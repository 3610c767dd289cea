"""Python's garbage is left alone while windows must not stand still."""

import contextlib
import gc

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
