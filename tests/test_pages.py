"""Every block of code and every command of the pages runs, page by page and in its order."""

import re
from pathlib import Path

import pytest
from copies import ROOT
from pages import all_pages, blocks, commands_in_words, run

# pages whose blocks other tests run, which need a copy of the tree or the README's numbers
ELSEWHERE = {
    "README.md": "tests/cli/test_cli.py, .ci/run",
    ".github/CONTRIBUTING.md": "tests/derive/test_recipes.py",
    ".docs/tutorials/3_formula.md": "tests/derive/test_recipes.py",
}
PAGES = {page.relative_to(ROOT).as_posix(): page for page in all_pages()
         if blocks(page.read_text())}


@pytest.mark.parametrize("name", sorted(set(PAGES) - set(ELSEWHERE)))
def test_page(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for program in run(PAGES[name], tmp_path):
        if program == "ccx":
            pytest.skip("needs CalculiX: the commands after ccx read what it writes")


def test_commands_in_running_text_can_be_given():
    """Each is one that the command line takes, with all that it needs."""
    from sebody.cli.entry import _parser

    found = [words for page in all_pages() for words in commands_in_words(page.read_text())]
    assert ["plot", "run.npz", "crank pin hinge.force.norm"] in found and len(found) > 10
    for words in found:
        assert _parser().parse_args(words).command, words


def test_every_page_is_collected(tmp_path, monkeypatch):
    """By rule, with the files that it links to; the front page lists them all."""
    monkeypatch.syspath_prepend(str(ROOT / ".docs"))
    import collect

    collect.write(ROOT, tmp_path, ["gallery/index"])
    front = (tmp_path / "index.md").read_text()
    listed = [line[1:] for line in front.splitlines() if line.startswith("/")]
    assert len(listed) == len(set(listed)) == len(all_pages())      # the README is the front page
    for name in set(listed) - {"gallery/index"}:
        page = tmp_path / f"{name}.md"
        for link in re.findall(r"\]\(([^)#:\s]+)(?=[)#])", page.read_text()):
            assert (page.parent / link).exists(), (name, link)


def test_other_tests_run_the_rest():
    assert set(ELSEWHERE) <= set(PAGES)


def test_blocks_that_do_not_run_have_a_reason():
    exempt = {name: block.reason for name, page in PAGES.items()
              for block in blocks(page.read_text()) if block.reason}
    assert all(len(reason) > 10 for reason in exempt.values()), exempt


NAMED = re.compile(r"(?<![\w/.~$}-])((?:\.[a-z]+|[a-z_]\w*)/[\w./*-]*[\w/*]|test_\w+\.py)")
OURS = tuple(sorted({path.name for path in ROOT.iterdir() if path.is_dir()} - {".git"}))
SCRIPTS = [path for path in (*(ROOT / ".ci").iterdir(), *(ROOT / ".github/workflows").iterdir(),
                             ROOT / "pyproject.toml") if path.is_file()]


def missing(text: str, folder: Path) -> list[str]:
    """Paths of this tree that a text of a folder names, does not make, and that do not exist."""
    found, made = [], re.findall(r"New file `([^`]+)`", text)
    for name in NAMED.findall(text):
        if name in made:
            continue
        first, _, rest = name.partition("/")
        beside = [one for one in (folder, *folder.parents) if one.is_relative_to(ROOT)]
        places = [one / name for one in beside if first in OURS or (one / first).is_dir()]
        if not rest and not list((ROOT / "tests").rglob(name)):
            found.append(name)
        elif rest and places and not any(
                one.exists() or list(one.parent.glob(one.name)) for one in places):
            found.append(name)
    return found


@pytest.mark.parametrize("path", [*SCRIPTS, *all_pages()],
                         ids=lambda path: path.relative_to(ROOT).as_posix())
def test_paths_that_are_named_exist(path):
    """A script with a path that moved tests nothing, or fails where nobody looks."""
    assert not missing(path.read_text(), path.parent)


def test_a_path_that_does_not_exist_is_found():
    assert missing("run tests/runs/test_statics.py and tests/runs/test_gone.py, test_gone.py; "
                   "tests/runs/gone/, derive/*.py, derive/*.gone, other/thing.py", ROOT) == [
                       "tests/runs/test_gone.py", "test_gone.py", "tests/runs/gone/",
                       "derive/*.gone"]
