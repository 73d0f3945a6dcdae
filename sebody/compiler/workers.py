"""Functions called in other processes, several at a time: how much is compiled at once.

The processes are plain ``python -m sebody.compiler.workers``, not `multiprocessing`: that would run
the script of a user again, unless it is guarded. What they compile is found in the cache.
"""

import gc
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from threading import Condition, Thread
from typing import NamedTuple

PROCESSES = max(2, os.cpu_count() or 2)
DONE = "done"


class Task(NamedTuple):
    """A function to call in another process."""

    name: str
    function: str                       # as in "package.module:function"
    arguments: tuple[str, ...] = ()
    after: tuple[str, ...] = ()         # names of tasks that are done first


class Queue:
    """Tasks that are left, for several threads.

    Parameters
    ----------
    tasks : sequence of Task
        In the order in which they are begun, as soon as those they come after are done.
    """

    def __init__(self, tasks: Sequence[Task]):
        names = {task.name for task in tasks}
        self._left = [task._replace(after=tuple(names.intersection(task.after)))
                      for task in tasks]
        self._done: set[str] = set()
        self._changed = Condition()

    def take(self) -> Task | None:
        """The next task; None when there is none left."""
        with self._changed:
            while self._left:
                for task in self._left:
                    if self._done.issuperset(task.after):
                        self._left.remove(task)
                        return task
                self._changed.wait()
            return None

    def done(self, task: Task) -> None:
        """Let those begin that come after a task, whether it was of use or not."""
        with self._changed:
            self._done.add(task.name)
            self._changed.notify_all()


def call_all(tasks: Sequence[Task], report: Callable[[str, float], None] | None = None,
             variables: Mapping[str, str] | None = None) -> None:
    """Call functions in as many processes as there are processors, two at least.

    A task that fails is left to whoever needs what it makes.

    Parameters
    ----------
    report : callable, optional
        Called with the name of every task that went well and the seconds it took.
    variables : mapping, optional
        Environment variables of the processes, beside those of this one.
    """
    queue, processes = Queue(tasks), []

    def work() -> None:
        process = None
        while (task := queue.take()) is not None:
            began = time.perf_counter()
            try:
                if process is None:
                    process = _start(variables or {})
                    processes.append(process)
                answer = _ask(process, task)
                if answer == DONE and report:
                    report(task.name, time.perf_counter() - began)
                if not answer:
                    process = None      # it has ended, the next task gets a new one
            except OSError:
                process = None
            finally:
                queue.done(task)

    threads = [Thread(target=work, daemon=True) for _ in range(min(PROCESSES, len(tasks)))]
    try:
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
    finally:
        for process in processes:
            process.kill()
            process.communicate()


def _start(variables: Mapping[str, str]) -> subprocess.Popen:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
                   **variables}
    return subprocess.Popen([sys.executable, "-m", __name__], env=environment, text=True,
                            stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            stderr=subprocess.DEVNULL)


def _ask(process: subprocess.Popen, task: Task) -> str:
    """The answer of a process to a task; nothing if it has ended."""
    process.stdin.write(json.dumps((task.function, task.arguments)) + "\n")
    process.stdin.flush()
    return process.stdout.readline().strip()


def main() -> None:
    """Call what is asked for on standard input, line by line."""
    answers, sys.stdout = sys.stdout, sys.stderr        # whatever is printed is no answer
    gc.disable()        # it takes a part of a compilation and frees nothing there
    for line in sys.stdin:
        function, arguments = json.loads(line)
        try:
            module, _, name = function.partition(":")
            getattr(import_module(module), name)(*arguments)
            answer = DONE
        except Exception as error:      # whoever needs what it makes will meet and report it
            answer = f"failed: {type(error).__name__}"
        print(answer, file=answers, flush=True)


if __name__ == "__main__":
    main()
