"""Gathers the pages of the documentation site from the files of the project, and builds it.

What stands in a README is not written twice: pages are those files, with their links turned to where they stand in the
site; the reference of keys is generated from the models, the page of the notebook from its cells.
"""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from workflow.report.reference import markdown

HERE = Path(__file__).parent
TOP = HERE.parent
PAGES = HERE / "build" / "pages"
PUBLISHED = TOP / "tests" / "verification" / "published"
# Pages that are files of the project; a link to one of them becomes a link to the page.
FILES = {
    "README.md": "index.md",
    "meshes/README.md": "meshes.md",
    "fem/README.md": "fem.md",
    "dem/README.md": "dem.md",
    "workflow/README.md": "workflow.md",
    "tests/README.md": "tests.md",
    "docs/tutorials/river_bank.md": "tutorial.md",
    "docs/changelog.md": "changelog.md",
}


def gather() -> None:
    """Write all pages anew."""
    shutil.rmtree(PAGES, ignore_errors=True)
    PAGES.mkdir(parents=True)
    for file, page in FILES.items():
        (PAGES / page).write_text(turned((TOP / file).read_text(encoding="utf-8")), encoding="utf-8")
    (PAGES / "keys.md").write_text(markdown(), encoding="utf-8")
    (PAGES / "s13.md").write_text(of_notebook(HERE / "s13.ipynb"), encoding="utf-8")
    shutil.copytree(TOP / "docs/pictures", PAGES / "pictures")
    shutil.copytree(PUBLISHED, PAGES / "published", ignore=lambda _, names: [n for n in names if n.endswith(".json")])


def turned(text: str) -> str:
    """A page with its pictures and links where the site has them."""
    for file, page in FILES.items():
        text = text.replace(f"]({file})", f"]({page})").replace(f"`{file}`", f"[`{file}`]({page})")
    return text.replace("](docs/pictures/", "](pictures/")


def of_notebook(path: Path) -> str:
    """The cells of a notebook, one after the other."""
    parts = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        parts.append(f"```python\n{source}\n```" if cell["cell_type"] == "code" else source)
    return "\n\n".join(parts) + "\n"


def build() -> int:
    """The exit code of mkdocs, which fails at any link that leads nowhere."""
    line = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--clean", "-f", str(HERE / "mkdocs.yml")]
    return subprocess.run(line, check=False, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}).returncode


if __name__ == "__main__":
    gather()
    code = build()
    if code == 0:
        print(f"{HERE / 'build' / 'site' / 'index.html'}")
    sys.exit(code)
