"""Kernels written by ``python -m sebody.derive``: do not edit, change derive/ and run it."""
