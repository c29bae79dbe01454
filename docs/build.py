"""Builds the documentation site, without the network: `python docs/build.py`.

Pages are the files of `docs`; the README is the first page. What follows from the program is generated here: keys of a
section file, commands, the Python interface, validation. Links between files become links between pages.
"""

import ast
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).resolve().parent
TOP = HERE.parent
sys.path.insert(0, str(TOP))

from docs.generated import closed_forms, commands, dates, keys, python_interface, s13, speed  # noqa: E402

PAGES, SITE = HERE / "build" / "pages", HERE / "build" / "site"
COLLECTIONS = {"slopes": TOP / "tests/verification/published", "slides": TOP / "tests/verification/slides"}
GENERATED = {
    "reference/keys.md": keys,
    "reference/commands.md": commands,
    "reference/python.md": python_interface,
    "validation/closed_forms.md": closed_forms,
    "validation/s13.md": s13,
    "validation/speed.md": speed,
}
# What links to them say.
TITLES = {
    "reference/keys.md": "Keys of a section file",
    "reference/commands.md": "Commands",
    "reference/python.md": "Python interface",
    "validation/closed_forms.md": "Closed forms",
    "validation/s13.md": "S-13",
    "validation/speed.md": "Speed",
}
# Pages that are made, not written, and the folders of collections whose README becomes a page.
MADE = {*GENERATED, *(f"validation/{name}.md" for name in COLLECTIONS)}
LINK = re.compile(r"\]\(([^)\s#]+)(#[^)\s]*)?\)")
PACKAGES = ("meshes", "fem", "dem", "workflow")


def sources() -> dict[Path, str]:
    """Return the written pages: each file with its place in the site."""
    files = sorted(path for path in HERE.rglob("*.md") if "build" not in path.relative_to(HERE).parts)
    return {TOP / "README.md": "index.md"} | {path: str(path.relative_to(HERE)) for path in files}


def links(path: Path) -> Iterator[tuple[str, Path, str]]:
    """Yield the links of a page to files: the text of the link, the file, and the anchor."""
    for target, anchor in LINK.findall(path.read_text(encoding="utf-8")):
        if "://" not in target:
            yield target, Path(os.path.normpath(path.parent / target)), anchor.removeprefix("#")


def module_of(path: Path) -> str:
    """Return the module of a source file."""
    return ".".join(path.relative_to(TOP).with_suffix("").parts)


def gather() -> None:
    """Write all pages into the build folder."""
    shutil.rmtree(HERE / "build", ignore_errors=True)
    PAGES.mkdir(parents=True)
    modules = set()
    for path, page in sources().items():
        text = with_code(path, path.read_text(encoding="utf-8"))
        for target, leads_to, anchor in links(path):
            place = moved(page, leads_to, anchor)
            if place is None:
                text = re.sub(rf"\[([^]]*)\]\({re.escape(target)}\)", r"\1", text)
            else:
                text = text.replace(f"]({target}{'#' + anchor if anchor else ''})", f"]({place})")
            if leads_to.suffix == ".py" and leads_to.relative_to(TOP).parts[0] in PACKAGES:
                modules.add(module_of(leads_to))
        for made, title in TITLES.items():  # pages name them and do not link to them: only the site has such files
            text = text.replace(f"`{made}`", f"[{title}]({os.path.relpath(made, os.path.dirname(page) or '.')})")
        computed = dates(text)
        write(page, text + (f"\nNumbers of this page:\n{computed}\n" if computed else ""))
    for page, make in GENERATED.items():
        write(page, make())
    for module in sorted(modules):
        write(f"reference/functions/{module}.md", f"# `{module}`\n\n::: {module}\n")
    for name, folder in COLLECTIONS.items():
        text = (folder / "README.md").read_text(encoding="utf-8")
        text = re.sub(r"\[([^]]+)\]\(\1\.toml\)", r"\1", text)  # the files of the cases are no pages
        write(f"validation/{name}.md", text.replace("](pictures/", f"]({name}/"))
        shutil.copytree(folder / "pictures", PAGES / "validation" / name)
    for path in HERE.rglob("*"):
        if path.suffix in (".png", ".css") and "build" not in path.relative_to(HERE).parts:
            place = PAGES / path.relative_to(HERE)
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(path, place)


def with_code(path: Path, text: str) -> str:
    """Return a page of the gallery in which the code of the scripts replaces the links to them."""
    return re.sub(
        r"\[code\]\((\w+\.py)\)",
        lambda link: f"```python\n{(path.parent / link[1]).read_text(encoding='utf-8')}```",
        text,
    )


def write(page: str, text: str) -> None:
    """Write one page."""
    path = PAGES / page
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def moved(page: str, leads_to: Path, anchor: str) -> str | None:
    """Return the target of a link in the site; None if the file is not a page."""
    inside = leads_to.relative_to(TOP)
    collections = [name for name, folder in COLLECTIONS.items() if leads_to == folder / "README.md"]
    if leads_to == TOP / "README.md":
        place = "index.md"
    elif collections:
        place = f"validation/{collections[0]}.md"
    elif inside.parts[0] == "docs":
        place = str(leads_to.relative_to(HERE))
    elif leads_to.suffix == ".py" and inside.parts[0] in PACKAGES:  # a law of a page of theory
        place = f"reference/functions/{module_of(leads_to)}.md"
        anchor = f"{module_of(leads_to)}.{anchor}" if anchor else ""
    else:
        return None
    return os.path.relpath(place, os.path.dirname(page) or ".") + (f"#{anchor}" if anchor else "")


def build() -> int:
    """Build the site and return the exit code of mkdocs, which fails at links without a target."""
    line = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--clean", "-f", str(HERE / "mkdocs.yml")]
    paths = os.pathsep.join([str(TOP), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        line, check=False, env={**os.environ, "NO_MKDOCS_2_WARNING": "1", "PYTHONPATH": paths}
    ).returncode


def names_in(path: Path) -> set[str]:
    """Return the names that a source file defines at its top level."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}


if __name__ == "__main__":
    gather()
    code = build()
    if code == 0:
        print(SITE / "index.html")
    sys.exit(code)
