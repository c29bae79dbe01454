"""Prints the page to report.pdf by Chromium if there is one, else by WeasyPrint."""

import os
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path

from meshes.errors import InputError
from workflow.run.store import Store

FILE, PAGE = "report.pdf", "report.html"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
PRINT_TIMEOUT = 180.0  # s for a page to print
NEEDED = (
    "needs Chromium or WeasyPrint, and neither is there: on Debian and Ubuntu apt install chromium, or anywhere pip "
    "install 'noshiro[pdf]'; any browser prints report.html, too"
)


def browser() -> str | None:
    """Return a browser on this machine that can print; None without one."""
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


def write_pdf(store: Store) -> Path:
    """Print report.html of a folder to report.pdf.

    Parameters
    ----------
    store : folder of a run with a report

    Returns
    -------
    Path of report.pdf.

    Raises
    ------
    InputError : There is neither Chromium nor WeasyPrint, or the program fails.
    """
    page = store.folder / PAGE
    program = browser()
    if program is None and find_spec("weasyprint") is None:
        raise InputError("--pdf", [NEEDED])
    with (
        store.writing(FILE) as path,
        tempfile.TemporaryDirectory(prefix="noshiro-", ignore_cleanup_errors=True) as scratch,
    ):
        printed = Path(scratch) / "printed.pdf"
        if program is not None:
            _print(program, _by_browser(program, page, scratch, printed), printed)
        else:
            # A process of its own: its text libraries may crash, and would take the run with them.
            _print("WeasyPrint", [sys.executable, "-m", "weasyprint", str(page), str(printed)], printed)
        shutil.copyfile(printed, path)
    return store.folder / FILE


def _by_browser(program: str, page: Path, profile: str, printed: Path) -> list[str]:
    """Return the command with which a browser prints, without a screen and with a temporary profile."""
    line = [
        program, "--headless=new", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
        "--disable-background-networking", "--disable-component-update", f"--user-data-dir={profile}",
        "--no-pdf-header-footer", f"--print-to-pdf={printed}", page.resolve().as_uri(),
    ]  # fmt: skip
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        line.insert(1, "--no-sandbox")  # Chromium has none for root
    return line


def _print(name: str, line: list[str], printed: Path) -> None:
    """Run the command that prints; raises InputError if it prints nothing."""
    try:
        done = subprocess.run(line, capture_output=True, text=True, timeout=PRINT_TIMEOUT, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise InputError("--pdf", [f"{name} could not print the report: {error}"]) from None
    if done.returncode < 0 or not printed.is_file():
        messages = done.stderr.strip().splitlines()[-1:] or [f"exit code {done.returncode}"]
        raise InputError("--pdf", [f"{name} could not print the report: {messages[0]}"])
