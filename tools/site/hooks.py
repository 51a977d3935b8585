"""The project's part of the site: pages from outside docs/, pages made from the program, links to source files."""

import posixpath
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

from tools.site.reference import commands, schemas

_ROOT = Path(__file__).resolve().parents[2]
_OUTSIDE = {"ARCHITECTURE.md": "architecture.md", "CHANGELOG.md": "changelog.md", "SECURITY.md": "security.md"}
_LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!https?:|#)([^)#]+)(#[^)]*)?\)")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that are not in docs/."""
    for name, page in _OUTSIDE.items():
        files.append(File.generated(config, page, abs_src_path=str(_ROOT / name)))
    files.append(File.generated(config, "reference/schemas.md", content=schemas()))
    files.append(File.generated(config, "reference/commands.md", content=commands()))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Lead links to the pages of the site; one to a source file, which the site does not have, becomes its path."""
    here = page.file.src_uri
    outside = here in _OUTSIDE.values()
    folder = "" if outside else posixpath.join("docs", posixpath.dirname(here))

    def lead(link: re.Match[str]) -> str:
        text, path, anchor = link[1], posixpath.normpath(posixpath.join(folder, link[2])), link[3] or ""
        target = _OUTSIDE.get(path, path.removeprefix("docs/"))
        if files.get_file_from_path(target) is None:
            return text if "`" in text or path in text else f"{text} (`{path}`)"
        return f"[{text}]({posixpath.relpath(target, posixpath.dirname(here) or '.')}{anchor})"

    return _LINK.sub(lead, markdown)
