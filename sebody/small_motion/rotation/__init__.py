"""Axes of analyses about a rotation: what turns, what stands, and in which axes both are told."""
