"""First runs: processes fill the cache, one line says so, and nothing that fails in them breaks it.

Every run is a new process with a cache of its own.
"""

import os
import re
import subprocess
import sys

import pytest

from sebody.compiler.first_run import longest_first
from sebody.kernels.loader import find
from sebody.runs import first_run

SPY = """
import sys
from numba.core import ccallback, event

compiled = []
class Spy(event.Listener):
    def on_start(self, event): compiled.append(event.data["dispatcher"].py_func.__name__)
    def on_end(self, event): pass
event.register("numba:compile", Spy())
uncached = ccallback.CFunc._compile_uncached
def spied(self):
    compiled.append(self._pyfunc.__module__.rpartition(".")[2])
    return uncached(self)
ccallback.CFunc._compile_uncached = spied
"""
# a script without a guard: processes that ran it again would print, too
SCENE = SPY + """
from sebody import Model, simulate
model = Model(planar=True)
node = model.node("weight", (1.0, 0.0))
model.rigid_body("weight", node, 2.0, 0.1)
model.spring(node, model.node("anchor", (0.0, 0.0)), 3.0)
model.fix("anchor")
model.force(node, (0.0, 1.0), [(0.0, 0.0), (1.0, 2.0)])
result = simulate(model, 0.01, 0.05)
again = simulate(model, 0.01, 0.05)
result.summary()
print(len(result.t), sorted(set(compiled)))
"""
# a kernel that takes half a second, and processes for it all the same
KERNEL = SPY + """
from sebody.runs.first_run import compile_missing
from sebody.compiler import first_run, workers
from sebody.kernels.loader import load
first_run.WORTH_IT = 0.0
if "broken" in sys.argv:
    workers.__name__ = "sebody.compiler.no_such_module"
for _ in range(2):
    compile_missing(["element_planar_force"])
print(load("element_planar_force").kernel.address > 0, "element_planar_force" in compiled)
"""
LINE = "compiling 1 kernel in "


@pytest.fixture
def run(tmp_path):
    """Run a program with arguments; what it prints, and what it says on standard error."""
    def start(text: str, *arguments: str, cache: str = str(tmp_path / "cache")) -> tuple[str, str]:
        program = tmp_path / "program.py"
        program.write_text(text)
        done = subprocess.run([sys.executable, program, *arguments], text=True,
                              capture_output=True, timeout=900,
                              env={**os.environ, "NUMBA_CACHE_DIR": cache})
        assert done.returncode == 0, done.stderr
        return done.stdout.strip(), done.stderr
    return start


def test_a_run_compiles_nothing_that_processes_have_compiled(run):
    out, said = run(SCENE)
    assert out == "6 []"
    first, last = said.splitlines()
    assert first.startswith("first run: compiling the time loop and 3 kernels in ")
    made = re.fullmatch(r"compiled (\d+) of (\d+) parts in \d+ s; "
                        "later runs find them in the cache", last)
    assert made and made[1] == made[2] and int(made[1]) > 3
    assert run(SCENE) == ("6 []", "")


def test_processes_that_fail_leave_it_to_the_run(run):
    out, said = run(KERNEL, "broken")
    assert out == "True True"
    assert said.count(LINE) == 1
    out, said = run(KERNEL, "broken")
    assert out == "True False" and not said


def test_kernels_alone(run):
    out, said = run(KERNEL)
    assert out == "True False"
    assert said.count(LINE) == 1
    assert run(KERNEL) == ("True False", "")


def test_without_a_folder_to_write_to_nothing_is_compiled_twice(run, tmp_path):
    """No process compiles what could not be handed on; the run does, and says that it will."""
    text = KERNEL.replace("first_run.WORTH_IT = 0.0",
                          "first_run.WORTH_IT = 0.0\nworkers.call_all = None")
    named = tmp_path / "file" / "below"
    named.parent.write_text("")
    out, said = run(text, cache=str(named))
    assert out == "True True"
    assert said.count(" at every start: ") == 1
    assert f"cannot be written; set NUMBA_CACHE_DIR, now {named}, to a folder that" in said


def test_small_tasks_are_not_worth_processes(run):
    out, said = run(KERNEL.replace("first_run.WORTH_IT = 0.0", ""))
    assert out == "True True" and not said


def test_what_others_wait_for_begins_first():
    """A long kernel goes beside the parts of the loop; the loop begins before what is short."""
    kernels = {name: find(name) for name in ("element_force",
                                             "superelement_f2_converged_mean_floating_field")}
    names = [task.name for task in longest_first(first_run._jobs(kernels, list(first_run.PARTS)))]
    assert sorted(names) == sorted([*kernels, *first_run.PARTS])
    for name, part in first_run.PARTS.items():
        assert all(names.index(before) < names.index(name) for before in part.after)
    assert names[0] == "superelement_f2_converged_mean_floating_field"
    assert names.index("loop") < min(map(names.index, ("records", "energies", "element_force")))
