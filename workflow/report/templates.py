"""The templates of the pages that this room writes."""

from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape


def templates() -> Environment:
    """The templates; what stands in the place of a value is escaped, and a value that is missing is an error."""
    return Environment(
        loader=PackageLoader("workflow.report", "."),
        autoescape=select_autoescape(default_for_string=True, default=True),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
