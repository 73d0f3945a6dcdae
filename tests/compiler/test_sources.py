"""Fingerprints of code: what changes them, what does not, and that no folder drops out unseen."""

import pytest
from numba import config

from sebody.compiler import sources
from sebody.compiler.sources import folder_hash, function_hash, syntax

MODULE = '''"""A title."""
LIMIT = 0.5


def inside(x):
    """Whether x is."""
    return x < LIMIT    # strictly
'''


@pytest.fixture
def package(tmp_path, monkeypatch):
    """A package with two folders, one of them with a folder inside."""
    for name in ("kernels/a.py", "kernels/inner/b.py", "engine/c.py"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(MODULE)
    monkeypatch.setattr(sources, "PACKAGE", tmp_path)
    monkeypatch.setattr(config, "CACHE_DIR", "")
    _forget()
    yield tmp_path
    _forget()


def _forget():
    """Hashes are taken once in a process."""
    folder_hash.cache_clear()
    sources._syntax_hash.cache_clear()


@pytest.mark.parametrize("old, new", [
    ('"""A title."""', '"""Another."""'), ('    """Whether x is."""\n', ""),
    ("    # strictly", ""), ("\n\n\n", "\n"), ("(x)", "( x )"), ("x < LIMIT", "(x < LIMIT)")])
def test_comments_docstrings_and_spaces_do_not_count(old, new):
    assert old in MODULE
    assert syntax(MODULE.replace(old, new)) == syntax(MODULE)


@pytest.mark.parametrize("old, new", [
    ("0.5", "0.25"), ("0.5", "'0.5'"), ("<", "<="), ("LIMIT", "END"), ("inside", "within")])
def test_code_and_constants_count(old, new):
    assert syntax(MODULE.replace(old, new)) != syntax(MODULE)


@pytest.mark.parametrize("name", ["kernels/a.py", "kernels/inner/b.py"])
def test_every_module_of_a_folder_counts(package, name):
    before = folder_hash("kernels"), folder_hash("engine")
    (package / name).write_text(MODULE.replace("0.5", "0.25"))
    _forget()
    assert folder_hash("kernels") != before[0]
    assert folder_hash("engine") == before[1]


def test_comments_leave_the_hash(package):
    before = folder_hash("kernels", "engine")
    (package / "kernels/a.py").write_text(MODULE.replace("strictly", "really"))
    _forget()
    assert folder_hash("kernels", "engine") == before


def test_a_module_that_moves_counts(package):
    before = folder_hash("kernels")
    (package / "kernels/a.py").rename(package / "kernels/d.py")
    _forget()
    assert folder_hash("kernels") != before


def test_a_folder_that_moves_with_its_cache_counts(package):
    """Compiled code names the module it was made of, and a folder may keep its name."""
    for name in ("contract", "compiler"):
        (package / name).mkdir()
        (package / name / "a.py").write_text(MODULE)

    def found(path):
        names = {}
        exec(compile(path.read_text(), path, "exec"), names)
        return function_hash(names["inside"])

    for old, new in (("results", "runs"), ("runs/deep", "limits")):
        folder = package / old / "inner"
        folder.mkdir(parents=True)
        (folder / "b.py").write_text(MODULE)
        before = found(folder / "b.py")
        assert (folder / "__pycache__").is_dir() and found(folder / "b.py") == before
        (package / new).mkdir(exist_ok=True)
        folder.rename(package / new / "inner")
        _forget()
        assert found(package / new / "inner/b.py") != before


def test_a_folder_that_is_moved_or_empty_is_an_error(package):
    (package / "kernels").rename(package / "elsewhere")
    (package / "engine/c.py").unlink()
    for folder in ("kernels", "engine"):
        with pytest.raises(FileNotFoundError, match=f"{package / folder} holds no modules: its "
                           "hash would be empty"):
            folder_hash(folder)
