"""Files of the folder `page`: templates of pages, styles and scripts."""

from collections.abc import Mapping
from importlib.resources import files


def filled(name: str, parts: Mapping[str, str]) -> str:
    """A file with its places ``{{part}}`` filled in; parts may contain braces of their own."""
    text = (files("sebody.pictures") / "page" / name).read_text()
    if not parts:
        return text
    first, *rest = text.split("{{")
    pieces = (piece.partition("}}") for piece in rest)
    return first + "".join(parts[place] + after for place, _, after in pieces)
