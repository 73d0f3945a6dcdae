"""The time loop for eight members of an ensemble at a time.

Of the fast way to compile alone. Importing this package puts in place what the loop's functions and
kernels call for lanes.
"""

from sebody.engine.lanes import (
    elements,
    growth,
    links,
    load_amplitudes,
    matrix,
    prediction,
    selection,
)
from sebody.kernels.lanes import blocks, frame_search, packed_products, products, rotations

__all__ = ["blocks", "elements", "frame_search", "growth", "links", "load_amplitudes", "matrix",
           "packed_products", "prediction", "products", "rotations", "selection"]
