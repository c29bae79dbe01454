"""Symbols with their subscripts, in pictures and in captions."""

from workflow.figures.symbols import in_captions, in_mathtext


def test_symbols_of_pictures_are_mathtext_and_dollars_stay() -> None:
    assert in_mathtext("critical Kh = 0.24, $5") == r"critical $k_{\mathrm{h}}$ = 0.24, \$5"
    assert in_mathtext("resistance kc g; fem.kh, Khan") == r"resistance $k_{\mathrm{c}}$ g; fem.kh, Khan"


def test_symbols_of_captions_and_heads_have_subscripts_and_text_and_attributes_none() -> None:
    html = '<p>Kh</p><figcaption id="Kh">F_L over Kh</figcaption><th class="n">限界Kh</th>'
    assert in_captions(html) == (
        '<p>Kh</p><figcaption id="Kh"><i>F</i><sub>L</sub> over <i>k</i><sub>h</sub></figcaption>'
        '<th class="n">限界<i>k</i><sub>h</sub></th>'
    )
