"""Functions that kernels call, for numbers that are lanes; of the fast way to compile alone.

`sebody.engine.lanes` imports these modules, which puts their functions in place.
"""

from sebody.kernels.lanes import sines

__all__ = ["sines"]
