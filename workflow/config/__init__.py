"""Holds the whole input as data: a section, one settings object for each table, old names of settings, and the config
after analyses."""

from workflow.config.config import FILES, K_MAX, Config, merged, notice_lines
