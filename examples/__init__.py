"""Scenes that `sebody run` knows: one a file, each with `build(**parameters) -> Scene`."""
