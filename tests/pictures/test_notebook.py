"""Notebooks: pictures and animations as values of cells, one line of progress."""

import base64
import html
import io
import re
import sys
from contextlib import redirect_stderr
from pathlib import Path
from types import SimpleNamespace

import pytest

from sebody import InputError, simulate
from sebody.basics import progress
from sebody.pictures.notebook import Page, ShownFile
from sebody.results import animate, plot
from sebody.scenes import hinged_beam


@pytest.fixture(scope="module")
def result():
    return simulate(hinged_beam.build(modes=1, elements=4).model, 0.01, 0.5)


def framed(shown: str) -> str:
    """The page within a page."""
    match = re.fullmatch(r'<iframe srcdoc="([^"]*)" width="100%" height="\d+" [^>]*></iframe>',
                         shown)
    return html.unescape(match[1])


def test_an_animation_is_a_value_of_a_cell(result, tmp_path):
    """The page itself without a file, the same page of a file that was written."""
    page = animate(result)
    assert isinstance(page, Page) and "<canvas" in page.text
    assert framed(page._repr_html_()) == page.text
    assert re.fullmatch(r"<Page of \d+\.\d MB: a notebook shows it, save writes it>", repr(page))
    path = animate(result, tmp_path / "beam.html")
    assert isinstance(path, Path) and path == tmp_path / "beam.html"
    assert framed(path._repr_html_()) == path.read_text()
    saved = page.save(tmp_path / "other.html")
    assert saved.read_text() == page.text and framed(saved._repr_html_()) == page.text
    with pytest.raises(InputError, match="page"):
        page.save(tmp_path / "nowhere" / "other.html")


def test_films_are_shown_and_other_files_are_not(tmp_path):
    content = b"GIF89a of some bytes"
    for name, begin in (("film.gif", '<img alt="animation" src="data:image/gif;base64,'),
                        ("film.mp4", '<video controls src="data:video/mp4;base64,')):
        path = ShownFile(tmp_path / name)
        assert path._repr_html_() is None           # it is not there
        path.write_bytes(content)
        shown = path._repr_html_()
        assert shown.startswith(begin)
        assert base64.b64decode(re.search(r'base64,([^"]*)"', shown)[1]) == content
    other = ShownFile(tmp_path / "table.csv")
    other.write_text("1")
    assert other._repr_html_() is None and ShownFile(tmp_path)._repr_html_() is None


def test_a_figure_is_a_value_of_a_cell(result):
    pytest.importorskip("matplotlib")
    assert plot(result, "tip.position")._repr_png_().startswith(b"\x89PNG")


class ZMQInteractiveShell:
    """As IPython calls the shell of a notebook."""


class Cell:
    """The output of a cell: its lines are in the order in which they were first shown."""

    def __init__(self):
        self.lines, self.calls = [], 0

    def display(self, content, raw, display_id):
        assert raw and display_id is True
        self.lines.append(content["text/plain"])
        self.calls += 1
        place = len(self.lines) - 1

        def update(content, raw):
            assert raw
            self.lines[place] = content["text/plain"]
            self.calls += 1
        return SimpleNamespace(update=update)


def test_progress_is_one_line_of_a_notebook(monkeypatch):
    """Which changes; nothing goes to standard error, which notebooks show line after line."""
    cell = Cell()
    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(
        get_ipython=ZMQInteractiveShell, display=cell))
    monkeypatch.setattr(progress, "PATIENCE", 0.0)
    stream = io.StringIO()
    with redirect_stderr(stream):
        simulate(hinged_beam.build(modes=1, elements=4).model, 0.01, 1.0, progress=True)
    assert stream.getvalue() == ""
    assert len(cell.lines) == 1 and cell.calls > 1
    assert re.match(r"\[#{40}\] 100 %  t = 1 of 1", cell.lines[0])
    monkeypatch.setattr(progress, "PATIENCE", 100.0)
    simulate(hinged_beam.build(modes=1, elements=4).model, 0.01, 1.0, progress=True)
    assert len(cell.lines) == 1                     # a short run shows nothing


def test_a_terminal_with_ipython_is_no_notebook(monkeypatch):
    class TerminalInteractiveShell:
        pass

    monkeypatch.setitem(sys.modules, "IPython", SimpleNamespace(
        get_ipython=TerminalInteractiveShell, display=None))
    assert progress._notebook() is None


def test_in_a_real_notebook(tmp_path):
    """With a kernel of Jupyter, where there is one."""
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    pytest.importorskip("ipykernel")
    cells = ["from sebody import simulate\nfrom sebody.analysis import modes, progress\n"
             "from sebody.results import animate, plot\n"
             "from sebody.scenes import hinged_beam\nprogress.PATIENCE = 0.0\n"
             "model = hinged_beam.build(modes=1, elements=4).model\n"
             "result = simulate(model, 0.01, 1.0, progress=True)",
             "model", "result", "plot(result, 'tip.position')", "animate(result)",
             "animate(result, 'beam.html')", "modes(result)"]
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(one) for one in cells])
    nbclient.NotebookClient(book, resources={"metadata": {"path": str(tmp_path)}}).execute()
    outputs = [cell["outputs"] for cell in book["cells"]]
    first, = outputs[0]
    assert "100 %  t = 1 of 1" in first["data"]["text/plain"]
    for shown, kind in zip(outputs[1:], ["text/html", "text/html", "image/png", "text/html",
                                         "text/html", "text/html"], strict=True):
        one, = shown
        assert one["data"][kind], kind
    assert "<iframe" in outputs[4][0]["data"]["text/html"]
