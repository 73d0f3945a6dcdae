"""Every block of code and every command of the pages runs, page by page and in its order."""

import re

import pytest
from copies import ROOT
from pages import all_pages, blocks, run

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
