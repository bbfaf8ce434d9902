"""The documentation as a site, built by Sphinx from the pages as they stand: `make docs`.

The source is the whole repository, so that links between README, docs and the pages of other folders hold. What the
sidebar lists follows from the links of docs/index.md, section by section, and of the gallery.
"""

import re

project = "Bulkwear"
author = "The authors of Bulkwear"
copyright = f"{author}, GPL-2.0-or-later"
extensions = ["myst_parser"]
root_doc = "docs/index"
include_patterns = [
    "*.md",
    "docs/*.md",
    "config/README.md",
    "templates/README.md",
    "meshes/README.md",
    "solver/README.md",
]
exclude_patterns = [
    ".*",
    "results",
    "docs/site",
    "tests",
    "workflows",
    "postproc",
    "benchmarks",
    "profiles",
    "bulkwear",
]
myst_heading_anchors = 4
highlight_language = "none"  # of blocks that name none: what a terminal prints
suppress_warnings = ["misc.highlighting_failure"]  # no highlighting of CSV
html_theme = "furo"
html_title = project
html_extra_path = ["extra"]
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False

LISTING = ("docs/index", "docs/gallery")  # pages whose links make the sidebar
LINK = re.compile(r"\[(?:!\[[^\]]*\]\([^)]*\)|[^\]])*\]\(([^)#\s]+)\.md\)")


def with_contents(app, name: str, source: list[str]) -> None:
    """Add to a listing page, for each of its sections, a hidden list of the pages that it links to.

    What stands above the first section of the gallery is no result.
    """
    if name not in LISTING:
        return
    listed: set[str] = set()
    for section in re.split(r"^(?=#+ )", source[0], flags=re.MULTILINE):
        if name != root_doc and not section.startswith("## "):
            continue
        pages = [page for page in dict.fromkeys(LINK.findall(section)) if page not in listed]
        listed |= set(pages)
        title = section.partition("\n")[0].lstrip("# ")
        if pages:
            lines = [":hidden:", *([f":caption: {title}"] if name == root_doc else []), "", *pages]
            source[0] += "\n\n```{toctree}\n" + "\n".join(lines) + "\n```\n"


def setup(app) -> None:
    """Tell Sphinx who adds the contents."""
    app.connect("source-read", with_contents)
