"""Compiled functions kept on disk: where, what damage does, and what must not be found there.

Every run is a new process of a small program with a function that calls another.
"""

import os
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from numba import config

from sebody.compiler import store
from sebody.compiler.choice import way

PROGRAM = '''
import sys
from sebody.compiler.decorators import compiled

@compiled
def double(x):
    return 2 * x

@compiled
def with_one(x):
    return double(x) + 1

number = {"int": int, "float": float}[sys.argv[1]](3)
print(with_one(number), sum(with_one.stats.cache_hits.values()))
'''


@pytest.fixture
def program(tmp_path) -> Path:
    """The program, alone in a folder."""
    path = tmp_path / "code" / "program.py"
    path.parent.mkdir()
    path.write_text(PROGRAM)
    return path


@pytest.fixture
def without_named(tmp_path, monkeypatch):
    """No folder is named, and the user's cache is a folder of the test."""
    monkeypatch.setattr(config, "CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "users"))


def start(program: Path, number: str = "int", home: Path | None = None, cache: str = ""):
    """A process with a home of its own, and a folder for Numba if given."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache, "PYTHONDONTWRITEBYTECODE": "1",
                   "HOME": str(home or program.parents[1] / "home")}
    environment.pop("XDG_CACHE_HOME", None)
    return subprocess.Popen([sys.executable, program, number], env=environment, text=True,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def run(*arguments, **options) -> tuple[str, str]:
    """What a process prints: result and hits, then warnings."""
    process = start(*arguments, **options)
    out, errors = process.communicate(timeout=100)
    assert process.returncode == 0, errors
    return out.strip(), errors


def kept(folder: Path) -> list[str]:
    """Files about the program in a folder, without the version of Python and the processor."""
    tag = re.escape(sys.implementation.cache_tag)
    return sorted(re.sub(rf"\.{tag}\.[0-9a-f]{{8}}\.", ".", path.name)
                  for path in folder.rglob("program.*") if path.is_file())


def not_writable(path: Path) -> Path:
    """A file where a folder should be: even root cannot write below it."""
    path.write_text("")
    return path


FILES = ["program.double.callee.sebody", "program.sources", "program.with_one.sebody"]


def test_beside_the_source(program):
    assert run(program) == ("7 0", "")
    assert kept(program.parent / "__pycache__") == FILES
    assert run(program) == ("7 1", "")
    assert run(program, "float") == ("7.0 0", "")       # the other signature is added
    assert run(program, "float") == ("7.0 1", "")
    assert run(program) == ("7 1", "")


def test_a_folder_that_is_named_is_the_only_one(program, tmp_path):
    """Neither what is beside the source nor what the user's cache holds is read or written."""
    home, beside = tmp_path / "home", program.parent / "__pycache__"
    run(program)
    beside.rename(tmp_path / "moved")
    not_writable(beside)
    assert run(program, home=home) == ("7 0", "")        # kept in the user's cache
    beside.unlink()
    (tmp_path / "moved").rename(beside)
    before = {path: path.stat().st_mtime_ns for folder in (beside, home)
              for path in folder.rglob("*")}
    assert run(program, home=home, cache=str(tmp_path / "mine")) == ("7 0", "")
    assert kept(tmp_path / "mine") == FILES
    assert run(program, home=home, cache=str(tmp_path / "mine")) == ("7 1", "")
    assert run(program, "float", home=home, cache=str(tmp_path / "mine")) == ("7.0 0", "")
    assert {path: path.stat().st_mtime_ns for folder in (beside, home)
            for path in folder.rglob("*")} == before


def test_a_named_folder_may_be_relative(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert run(program, cache="mine") == ("7 0", "")
    assert kept(tmp_path / "mine") == FILES
    assert run(program, cache="mine") == ("7 1", "")


def test_a_named_folder_that_cannot_be_written_is_said(program, tmp_path):
    run(program)
    named = not_writable(tmp_path / "file") / "cache"
    out, errors = run(program, cache=str(named))
    assert out == "7 0"
    assert errors.count("compiled code cannot be stored, so every start compiles it again") == 1
    assert f"cannot be written; set NUMBA_CACHE_DIR, now {named}, to a folder that can" in errors


def test_the_users_cache_where_the_source_is_not_writable(program, tmp_path):
    not_writable(program.parent / "__pycache__")
    assert run(program) == ("7 0", "")
    assert kept(tmp_path / "home") == FILES
    assert run(program) == ("7 1", "")


def test_an_image_serves_users_who_can_write_nowhere(program, tmp_path):
    """Compiled once beside the source; then used without a place of one's own."""
    run(program)
    nobody = {"home": not_writable(tmp_path / "nobody")}
    before = {path: path.stat().st_mtime_ns for path in program.parent.rglob("*")}
    assert run(program, **nobody) == ("7 1", "")
    assert {path: path.stat().st_mtime_ns for path in program.parent.rglob("*")} == before


def test_what_an_image_lacks_goes_to_the_users_cache(without_named, tmp_path, monkeypatch):
    source = tmp_path / "code" / "module.py"
    assert store.write(source, "name", "hash", b"of the image")
    written = store._written
    monkeypatch.setattr(store, "_written", lambda folder, *rest: folder.name != "__pycache__"
                        and written(folder, *rest))
    assert store.write(source, "name", "hash", b"of the user")
    assert list(store.read(source, "name", "hash")) == [b"of the image", b"of the user"]
    assert store.holds(source, "name", "hash")


def test_without_any_folder_it_runs_and_says_so_once(program, tmp_path):
    beside = not_writable(program.parent / "__pycache__")
    out, errors = run(program, home=not_writable(tmp_path / "home"))
    assert out == "7 0"
    assert errors.count("compiled code cannot be stored") == 1
    assert f"again: {beside} and {tmp_path / 'home'}" in errors
    assert "cannot be written; set NUMBA_CACHE_DIR to a folder that can be written" in errors


DAMAGES = {"empty": lambda data: b"", "truncated": lambda data: data[:len(data) // 2],
           "garbage": lambda data: data[:9] + b"garbage" + data[16:]}


@pytest.mark.parametrize("name, damage", list(zip(FILES, DAMAGES.values(), strict=True)))
def test_a_damaged_file_counts_as_absent(program, name, damage):
    run(program)
    path, = (program.parent / "__pycache__").glob(name.replace(".sebody", ".*.sebody"))
    path.write_bytes(damage(path.read_bytes()))
    out, errors = run(program, "float")
    assert out == "7.0 0"
    assert errors.count(f"{path} is damaged and not used") == 1
    assert run(program, "float") == ("7.0 1", "")       # written anew


def test_what_was_compiled_for_another_processor_is_kept_apart(program, monkeypatch):
    monkeypatch.delenv("NUMBA_CPU_NAME", raising=False)
    run(program)
    monkeypatch.setenv("NUMBA_CPU_NAME", "generic")
    assert run(program) == ("7 0", "")
    assert run(program) == ("7 1", "")
    monkeypatch.delenv("NUMBA_CPU_NAME")
    assert run(program) == ("7 1", "")


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_damage_is_said_once_with_the_name_of_the_file(tmp_path, monkeypatch, damage):
    monkeypatch.setattr(config, "CACHE_DIR", str(tmp_path))
    source = tmp_path / "code" / "module.py"
    assert store.write(source, "name", "hash", b"content of a file")
    path, = tmp_path.rglob("name")
    path.write_bytes(damage(path.read_bytes()))
    with pytest.warns(RuntimeWarning, match=f"{path} is damaged and not used: it is rewritten"):
        assert not list(store.read(source, "name", "hash"))
    with warnings.catch_warnings(action="error"):
        assert not list(store.read(source, "name", "hash"))
    assert store.write(source, "name", "hash", b"content of a file")
    assert list(store.read(source, "name", "hash")) == [b"content of a file"]


def test_two_cold_processes_share_a_folder(program):
    """With the same signature and with another; neither reads half of a file of the other."""
    processes = [start(program, number) for number in ("int", "int", "float", "float")]
    outputs = [process.communicate(timeout=100) for process in processes]
    assert [out.split()[0] for out, _ in outputs] == ["7", "7", "7.0", "7.0"]
    assert [errors for _, errors in outputs] == [""] * 4
    assert kept(program.parent / "__pycache__") == FILES
    assert "7.0 1" in [run(program, "float")[0] for _ in range(2)]


def test_an_edited_function_is_compiled_again_a_comment_is_not(program):
    run(program)
    program.write_text('"""A title."""\n# a remark\n' + PROGRAM)
    assert run(program) == ("7 1", "")
    program.write_text(PROGRAM.replace("2 * x", "4 * x"))
    assert run(program) == ("13 0", "")


def test_files_made_from_something_else_are_passed_over(without_named, tmp_path):
    source = tmp_path / "code" / "module.py"
    beside, users = store.folders(source)
    store.write(source, "name", "old", b"1")
    users.mkdir(parents=True)
    (beside / "name").rename(users / "name")
    store.write(source, "name", "new", b"2")
    assert list(store.read(source, "name", "old")) == [b"1"]
    assert list(store.read(source, "name", "new")) == [b"2"]


OPERATORS = """
import operator
from sebody.compiler.decorators import compiled
from sebody.compiler.inside.names import cpu_target

@compiled
def turned(x):
    return -x

turned(2.0)
context = cpu_target.typing_context
found = context.resolve_value_type(operator.neg)
import sebody.compiler.inside.lanes     # as where kept code has signatures of lanes
context.refresh()
print(context.resolve_value_type(operator.neg) is found)
"""


def test_operators_of_lanes_are_known_before_anything_is_compiled(program):
    """Kept code imports them: while a function is compiled, its operators would become others."""
    if way().__name__.endswith("plain"):
        pytest.skip("the plain way has no lanes")
    program.write_text(OPERATORS)
    assert run(program)[0] == "True"
