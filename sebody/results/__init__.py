"""What a run yields: histories by name, balances, pictures, files."""

from sebody.results.animation import animate
from sebody.results.drawing import plot
from sebody.results.field import Field
from sebody.results.plots import save_picture
from sebody.results.recording import Recording, Start
from sebody.results.report import report
from sebody.results.result import Result

__all__ = ["Field", "Recording", "Result", "Start", "animate", "plot", "report", "save_picture"]
