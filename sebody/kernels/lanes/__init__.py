"""What kernels call, for numbers that are lanes: put in its place by importing this room.

Of the fast way to compile alone.
"""

from sebody.kernels.lanes import frame_search, products, rotations

__all__ = ["frame_search", "products", "rotations"]
