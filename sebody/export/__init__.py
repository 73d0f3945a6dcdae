"""Models as libraries for C and as FMUs: see README.md."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.export.exporting import export as export

load_on_demand(__name__)
