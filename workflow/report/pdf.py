"""report.pdf: the page as it prints, by Chromium where there is one, or by WeasyPrint."""

import os
import shutil
import subprocess
import tempfile
from importlib.util import find_spec
from pathlib import Path

from meshes.errors import InputError
from workflow.run.store import Store

FILE, PAGE = "report.pdf", "report.html"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
PATIENCE = 180.0  # s for a page to print
NEEDED = (
    "needs Chromium or WeasyPrint, and neither is there: on Debian and Ubuntu apt install chromium, or anywhere pip "
    "install 'noshiro[pdf]'; any browser prints report.html, too"
)


def browser() -> str | None:
    """The browser of this machine that can print, if it has one."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def write_pdf(store: Store) -> Path:
    """Print the report of a folder; raises InputError where nothing can print it."""
    page = store.folder / PAGE
    program = browser()
    if program is None and find_spec("weasyprint") is None:
        raise InputError("--pdf", [NEEDED])
    with store.writing(FILE) as path:
        if program is not None:
            _by_browser(program, page, path)
        else:
            _by_weasyprint(page, path)
    return store.folder / FILE


def _by_browser(program: str, page: Path, path: Path) -> None:
    """Let a browser print, without a screen and with a profile that is forgotten."""
    with tempfile.TemporaryDirectory(prefix="noshiro-", ignore_cleanup_errors=True) as profile:
        printed = Path(profile) / "printed.pdf"
        line = [
            program, "--headless=new", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", f"--user-data-dir={profile}",
            "--no-pdf-header-footer", f"--print-to-pdf={printed}", page.resolve().as_uri(),
        ]  # fmt: skip
        if hasattr(os, "geteuid") and os.geteuid() == 0:
            line.insert(1, "--no-sandbox")  # Chromium has none for root
        try:
            done = subprocess.run(line, capture_output=True, text=True, timeout=PATIENCE, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise InputError("--pdf", [f"{program} did not print: {error}"]) from None
        if not printed.is_file():
            told = done.stderr.strip().splitlines()[-1:] or [f"exit code {done.returncode}"]
            raise InputError("--pdf", [f"{program} did not print: {told[0]}"])
        shutil.copyfile(printed, path)


def _by_weasyprint(page: Path, path: Path) -> None:
    from weasyprint import HTML

    HTML(filename=str(page)).write_pdf(str(path))
