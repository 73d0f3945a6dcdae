"""Which way is taken to compile: where Numba lacks something or is new, and where it is asked."""

import os
import subprocess
import sys

import pytest

from sebody.compiler.choice import VARIABLE

PROGRAM = """
import os, subprocess, sys
from numba.core import codegen, compiler_machinery, lowering
from sebody.compiler import choice
{before}
way = choice.way().__name__.rpartition(".")[2]
print(way, choice.way().__name__.rpartition(".")[2], os.environ.get("SEBODY_PLAIN", ""))
"""
NEW = "choice.TESTED = (0, 1), (0, 2)\n"        # every version is one that was not tested
LINE = "sebody compiles with the public interface of Numba "


@pytest.fixture
def choose(tmp_path):
    """The way that a process takes after some statements, and what it says."""
    def run(before: str = "", plain: str = "") -> tuple[str, str]:
        done = subprocess.run([sys.executable, "-c", PROGRAM.format(before=before)], text=True,
                              capture_output=True,
                              env={**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), VARIABLE: plain})
        assert done.returncode == 0, done.stderr
        return done.stdout.strip(), done.stderr
    return run


def test_the_fast_way_says_nothing(choose):
    assert choose() == ("entry entry", "")


def test_the_plain_way_where_it_is_asked_for_says_nothing(choose):
    assert choose(plain="1") == ("plain plain 1", "")
    assert choose("del lowering.Lower", plain="1") == ("plain plain 1", "")


@pytest.mark.parametrize("vanishes", [
    "lowering.Lower", "codegen.CPUCodeLibrary._optimize_final_module",
    "compiler_machinery.register_pass"])
def test_what_a_version_of_numba_lacks_is_said_in_one_line(choose, vanishes):
    found, said = choose(f"del {vanishes}")
    assert found == "plain plain 1"         # for processes that this one starts, too
    line, = said.splitlines()
    assert line.startswith(LINE) and line.count(vanishes.rpartition(".")[2]) == 1


def test_a_new_version_is_tried_once(choose):
    assert choose(NEW) == ("entry entry", "")
    assert choose(f"{NEW}choice.subprocess = None") == ("entry entry", "")


def test_a_new_version_that_fails_is_not_used(choose):
    """Something that only instances have, and that a version might call by another name."""
    trial = "choice.TRIAL = 'sebody.compiler.inside.no_such_module'\n"
    for before in (NEW + trial, f"{NEW}choice.subprocess = None"):
        found, said = choose(before)
        assert found == "plain plain 1"
        assert said.startswith(LINE) and "a trial of sebody's own compilation failed (" in said
        assert "no_such_module" in said and len(said.splitlines()) == 1


def test_other_values_are_refused():
    program = "from sebody.compiler.choice import way\nway()"
    done = subprocess.run([sys.executable, "-c", program],
                          env={**os.environ, VARIABLE: "yes"}, text=True, capture_output=True)
    assert done.returncode == 1
    assert done.stderr.strip().endswith(
        "InputError: the environment variable SEBODY_PLAIN is 'yes': set it to 1 to compile with "
        "Numba's public interface alone, or unset it")
