"""Writes counts in words."""


def counted(count: int, singular: str, plural: str) -> str:
    """Return a count with its noun and, if a verb follows, the verb: "1 disc overlaps", "2 discs overlap".

    Parameters
    ----------
    count : the count
    singular, plural : the words that follow 1, and that follow every other count
    """
    return f"{count} {singular if count == 1 else plural}"
