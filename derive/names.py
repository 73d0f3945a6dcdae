"""Kernels by what a user types: the name of one of the catalogue, or a layout with options."""

from difflib import get_close_matches

from sebody.derive.compiler import Products, Variant
from sebody.derive.kernels.layouts import Layout, LayoutError, fits
from sebody.derive.kernels.manifest import ELEMENTS
from sebody.derive.kernels.options import FRAMES, INERTIA_OPTIONS, frame_traits, inertia_traits

DEFAULT_INERTIA = "material"
OF_PRODUCTS = "products:"
BY_LETTER = {traits.letter: name for name, traits in inertia_traits().items()}


def kernel_of(text: str) -> Variant | Products | str:
    """A kernel of the catalogue by its name, or ``LAYOUT[:FRAME[:INERTIA]]``, or its products.

    Raises
    ------
    LayoutError
        Neither; the message has names that are close.
    """
    if text.startswith(OF_PRODUCTS):
        return Products(kernel_of(text.removeprefix(OF_PRODUCTS)))
    if text in ELEMENTS:
        return text
    try:
        return variant_of(text)
    except LayoutError as error:
        if close := get_close_matches(text, ELEMENTS):
            raise LayoutError(f"there is no kernel {text!r} in the catalogue: is it "
                              f"{' or '.join(close)}?") from error
        raise


def variant_of(text: str) -> Variant:
    """``LAYOUT[:FRAME[:INERTIA]]`` with the defaults filled in.

    Raises
    ------
    LayoutError
        A layout that cannot be read, or a frame or inertia option that is unknown.
    """
    parts = text.split(":")
    layout = Layout.parse(parts[0])
    able = [name for name, frame in frame_traits().items() if fits(layout, frame)]
    frame = parts[1] if len(parts) > 1 else (able or list(FRAMES))[0]
    inertia = parts[2] if len(parts) > 2 else DEFAULT_INERTIA
    inertia = BY_LETTER.get(inertia, inertia)
    for value, known, what in ((frame, FRAMES, "frame"),
                               (inertia, INERTIA_OPTIONS, "inertia option")):
        if value not in known:
            raise LayoutError(f"{what} {value!r} is unknown: use one of {', '.join(known)}")
    return Variant(layout.name, frame, inertia)
