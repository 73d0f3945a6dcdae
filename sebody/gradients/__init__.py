"""Exact gradients of runs."""
