"""Confirmations of this package: kernels, known limits, numbers of others, measurements."""
