"""Drawing goes on after a pause, and the windows are alive between one view and the next."""

import contextlib

import slicer


@contextlib.contextmanager
def drawnViewByView(progress=None):
    """Nothing is drawn within; after it one view after the other is.

    Parameters
    ----------
    progress : callable or None
        Hears of each view, so that windows are alive in between. That it may ask to cancel is not regarded.
    """
    slicer.app.pauseRender()
    try:
        yield
    finally:
        for _step in viewByView():
            if progress is not None:
                progress(1.0, "")


def viewByView():
    """Go on drawing after `slicer.app.pauseRender()`, one view with every step; all that are left where no more steps are taken."""
    views = _views()
    for view in views:
        view.pauseRender()
    slicer.app.resumeRender()
    try:
        while views:
            _draw(views.pop())
            yield
    finally:
        for view in views:
            _draw(view)


def drawnInTheEnd(steps):
    """These steps, an iterator, while nothing is drawn; then one view with every further step. Where one goes wrong all views are drawn."""
    slicer.app.pauseRender()
    try:
        yield from steps
    except BaseException:  # the end of a generator too
        slicer.app.resumeRender()
        raise
    yield from viewByView()


def _draw(view) -> None:
    if view:  # a destroyed one is false
        view.resumeRender()


def _views() -> list:
    layoutManager = slicer.app.layoutManager()
    if layoutManager is None:
        return []
    slices = [layoutManager.sliceWidget(name) for name in layoutManager.sliceViewNames()]
    return [*slices, *(layoutManager.threeDWidget(number) for number in range(layoutManager.threeDViewCount))]
