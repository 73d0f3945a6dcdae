"""Results of runs: histories by name, balances, pictures, files."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.pictures.animation import animate
    from sebody.pictures.drawing import plot
    from sebody.pictures.plots import save_picture
    from sebody.pictures.report import report
    from sebody.results.field import Field
    from sebody.results.recording import Recording, Start
    from sebody.results.result import Result

__all__ = ["Field", "Recording", "Result", "Start", "animate", "plot", "report", "save_picture"]

load_on_demand(__name__)
