"""The time loop for eight members of an ensemble at a time.

Of the fast way to compile alone. Importing this room puts in place what the loop's functions and
kernels call for lanes.
"""

import sebody.kernels.lanes
from sebody.engine.lanes import tables

__all__ = ["tables"]
