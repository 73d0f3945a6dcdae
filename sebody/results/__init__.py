"""What a run yields: histories by name, balances, pictures, files."""

from sebody.results.plots import save_picture
from sebody.results.recording import Recording, Start
from sebody.results.result import Result

__all__ = ["Recording", "Result", "Start", "save_picture"]
