"""README, docs/ and the sources they link to as one site that needs no network to be read: `make site`, out/site/index.html.

The pages are the same files that a repository shows; nothing is written twice. Links to sources lead to pages of the site that show the file.
"""

import logging
import os
import re
import shutil
import subprocess
import tempfile
from pathlib import Path

from host.twin.image import BUILD, ROOT

SITE = ROOT / "out" / "site"
# Scripts of the site that are no part of mkdocs: (package of npm, version, file in it). Kept in build/ once they are there.
MERMAID = ("mermaid", "11.4.1", "dist/mermaid.min.js")  # draws the diagrams
SHIM = ("iframe-worker", "1.0.4", "shim/index.js")  # lets the search work in pages opened from a disk
SHIM_AT = re.compile(r'https://[^"\s]*iframe-worker/shim')  # where the theme would take it from
SOURCES = (".py", ".json", ".js", ".toml", ".html")
PLAIN = ("LICENSE", "Makefile")
_LINK = re.compile(r'(\]\(|src="|href=")([^)\s"#]+)')
NAV = (
    ("Gapseeker", "index.md"),
    ("Build", ("wiring", "robot-json", "examples/README.md", "flash", "first-power-up", "screen")),
    ("Drive", ("monitor", "tuning", "troubleshooting", "safety")),
    ("Understand", ("definitions", "planner", "goals", "arm", "twin", "recording", "protocol")),
    ("Judge", ("results", "bench", "memory")),
    ("Change", ("CONTRIBUTING.md", "architecture", "CHANGELOG.md")),
)


class SiteError(Exception):
    """The site cannot be built; the message says why, and what to do."""


def build(target=SITE):
    """Make the site in a folder, which is made anew; [what the reader lacks]. SiteError."""
    lacking = []
    with tempfile.TemporaryDirectory() as folder:
        pages = Path(folder) / "pages"
        lay_out(pages)
        script, shim = fetched(MERMAID), fetched(SHIM)
        if script is None or shim is None:
            lacking.append("diagrams are shown as text, and pages opened from a disk have no search: npm is missing, or it cannot reach its registry")
        if script is not None:
            shutil.copyfile(script, pages / "mermaid.min.js")
        settings = Path(folder) / "mkdocs.yml"
        settings.write_text(_settings(pages, Path(target), script is not None))
        _mkdocs(settings)
    _keep_at_home(Path(target), shim)
    return lacking


def _keep_at_home(site, shim):
    """Nothing of the site may lead a browser elsewhere by itself: the search's script is taken from the site."""
    if shim is not None:
        shutil.copyfile(shim, site / "search" / "shim.js")
    for page in site.rglob("*.html"):
        text = page.read_text()
        here = os.path.relpath(site / "search" / "shim.js", page.parent)
        page.write_text(SHIM_AT.sub(here, text))


def lay_out(pages):
    """Copy all pages, and what they show and link to, into a folder as mkdocs wants it: README.md becomes index.md, a source a page of its own."""
    pages.mkdir(parents=True)
    for page in page_files():
        place = pages / _place(page)
        place.parent.mkdir(parents=True, exist_ok=True)
        place.write_text(_redirected(page, pages))
    return pages


def page_files():
    """All Markdown files of the site, paths from the root."""
    return [Path(name) for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "examples/README.md")] + sorted(
        path.relative_to(ROOT) for path in (ROOT / "docs").rglob("*.md")
    )


def _place(path):
    return Path("index.md") if path == Path("README.md") else path


def _redirected(page, pages):
    """The page's text with its links as they are in the site; what they lead to is put there."""

    def redirect(found):
        told = found[2]
        if "://" in told or told.startswith("mailto:"):
            return found[0]
        target = Path(os.path.normpath(page.parent / told))
        if not (ROOT / target).exists():
            raise SiteError(f"{page} links to {told}, which is not there")
        return found[1] + os.path.relpath(_put(target, pages), _place(page).parent)

    return _LINK.sub(redirect, (ROOT / page).read_text())


def _put(target, pages):
    """Where the site has what a link leads to."""
    if target.suffix == ".md":
        return _place(target)
    if (ROOT / target).is_dir():
        return _put(target / "README.md", pages) if (ROOT / target / "README.md").exists() else _source(target, pages)
    if target.suffix in SOURCES or target.name in PLAIN:
        return _source(target, pages)
    (pages / target).parent.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(ROOT / target, pages / target)
    return target


def _source(target, pages):
    """A page that shows a source, or what a folder holds."""
    place = Path(f"{target}.md")
    kind = {".py": "python", ".json": "json", ".js": "javascript", ".toml": "toml", ".html": "html"}.get(target.suffix, "text")
    path = ROOT / target
    shown = "\n".join(sorted(entry.name for entry in path.iterdir() if entry.name != "__pycache__")) if path.is_dir() else path.read_text().rstrip()
    (pages / place).parent.mkdir(parents=True, exist_ok=True)
    (pages / place).write_text(f"# {target}\n\n`````{kind}\n{shown}\n`````\n")
    return place


def _settings(pages, target, drawn):
    """mkdocs.yml: no fonts, scripts or analytics from elsewhere, file names that a browser opens from a disk."""
    nav = []
    for title, entries in NAV:
        if isinstance(entries, str):
            nav.append(f"  - {title}: {entries}")
        else:
            nav.append(f"  - {title}:")
            nav += [f"    - {_page(name)}" for name in entries]
    named = {_page(name) for _, entries in NAV for name in ([entries] if isinstance(entries, str) else entries)}
    if more := [str(_place(page)) for page in page_files() if str(_place(page)) not in named]:
        nav += ["  - More:", *(f"    - {name}" for name in more)]
    style = pages / "site.css"
    style.write_text(CSS)
    scripts = "extra_javascript: [mermaid.min.js]\n" if drawn else ""
    return f"""site_name: Gapseeker
site_dir: {target}
docs_dir: {pages}
use_directory_urls: false
{scripts}extra_css: [site.css]
theme:
  name: material
  font: false
  features: [navigation.tabs, navigation.top, toc.follow, content.code.copy]
  palette:
    - {{media: "(prefers-color-scheme: light)", scheme: default, primary: custom, accent: custom, toggle: {{icon: material/weather-night, name: dark}}}}
    - {{media: "(prefers-color-scheme: dark)", scheme: slate, primary: custom, accent: custom, toggle: {{icon: material/weather-sunny, name: light}}}}
plugins: [search, offline]
validation: {{omitted_files: ignore, anchors: ignore}}
markdown_extensions:
  - tables
  - attr_list
  - md_in_html
  - toc: {{permalink: true}}
  - pymdownx.highlight
  - pymdownx.superfences: {{custom_fences: [{{name: mermaid, class: mermaid, format: !!python/name:pymdownx.superfences.fence_code_format }}]}}
nav:
{chr(10).join(nav)}
"""


def _page(name):
    return name if name.endswith(".md") else f"docs/{name}.md"


CSS = """:root, [data-md-color-scheme=default], [data-md-color-scheme=slate] {
  --md-primary-fg-color: #1f6f8b; --md-primary-fg-color--light: #1f6f8b; --md-primary-fg-color--dark: #18566c; --md-accent-fg-color: #d1495b;
}
[data-md-color-scheme=default] { --md-typeset-a-color: #18566c; }
[data-md-color-scheme=slate] { --md-typeset-a-color: #7cc0d8; }
.md-grid { max-width: 76rem; }
.md-typeset table:not([class]) { font-size: .68rem; }
.md-typeset img { background: #ffffff; border-radius: 4px; }
"""


def fetched(script):
    """The file of a script of npm's, fetched the first time; None where that cannot be."""
    package, version, file = script
    kept = BUILD.parent / "site" / f"{package}-{version}.js"
    if kept.is_file():
        return kept
    if shutil.which("npm") is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run(["npm", "pack", "--silent", f"{package}@{version}"], cwd=folder, capture_output=True, text=True)
        packed = list(Path(folder).glob("*.tgz"))
        if done.returncode or not packed:
            return None
        shutil.unpack_archive(packed[0], folder, filter="data")
        kept.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(Path(folder) / "package" / file, kept)
    return kept


def _mkdocs(settings):
    """Run mkdocs. Warnings, such as a link that leads nowhere, are errors."""
    try:
        from mkdocs.commands.build import build as make
        from mkdocs.config import load_config
        from mkdocs.exceptions import MkDocsException
    except ImportError:
        raise SiteError("mkdocs is missing: say make site, which installs it") from None
    logging.getLogger("mkdocs").setLevel(logging.WARNING)
    counted = _Counter()
    logging.getLogger("mkdocs").addHandler(counted)
    try:
        make(load_config(str(settings)))
    except MkDocsException as error:
        raise SiteError(str(error)) from None
    finally:
        logging.getLogger("mkdocs").removeHandler(counted)
    if counted.said:
        raise SiteError("; ".join(counted.said))


class _Counter(logging.Handler):
    """Keeps the warnings."""

    def __init__(self):
        super().__init__(logging.WARNING)
        self.said: list[str] = []

    def emit(self, record):
        self.said.append(record.getMessage())
