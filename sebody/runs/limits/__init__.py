"""Warnings and the thresholds they have: what a run, a body or a frame is good for."""
