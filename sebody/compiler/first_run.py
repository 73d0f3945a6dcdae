"""Compilation of what a run needs and the cache lacks, before it, side by side in processes."""

import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from threading import Lock
from typing import NamedTuple

from sebody.basics.progress import Progress
from sebody.compiler import store, workers
from sebody.compiler.choice import way
from sebody.compiler.workers import Task

WORTH_IT = 4.0                  # seconds of compiling: starting processes takes one or two
LOOPS, USUAL = 200_000, 0.0105   # of Python, and their seconds where those of jobs were measured


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
    seconds *= _slower() / workers.PROCESSES
    print(f"first run: compiling {what} in {workers.PROCESSES} processes, about {seconds:.0f} s",
          file=sys.stderr, flush=True)
    began, bar = time.perf_counter(), Progress()
    done: list[str] = []
    one_at_a_time = Lock()      # each process has a thread that reports

    def count(name: str, took: float) -> None:
        with one_at_a_time:
            done.append(name)
            bar(len(done) / len(jobs))
        if report:
            report(name, took)

    workers.call_all(longest_first(jobs), count)
    bar.close()
    print(f"compiled {len(done)} of {len(jobs)} parts in {time.perf_counter() - began:.0f} s; "
          "later runs find them in the cache", file=sys.stderr, flush=True)


def _slower() -> float:
    """Seconds of this machine, as busy as it is, over those of the one of `USUAL`."""
    began, total = time.perf_counter(), 0
    for k in range(LOOPS):
        total += k % 7
    return (time.perf_counter() - began) / USUAL


def longest_first(jobs: Sequence[Job]) -> list[Task]:
    """Tasks by the seconds from the beginning of each to the end of what waits for it."""
    def left(job: Job) -> float:
        return job.seconds + max((left(other) for other in jobs
                                  if job.task.name in other.task.after), default=0.0)
    return [job.task for job in sorted(jobs, key=left, reverse=True)]
