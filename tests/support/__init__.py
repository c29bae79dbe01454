"""Provides what several tests share: places, sections, grounds and discs with known answers, the command line, a
browser."""

from pathlib import Path

TOP = Path(__file__).parents[2]
SECTIONS = TOP / "meshes" / "sections"
RIVER_BANK = SECTIONS / "river_bank.toml"
