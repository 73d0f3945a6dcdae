"""Errors a user of the package can catch."""


class SebodyError(Exception):
    """Base of all errors raised on purpose by this package."""


class InputError(SebodyError, ValueError):
    """Input that cannot be used; the message names the offending thing and the remedy."""


class LimitWarning(UserWarning):
    """A run is outside what its model or scheme can tell; the message names limit and remedy."""


class WriteError(SebodyError, OSError):
    """A file that could not be written; what was there before is unchanged."""


class SimulationError(SebodyError):
    """A run that stopped; `result` holds what it computed until then."""

    def __init__(self, message: str, result: object):
        super().__init__(message)
        self.result = result


class Interrupted(KeyboardInterrupt):
    """A run stopped by Ctrl-C; `result` holds what it computed until then."""

    def __init__(self, message: str, result: object):
        super().__init__(message)
        self.result = result
