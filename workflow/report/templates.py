"""Loads the templates of the pages of reports."""

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape


def templates() -> Environment:
    """Return the templates; inserted values are escaped, and a missing value is an error."""
    return Environment(
        loader=PackageLoader("workflow.report", "."),
        autoescape=select_autoescape(default_for_string=True, default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
