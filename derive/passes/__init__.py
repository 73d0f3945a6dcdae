"""Passes over the steps and statements of a kernel, whatever it is of."""
