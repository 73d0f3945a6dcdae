"""Errors a user of the package can catch."""


class SebodyError(Exception):
    """Base of all errors raised on purpose by this package."""


class InputError(SebodyError, ValueError):
    """Input that cannot be used; the message names the offending thing and the remedy."""
