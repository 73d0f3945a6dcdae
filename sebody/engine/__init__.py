"""Compiled code on flat arrays: forces, matrices, steps and the time loop."""
