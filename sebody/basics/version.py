"""The version of the installed package."""

from importlib.metadata import PackageNotFoundError, version

try:
    __version__ = version("sebody")
except PackageNotFoundError:        # a checkout on the path that is not installed
    __version__ = "not installed"
