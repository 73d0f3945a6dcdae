"""The command line."""

from sebody.cli.main import main

__all__ = ["main"]
