"""Writes lengths as all pages, pictures and the console do: a slide that appears twice has the same digits."""


def metres(value: float | None) -> str:
    """Return a length in words: to the centimetre below a metre, in two digits or so above.

    Parameters
    ----------
    value : length (m); None without one

    Returns
    -------
    The length with its unit; a dash without a length.
    """
    if value is None:
        return "–"
    size = abs(value)
    if size < 0.005:
        return "0 m"
    return f"{value:.{2 if size < 1.0 else 1 if size < 10.0 else 0}f} m"
