"""Writes lengths as all pages, pictures and the console do: a slide that appears twice has the same digits."""


def metres(value: float | None) -> str:
    """Return a length (m) in two digits or so, to the centimetre below a metre, or a dash."""
    if value is None:
        return "–"
    size = abs(value)
    if size < 0.005:
        return "0 m"
    return f"{value:.{2 if size < 1.0 else 1 if size < 10.0 else 0}f} m"
