"""Compilation: decorators, what is kept of compiled code, first runs. See README.md."""
