"""The whole input as data: a section, and one settings object for each table; old words, and the analysed config."""

from workflow.config.config import FILES, K_MAX, Config, merged, notice_lines
