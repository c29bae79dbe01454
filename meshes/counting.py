"""Counts in words."""


def counted(count: int, one: str, several: str) -> str:
    """A count with its noun and, where the verb follows, the verb: "1 disc overlaps", "2 discs overlap".

    Parameters
    ----------
    count : how many there are
    one, several : the words behind 1, and behind every other count
    """
    return f"{count} {one if count == 1 else several}"
