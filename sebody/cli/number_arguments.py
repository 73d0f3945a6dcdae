"""Numbers on the command line; messages say what to give."""

import argparse


def whole(text: str) -> int:
    """A whole number, for `type=` of an argument."""
    try:
        return int(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{text!r} is no whole number: give one such as 4"
                                         ) from error


def real(text: str) -> float:
    """A number, for `type=` of an argument."""
    try:
        return float(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{text!r} is no number: give one such as 0.01"
                                         ) from error
