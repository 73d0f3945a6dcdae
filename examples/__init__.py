"""Scenes that `sebody run` knows: one a file, each with `build(**parameters) -> Scene`."""

import warnings

# scenes were written for the sign of ways since version 0.2.0, which others are told of
warnings.filterwarnings("ignore", ".* since version 0.2.0 ", FutureWarning, r"sebody\.scenes\.")
