"""Reports problems of a file of borings; similar problems are reported once."""

import re
from collections.abc import Sequence

MOST_UNREAD = 0.5  # share of the blow counts of a file that may be left out
MOST_ALIKE = 3  # complaints that differ in places and values alone and are reported one by one
VALUES = re.compile(r"'[^']*'|\"[^\"]*\"|[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
PLACE = re.compile(r"boring \S+?(?=[,:])")


def unread_counts(unread: Sequence[str], read: int) -> tuple[list[str], list[str]]:
    """Return notices on blow counts that are left out, and problems if they are more than half of the counts of a file.

    Parameters
    ----------
    unread : a sentence, with place and value, for each blow count that cannot be read
    read : number of blow counts that could be read
    """
    if len(unread) > MOST_UNREAD * (len(unread) + read):
        return [], folded([f"{text}; {len(unread)} of {len(unread) + read} blow counts cannot be read"
                           for text in unread])  # fmt: skip
    return folded([f"{text}; this blow count is left out" for text in unread]), []


def folded(problems: Sequence[str]) -> list[str]:
    """Return the problems. Of more than three problems that differ only in places and values, return only the first one
    with their number."""
    alike: dict[str, list[str]] = {}
    for text in dict.fromkeys(problems):
        alike.setdefault(VALUES.sub("·", PLACE.sub("boring ·", text)), []).append(text)
    messages = []
    for same in alike.values():
        if len(same) <= MOST_ALIKE:
            messages += same
        else:
            places = [re.split(r" = |: | is missing", text, maxsplit=1)[0] for text in same[1:MOST_ALIKE]]
            messages.append(f"{same[0]} (and {len(same) - 1} more alike: {'; '.join(places)}; ...)")
    return messages
