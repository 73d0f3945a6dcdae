"""Pictures and animations as a notebook shows them, as the last value of a cell."""

import base64
import html
import io
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from sebody.basics.files import check_target, replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

HEIGHT = 640            # pixels of a page in a notebook
DPI = 110               # of a figure


class ShownFile(type(Path())):
    """The path of a page or film that was written, which a notebook shows."""

    def _repr_html_(self) -> str | None:
        content = self.read_bytes() if self.is_file() else b""
        data = base64.b64encode(content).decode()
        if self.suffix == ".html" and content:
            return _frame(content.decode())
        if self.suffix == ".gif" and content:
            return f'<img alt="animation" src="data:image/gif;base64,{data}">'
        if self.suffix == ".mp4" and content:
            return f'<video controls src="data:video/mp4;base64,{data}"></video>'
        return None


class Page:
    """A page that is not written yet: shown by a notebook, or written by `save`.

    Parameters
    ----------
    text : str
        HTML.
    """

    def __init__(self, text: str):
        self.text = text

    def __repr__(self) -> str:
        return f"<Page of {len(self.text) / 1e6:.1f} MB: a notebook shows it, save writes it>"

    def _repr_html_(self) -> str:
        return _frame(self.text)

    def save(self, path: str | Path) -> ShownFile:
        """Write the page.

        Raises
        ------
        InputError
            A file that cannot be written.
        WriteError
            Writing fails; an older file is unchanged.
        """
        target = ShownFile(check_target(path, "page", (".html",)))
        with replacing(target, "page") as file:
            file.write(self.text.encode())
        return target


def shown(figure: "Figure") -> "Figure":
    """A figure that a notebook shows, also without matplotlib's own support for it."""
    figure._repr_png_ = partial(_png, figure)
    return figure


def _png(figure: "Figure") -> bytes:
    content = io.BytesIO()
    figure.savefig(content, format="png", dpi=DPI)
    return content.getvalue()


def _frame(text: str) -> str:
    """A whole page within the page of a notebook."""
    return (f'<iframe srcdoc="{html.escape(text)}" width="100%" height="{HEIGHT}" '
            'style="border: none" sandbox="allow-scripts"></iframe>')
