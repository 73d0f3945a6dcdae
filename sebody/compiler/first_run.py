"""What a run needs and the cache lacks is compiled before it, side by side in several processes."""

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from sebody.compiler import store, workers
from sebody.compiler.choice import way
from sebody.compiler.workers import Task

WORTH_IT = 4.0                  # seconds of compiling: starting processes takes one or two


class Job(NamedTuple):
    """Something to compile, and the seconds it takes the fast way, of one processor."""

    task: Task
    seconds: float


def compile_apart(jobs: Sequence[Job], what: str, source: Path,
                  report: Callable[[str, float], None] | None = None) -> None:
    """Compile in several processes, if that is worth it; lines on standard error say so.

    Parameters
    ----------
    what : str
        What is compiled, in the lines.
    source : Path
        A module that something is compiled of: where that cannot be kept no process is started.
    report : callable, optional
        Called with the name of everything that was compiled and the seconds it took.
    """
    seconds = way().SLOWER * sum(job.seconds for job in jobs)
    if not jobs or seconds < WORTH_IT:
        return
    if not store.writable_folder(source):
        print(f"compiling {what}, about {seconds:.0f} s, at every start: "
              f"{store.not_writable(source)}", file=sys.stderr, flush=True)
        return
    seconds /= workers.PROCESSES
    print(f"first run: compiling {what} in {workers.PROCESSES} processes, about {seconds:.0f} s",
          file=sys.stderr, flush=True)
    began = time.perf_counter()
    workers.call_all(longest_first(jobs), report)
    print(f"compiled in {time.perf_counter() - began:.0f} s; later runs find it in the cache",
          file=sys.stderr, flush=True)


def longest_first(jobs: Sequence[Job]) -> list[Task]:
    """Tasks by the seconds from the beginning of each to the end of what waits for it."""
    def left(job: Job) -> float:
        return job.seconds + max((left(other) for other in jobs
                                  if job.task.name in other.task.after), default=0.0)
    return [job.task for job in sorted(jobs, key=left, reverse=True)]
