"""From a kernel's description to its text: everything that knows Numba."""
