"""The editable install: found from anywhere, also beside a clone."""

import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest

from sebody.io import SOURCES

ROOT = Path(__file__).parents[1]
FOLDERS = ("sebody", "derive", "generated", "examples")
FILES = ("pyproject.toml", "README.md", "LICENSE", ".build")
SCRIPT = """
import site, sys
libraries, editable = sys.argv[1:]
site.addsitedir(editable)
site.addsitedir(editable)       # which must not do anything more
sys.path.append(libraries)      # of what sebody needs; an installation there is not looked at
import sebody.derive, sebody.scenes
from sebody import Model
print(sebody.__file__)
print(sys.meta_path[0].__module__)
"""


@pytest.fixture(scope="module")
def beside_a_clone(tmp_path_factory):
    """A folder with a clone named sebody in it, and the contents of its editable wheel."""
    folder = tmp_path_factory.mktemp("projects")
    clone = folder / "sebody"
    clone.mkdir()
    for name in (*FOLDERS, *FILES):
        (clone / name).symlink_to(ROOT / name)
    build = ("import sys; sys.path.insert(0, '.build'); import backend; "
             "print(backend.build_editable(sys.argv[1]))")
    done = subprocess.run([sys.executable, "-c", build, str(folder)], cwd=clone, text=True,
                          capture_output=True, check=True)
    with zipfile.ZipFile(folder / done.stdout.split()[-1]) as wheel:
        wheel.extractall(folder / "site")
    return folder


def test_a_script_beside_a_clone_imports_the_package(beside_a_clone):
    script = beside_a_clone / "script.py"
    script.write_text(SCRIPT)
    libraries = Path(np.__file__).parents[1]
    done = subprocess.run(
        [sys.executable, "-S", str(script), str(libraries), str(beside_a_clone / "site")],
        cwd=beside_a_clone, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    file, first = done.stdout.splitlines()
    assert Path(file).samefile(ROOT / "sebody" / "__init__.py")
    assert first.startswith("__editable__")


def test_record_lists_what_the_wheel_holds(beside_a_clone):
    """pip refuses nothing here, but removes only what is recorded."""
    site = beside_a_clone / "site"
    record, = site.glob("*.dist-info/RECORD")
    listed = {line.split(",")[0]: line.split(",")[1:] for line in record.read_text().split()}
    assert set(listed) == {str(p.relative_to(site)) for p in site.rglob("*") if p.is_file() and
                           p.suffix != ".pyc"}     # of imports by other tests
    for name, (digest, size) in listed.items():
        if digest:
            assert int(size) == (site / name).stat().st_size


def test_the_wheel_holds_every_module_and_files_that_are_none(tmp_path):
    """Templates, styles and scripts of pages; the file that tells type checkers to look."""
    clone = tmp_path / "clone"
    clone.mkdir()
    for name in (*FOLDERS, *FILES):
        (clone / name).symlink_to(ROOT / name)
    build = ("import sys; sys.path.insert(0, '.build'); import backend; "
             "print(backend.build_wheel(sys.argv[1]))")
    done = subprocess.run([sys.executable, "-c", build, str(tmp_path)], cwd=clone, text=True,
                          capture_output=True, check=True)
    with zipfile.ZipFile(tmp_path / done.stdout.split()[-1]) as wheel:
        held = set(wheel.namelist())
    files = {str(path.relative_to(ROOT)) for path in (ROOT / "sebody/pictures/page").iterdir()}
    assert len(files) >= 13 and files <= held
    packages = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    assert {name for name in held if name.endswith(".py")} == {
        "/".join([*package.split("."), *path.relative_to(ROOT / folder).parts])
        for package, folder in packages["package-dir"].items()
        for path in (ROOT / folder).rglob("*.py")}
    assert not [name for name in held if name.endswith((".md", ".png"))]
    assert any(name.endswith("-py3-none-any.whl") for name in done.stdout.split())
    assert "sebody/py.typed" in held


def test_the_sdist_holds_what_makes_the_wheel(tmp_path):
    """Without the build backend no index could serve it; pages and tests are for packagers."""
    clone = tmp_path / "clone"
    clone.mkdir()
    for name in (*FOLDERS, *FILES, ".docs", ".ci", ".github", "tests"):
        (clone / name).symlink_to(ROOT / name)
    build = ("import sys; sys.path.insert(0, '.build'); import backend; "
             "print(backend.build_sdist(sys.argv[1]))")
    done = subprocess.run([sys.executable, "-c", build, str(tmp_path)], cwd=clone, text=True,
                          capture_output=True, check=True)
    with tarfile.open(tmp_path / done.stdout.split()[-1]) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
        about = archive.extractfile(next(name for name in archive.getnames() if name.count(
            "/") == 1 and name.endswith("PKG-INFO"))).read().decode()
    assert {".build/backend.py", ".build/MANIFEST.in", "sebody/py.typed", "tests/pages.py",
            "sebody/io/README.md", ".docs/conf.py", "examples/flexible_link.png"} <= held
    assert not [name for name in held if name.endswith((".pyc", ".nbi", ".nbc"))]
    for head in ("License-Expression: MIT", "Requires-Python: >=3.11", "Keywords: ", "Summary: ",
                 "Description-Content-Type: text/markdown", "Classifier: Typing :: Typed"):
        assert head in about


def test_messages_and_pages_name_extras_that_exist():
    """As `pip install "sebody[...]"`, in quotes, which some shells need."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"][
        "optional-dependencies"]
    texts = [path.read_text() for folder in ("sebody", "derive", "examples")
             for pattern in ("*.py", "*.md") for path in (ROOT / folder).rglob(pattern)]
    named = [name for text in texts for name in re.findall(r'pip install (\S*sebody\S*)', text)]
    assert len(named) > 8
    for name in named:
        quoted = re.match(r'"sebody\[({\w+\.extra}|\w+)\]"', name)
        assert quoted, name
        assert quoted[1] in extras or quoted[1] == "{source.extra}"
    assert {source.extra for source in SOURCES} - {""} <= set(extras)


def test_the_check_of_a_commit_runs_what_the_readme_says():
    """Both commands of the README in their order; no variable makes things easier for them.

    Those that choose another processor are set in one file, after the commands.
    """
    commands = re.findall(r"^pip install -e .*$", (ROOT / "README.md").read_text(), re.M)
    script = (ROOT / ".ci/run").read_text()
    patterns = re.findall(r"grep -m 1 '([^']*)' README\.md", script)
    assert [[bool(re.search(pattern, command)) for command in commands]
            for pattern in patterns] == [[True, False], [False, True]]
    assigned = {path.name: set(re.findall(r"\b[A-Z_]+(?==)", path.read_text()))
                for path in (ROOT / ".ci").iterdir()}
    assert assigned.pop("pass") == {"OPENBLAS_CORETYPE", "OPENBLAS_NUM_THREADS", "NUMBA_CPU_NAME",
                                    "NUMBA_CPU_FEATURES", "NPY_DISABLE_CPU_FEATURES"}
    assert script.index(".ci/pass other") > script.rindex("README.md")
    # the last takes away
    assert set().union(*assigned.values()) == {"HOME", "PYTHONHASHSEED", "SEBODY_PLAIN"}
