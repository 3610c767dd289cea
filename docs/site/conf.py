"""The site: the Markdown pages of the repository as they are, the gallery, and the API reference of every room. `make docs` builds it.

Sphinx reads the repository from its top, so that the links of the pages to each other, to pictures and to files
lead where they lead on GitHub.
"""

from __future__ import annotations

import re
import sys
import types
from pathlib import Path

from docutils import nodes
from docutils.utils.math.latex2mathml import tex2mathml

REPOSITORY = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(REPOSITORY), str(Path(__file__).resolve().parent)]

import api_pages  # noqa: E402
import gallery  # noqa: E402

import AIFReconLib  # noqa: E402

project = "AIFRecon"
version = release = AIFReconLib.__version__
copyright = "the AIFRecon contributors"
homepage = re.search(r'set\(EXTENSION_HOMEPAGE "(.*?)"\)', (REPOSITORY / "CMakeLists.txt").read_text("utf-8"))
HOMEPAGE = "" if homepage is None or homepage.group(1) == "NA" else homepage.group(1)

extensions = [
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "myst_parser",
    "sphinx_gallery.gen_gallery",
    "sphinx_copybutton",
]
root_doc = "README"
source_suffix = {".rst": "restructuredtext", ".md": "markdown"}
include_patterns = ["README.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md", "CODE_OF_CONDUCT.md", "docs/**"]
exclude_patterns = [
    "docs/site/**",
    "docs/examples/**",
    "docs/measured/**",
    "docs/gallery/*.py",
    "docs/gallery/*.ipynb",
    "docs/gallery/sg_execution_times.rst",
    "**/.*",
]

# ---- pages

myst_enable_extensions = ["dollarmath", "html_image"]
myst_heading_anchors = 4
highlight_language = "none"
nitpicky = True

TABLES = {
    "README": [("docs/index",), ("docs/gallery/index",), ("docs/api/index",), ("CHANGELOG",), ("CONTRIBUTING",)],
    "docs/index": [
        (
            "Use",
            "slicer",
            "slicer-data",
            "slicer-live",
            "live-setup",
            "live",
            "coordinate-frames",
            "plus",
            "import",
            "registration",
            "calibration",
            "first-calibration",
            "calibration-phantom",
            "guidance",
            "paths",
            "own-data",
            "without-ct",
            "motion",
            "cohorts",
            "for-a-paper",
            "troubleshooting",
        ),
        (
            "Understand",
            "concepts",
            "method",
            "parameters",
            "own-method",
            "study",
            "real-bone",
            "comparison",
            "review",
            "performance",
            "reliability",
        ),
        ("Develop", "developers", "publishing"),
        ("Decisions", "decisions/*"),
    ],
    "CONTRIBUTING": [("CODE_OF_CONDUCT",), ("SECURITY",)],
}
"""What is below which page, in the site's menus; on GitHub the pages do without."""


def add_tables(app, docname: str, source: list[str]) -> None:
    """Sphinx wants to know which page is below which."""
    for caption, *pages in TABLES.get(docname, []):
        if not pages:
            caption, pages = "", [caption]
        options = ":hidden:\n" + (f":caption: {caption}\n" if caption else "") + (":glob:\n" if "*" in "".join(pages) else "")
        source[0] += "\n\n```{toctree}\n" + options + "\n" + "\n".join(pages) + "\n```\n"


html_math_renderer = "mathml"


def add_formula(as_block: bool):
    """Formulas as MathML, which browsers draw themselves: a page fetches nothing from elsewhere."""

    def visit(translator, node) -> None:
        formula = tex2mathml(node.astext(), as_block=as_block)
        translator.body.append(f'<div class="formula">{formula}</div>' if as_block else formula)
        raise nodes.SkipNode

    return visit, None


# ---- API

default_role = "py:obj"
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
autodoc_mock_imports: list[str] = []
autosummary_generate = False
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
add_module_names = False
toc_object_entries = False
# numpydoc makes citations of what a section References lists; not each is pointed at
suppress_warnings = ["ref.citation"]


def skip_foreign(app, what: str, name: str, member: object, skip: bool, options) -> bool | None:
    """Types of arrays stand on the pages as `api_pages` writes them; classes of other packages are documented there."""
    is_alias = isinstance(member, types.GenericAlias | types.UnionType) or type(member).__module__ == "typing"
    is_foreign = isinstance(member, type) and not member.__module__.startswith("AIFReconLib")
    return True if what == "module" and (is_alias or is_foreign) else None


def without_far_citations(app, what: str, name: str, member: object, options, lines: list[str]) -> None:
    """A number that is explained in the docstring of the file, and not in this one, cannot be followed from here."""
    if not any(re.match(r"\s*\.\. \[\d+\]", line) for line in lines):
        lines[:] = [re.sub(r"(\[\d+\])_", r"\1", line) for line in lines]


def resolve_name(app, env, node, contnode):
    """A name in single backticks leads to what it names, if that is one thing; else it is code."""
    if node.get("refdomain") != "py" or node.get("reftype") != "obj":
        return None
    from sphinx.util.nodes import make_refnode

    domain = env.get_domain("py")
    found = (
        domain.find_obj(env, None, None, node["reftarget"].removesuffix("()"), None, 1)
        if re.fullmatch(r"[A-Za-z_][\w.]*(\(\))?", node["reftarget"])
        else []
    )
    if len(found) == 1:
        _, entry = found[0]
        return make_refnode(app.builder, node["refdoc"], entry.docname, entry.node_id, contnode, node["reftarget"])
    return contnode


# ---- gallery

sphinx_gallery_conf = {
    "examples_dirs": "docs/examples",
    "gallery_dirs": "docs/gallery",
    "filename_pattern": r"\.py$",
    "ignore_pattern": r"__init__\.py",
    "within_subsection_order": "FileNameSortKey",
    "image_scrapers": ("matplotlib", "gallery"),
    "capture_repr": (),
    "download_all_examples": False,
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 10_000,
    "abort_on_example_error": True,
    "copyfile_regex": "",
    "backreferences_dir": None,
}

# ---- look

html_theme = "pydata_sphinx_theme"
html_title = "AIFRecon"
html_logo = "../../Resources/AIFRecon.png"
html_favicon = "../../Resources/AIFRecon.png"
html_static_path = ["static"]
html_css_files = ["aifrecon.css"]
html_extra_path = ["extra"]
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
html_theme_options = {
    "show_nav_level": 1,
    "collapse_navigation": True,
    "navigation_depth": 2,
    "navigation_with_keys": False,
    "show_toc_level": 2,
    "header_links_before_dropdown": 6,
    "navbar_align": "left",
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "back_to_top_button": True,
    "show_prev_next": False,
    **({"github_url": HOMEPAGE} if HOMEPAGE else {}),
}
html_sidebars = {"README": [], "CHANGELOG": [], "CONTRIBUTING": []}


def setup(app) -> None:
    """Hooks of this file."""
    api_pages.write(REPOSITORY, REPOSITORY / "docs" / "api")
    app.add_html_math_renderer("mathml", add_formula(False), add_formula(True))
    app.connect("source-read", add_tables)
    app.connect("autodoc-skip-member", skip_foreign)
    app.connect("autodoc-process-docstring", without_far_citations, priority=100)
    app.connect("missing-reference", resolve_name)
    app.connect("builder-inited", gallery.run_notebooks, priority=900)
