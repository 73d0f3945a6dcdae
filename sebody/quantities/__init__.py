"""Quantities: one formula for each name of a result, read by everything that knows names."""
