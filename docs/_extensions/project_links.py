"""Links of Markdown pages as they are written for readers of the repository, turned into links of the site.

`docs/project` holds symbolic links to ARCHITECTURE.md and others, so that these are pages too. A relative link is
followed from where the file really stands: it leads to a page of the site where there is one, and becomes plain text
where it names another file of the repository.
"""

import os
import re
from pathlib import Path

from sphinx.application import Sphinx

_LINK = re.compile(r"(?<!!)\[(?P<text>[^\]\[]+)\]\((?P<path>[^)#:\s]+)(?P<anchor>#[^)\s]+)?\)")
_IMAGE = re.compile(r"!\[(?P<text>[^\]\[]*)\]\((?P<path>[^)#:\s]+)\)")


def setup(app: Sphinx) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("source-read", _rewrite)
    return {"parallel_read_safe": True}


def _rewrite(app: Sphinx, docname: str, source: list[str]) -> None:
    page = Path(os.fspath(app.env.doc2path(docname)))
    if page.suffix != ".md":
        return
    here = page.resolve().parent
    pages = {Path(os.fspath(app.env.doc2path(name))).resolve(): name for name in app.env.found_docs}

    def link(match: re.Match[str]) -> str:
        target = (here / match["path"]).resolve()
        if target in pages and match["anchor"]:
            return f"[{match['text']}](/{pages[target]}.md{match['anchor']})"
        if target in pages:
            return f"{{doc}}`{match['text'].strip('`')} </{pages[target]}>`"
        if target.exists():
            return match["text"]
        raise FileNotFoundError(f"{page}: no file {match['path']}")

    def image(match: re.Match[str]) -> str:
        return f"![{match['text']}]({os.path.relpath(here / match['path'], page.parent)})"

    source[0] = _IMAGE.sub(image, _LINK.sub(link, source[0]))
