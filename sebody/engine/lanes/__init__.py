"""The time loop for eight members of an ensemble at a time.

Of the fast way to compile alone. Importing this package puts in place what the loop's functions and
kernels call for lanes.
"""

from sebody.engine.lanes import links, load_amplitudes, prediction, selection
from sebody.kernels.lanes import blocks, frame_search, packed_products, products, rotations

__all__ = ["blocks", "frame_search", "links", "load_amplitudes", "packed_products", "prediction",
           "products", "rotations", "selection"]
