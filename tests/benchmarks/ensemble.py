"""What a task costs beyond what it computes: python -m tests.benchmarks.ensemble."""

import tempfile
import time
from pathlib import Path

from tests.support.tasks import Numbers, total
from workflow.study.ensemble import Ensemble
from workflow.study.task import Task

COUNT, WORKERS = 300, 2


def main() -> None:
    """Prints the seconds of a task on top of the import of the workers."""
    with tempfile.TemporaryDirectory() as folder:
        start = time.perf_counter()
        Ensemble(Path(folder), WORKERS).rows([Task(total, Numbers(values=(0.5,)))])
        alone = time.perf_counter() - start
        start = time.perf_counter()
        Ensemble(Path(folder), WORKERS).rows([Task(total, Numbers(values=(0.1 * k, 3.0))) for k in range(COUNT)])
        each = (time.perf_counter() - start - alone) / COUNT
    print(f"workers and one task {alone:.2f} s; each further task {1e3 * each:.1f} ms (asked for: 20 ms)")


if __name__ == "__main__":
    main()
