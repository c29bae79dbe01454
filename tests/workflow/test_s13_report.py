"""The printed report of the whole run of S-13: its pages, and the three numbers of its first page."""

import json
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.support import SECTIONS
from tests.support.browser import Page, executable, page
from tests.support.command_line import run

MOST_PAGES = 10
PAGE = re.compile(rb"/Type\s*/Page\b")

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(executable() is None, reason="there is no Chromium and it could not be installed"),
]


@pytest.fixture(scope="module")
def s13(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a whole run."""
    folder = tmp_path_factory.mktemp("s13") / "run"
    assert run("run", SECTIONS / "s13.toml", "--out", folder, "-q") == 0
    return folder


@pytest.fixture(scope="module")
def summary(s13: Path) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((s13 / "summary.json").read_text())
    return data


@pytest.fixture
def tab(s13: Path) -> Iterator[Page]:
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, page(Path(profile)) as opened:
        opened.open((s13 / "report.html").as_uri())
        yield opened


def test_it_prints_on_ten_pages(tab: Page) -> None:
    """All but the further figures, which are an appendix on the screen."""
    assert 5 <= len(PAGE.findall(tab.pdf())) <= MOST_PAGES
    hidden = tab.value("getComputedStyle(document.getElementById('further')).display")
    assert hidden == "block"  # on the screen
    tab.ask("Emulation.setEmulatedMedia", media="print")
    assert tab.value("document.getElementById('further').closest('.screen').offsetHeight") == 0


def test_the_first_page_is_one_page_and_has_three_numbers(tab: Page, summary: dict[str, Any]) -> None:
    """Those of summary.json: critical Kh, factor of safety, and slide by material points."""
    critical, factor, slide = tab.value("[...document.querySelectorAll('.answer b')].map(cell => cell.textContent)")
    assert [critical, factor, slide] == [item["value"] for item in summary["headlines"]]
    assert critical == f"{summary['fem']['kc_governing']:.3f}"
    (at_rest,) = [item for item in summary["fem"]["safety_factors"] if item["kh"] == 0.0]
    assert factor == f"{at_rest['governing']:.2f}"
    assert slide == f"{max(case['slide_max_m'] for case in summary['cases_mpm'].values()):.2f} m"
    tab.value("for (let part = document.querySelector('nav'); part;) "
              "{ const next = part.nextElementSibling; part.remove(); part = next }")  # fmt: skip
    assert len(PAGE.findall(tab.pdf())) == 1
