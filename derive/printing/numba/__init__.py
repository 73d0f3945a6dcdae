"""Files of kernels for Numba: everything that knows Python and what compiles it."""
