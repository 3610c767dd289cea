"""What the gallery needs besides sphinx-gallery: pictures that volumes draw of themselves, and notebooks that open with their outputs."""

from __future__ import annotations

from pathlib import Path

NOTEBOOKS = ("first_reconstruction", "own_arrays", "own_method")
"""Examples whose notebooks hold what they print and draw; the others' are to be run."""

_shown: set[int] = set()


def picture_scraper(block, block_vars, gallery_conf) -> str:
    """Takes the pictures of `Volume.plot()` into the page of an example."""
    from sphinx_gallery.scrapers import figure_rst

    from AIFReconLib.evaluation.preview import PreviewImage

    paths = []
    for value in list(block_vars["example_globals"].values()):
        if isinstance(value, PreviewImage) and id(value) not in _shown:
            _shown.add(id(value))
            path = Path(next(block_vars["image_path_iterator"]))
            value.write(path)
            paths.append(str(path))
    return figure_rst(paths, gallery_conf["src_dir"])


def _get_sg_image_scraper():
    """By this name sphinx-gallery finds a module's scraper."""
    return picture_scraper


def run_notebooks(app) -> None:
    """Runs the notebooks that are named above, in place, where sphinx-gallery has written them anew."""
    if not app.config.sphinx_gallery_conf["plot_gallery"]:
        return
    import nbformat
    from nbconvert.preprocessors import ExecutePreprocessor

    folder = Path(app.srcdir) / "docs" / "gallery"
    for name in NOTEBOOKS:
        [path] = folder.glob(f"*{name}.ipynb")
        notebook = nbformat.read(path, as_version=4)
        if any(cell.get("outputs") for cell in notebook.cells):
            continue
        ExecutePreprocessor(timeout=600, kernel_name="python3").preprocess(
            notebook, {"metadata": {"path": str(Path(app.srcdir) / "docs" / "examples")}}
        )
        nbformat.write(notebook, path)
