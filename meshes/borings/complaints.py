"""What is wrong with a file of borings, with complaints of one kind told once."""

import re
from collections.abc import Sequence

MOST_ALIKE = 3  # complaints that differ in places and values alone and are told one by one
VALUES = re.compile(r"'[^']*'|\"[^\"]*\"|[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
PLACE = re.compile(r"boring \S+?(?=[,:])")


def folded(problems: Sequence[str]) -> list[str]:
    """The problems, of more than three that differ in places and values alone the first one with their number."""
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
