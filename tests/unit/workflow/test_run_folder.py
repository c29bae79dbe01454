"""The folder of a run: one run at a time, the log, the clock and the record; on stages that take no time."""

import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from meshes.errors import InputError
from tests.support.command_line import TOP
from tests.support.toy_stages import ALL_OF_THEM, Toys
from workflow.run.lock import locked
from workflow.run.progress import duration

HOLDER = """
import sys, time
from pathlib import Path
from workflow.run.lock import locked
with locked(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(3600)
"""


def test_two_runs_do_not_share_a_folder_and_a_dead_one_holds_nothing(toys: Toys, tmp_path: Path) -> None:
    holder = subprocess.Popen([sys.executable, "-c", HOLDER, str(tmp_path)], stdout=subprocess.PIPE, text=True, cwd=TOP)
    try:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(InputError, match=rf"is in use by another run \(process {holder.pid} on "):
            toys.go(tmp_path)
        assert not (tmp_path / "mesh.txt").exists()
        holder.send_signal(signal.SIGKILL)
        holder.wait()
        assert toys.go(tmp_path).ran == ALL_OF_THEM
    finally:
        holder.kill()
        holder.wait()


def test_children_do_not_keep_the_lock(tmp_path: Path) -> None:
    """The workers of a run that was killed live on for a while."""
    fork = HOLDER.replace('print("held"', 'import os\n    if os.fork() == 0: time.sleep(3600)\n    print("held"')
    holder = subprocess.Popen([sys.executable, "-c", fork, str(tmp_path)], stdout=subprocess.PIPE, text=True, cwd=TOP,
                              start_new_session=True)  # fmt: skip
    try:
        assert holder.stdout is not None
        holder.stdout.readline()
        os.kill(holder.pid, signal.SIGKILL)
        holder.wait()
        with locked(tmp_path):
            pass
    finally:
        os.killpg(holder.pid, signal.SIGKILL)


def test_the_log_says_what_ran_with_what_and_for_how_long(toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    toys.go(tmp_path)
    text = (tmp_path / "log.txt").read_text()
    for words in (
        "--- test",
        "host: ",
        "versions: python 3.",
        "noshiro 0.1.0",
        "numpy ",
        "mesh: begins (not run)",
    ):
        assert words in text
    assert text.count("fem: done after") == 1
    assert len(re.findall(r"fem: result of .* reused", text)) == 1


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.44, "0.4 s"), (9.96, "10 s"), (59.4, "59 s"), (60, "1 min 0 s"), (7500, "2 h 5 min")]
)
def test_durations(seconds: float, words: str) -> None:
    assert duration(seconds) == words


def test_the_record_is_small_and_whole(toys: Toys, tmp_path: Path) -> None:
    toys.go(tmp_path)
    data = json.loads((tmp_path / ".noshiro/stages.json").read_text())
    assert set(data["stages"]) == set(ALL_OF_THEM)
    assert data["stages"]["fem"]["files"] == {"fem.txt": 6}
    assert time.strptime(data["stages"]["fem"]["ended"], "%Y-%m-%d %H:%M:%S")
