"""Files that appear whole or not at all."""

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

# What `whole` calls a file that is not whole yet: the number of the process that writes it, then its name.
BESIDE = re.compile(r"\.(\d+)-.+")


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A path beside one, to write to; what stands there at the end of the block becomes the file, at once.

    Its folder is made if need be. On any error what was there before stays, and nothing else is left behind. Raises
    OSError if the file cannot be written.
    """
    beside = path.with_name(f".{os.getpid()}-{path.name}")
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        yield beside
        beside.replace(path)
    finally:
        with suppress(OSError):
            beside.unlink()
