"""Drawing goes on after a pause, and the windows are alive between one view and the next."""

import slicer


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


def _draw(view) -> None:
    if view:  # a destroyed one is false
        view.resumeRender()


def _views() -> list:
    layoutManager = slicer.app.layoutManager()
    if layoutManager is None:
        return []
    slices = [layoutManager.sliceWidget(name) for name in layoutManager.sliceViewNames()]
    return [*slices, *(layoutManager.threeDWidget(number) for number in range(layoutManager.threeDViewCount))]
