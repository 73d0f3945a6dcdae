"""The agreement of derivation and runtime: contents of all arrays, names of kernels."""
