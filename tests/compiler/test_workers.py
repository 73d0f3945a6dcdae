"""Tasks in other processes: their order, and failures."""

import subprocess

from sebody.compiler import workers
from sebody.compiler.workers import Queue, Task, call_all


def test_tasks_come_as_soon_as_those_before_them_are_done():
    tasks = [Task("whole", "m:f", after=("left", "right", "elsewhere")), Task("left", "m:f"),
             Task("right", "m:f"), Task("other", "m:f")]
    queue = Queue(tasks)
    taken = [queue.take() for _ in range(2)]
    assert [task.name for task in taken] == ["left", "right"]
    queue.done(taken[1])
    assert queue.take().name == "other"
    queue.done(taken[0])
    assert queue.take().name == "whole"
    assert queue.take() is None


def test_a_task_that_fails_stops_no_other(tmp_path):
    done = []
    call_all([Task("wrong", "os:no_such_function"), Task("ends the process", "os:_exit", (1,)),
              Task("folder", "os:mkdir", (str(tmp_path / "made"),),
                   after=("wrong", "ends the process"))],
             lambda name, seconds: done.append(name))
    assert done == ["folder"]
    assert (tmp_path / "made").is_dir()


def test_processes_that_cannot_be_started(monkeypatch):
    def refuse(*arguments, **options):
        raise OSError("no more processes")
    monkeypatch.setattr(subprocess, "Popen", refuse)
    done = []
    call_all([Task("one", "os:getpid"), Task("other", "os:getpid", after=("one",))],
             lambda name, seconds: done.append(name))
    assert done == []


def test_there_are_two_processes_at_least():
    assert workers.PROCESSES >= 2
