"""Warnings that point at the line of the caller's own code."""

from __future__ import annotations

import sys
import warnings

from sebody.basics.errors import LimitWarning

PACKAGE = __name__.partition(".")[0]
SCENES = f"{PACKAGE}.scenes."     # written as users write theirs


def warn(message: Warning | str, category: type[Warning] = LimitWarning) -> None:
    """Warn at the innermost line that is not of this package.

    How many calls lie between depends on the way a user came: a builder by a method or a function,
    a run alone or within a search.
    """
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and _own(frame.f_globals.get("__name__", "")):
        level, frame = level + 1, frame.f_back
    warnings.warn(message, category, stacklevel=level)


def _own(module: str) -> bool:
    return module.partition(".")[0] == PACKAGE and not module.startswith(SCENES)
