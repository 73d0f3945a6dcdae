"""Symbols and how they vary: rotations, spaces, steps, the chain rule."""
