"""Results of runs: histories by name, balances, pictures, files."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.pictures.animation import animate as animate
    from sebody.pictures.drawing import plot as plot
    from sebody.pictures.plots import save_picture as save_picture
    from sebody.pictures.report import report as report
    from sebody.results.field import Field as Field
    from sebody.results.recording import Recording as Recording, Start as Start
    from sebody.results.result import Result as Result

load_on_demand(__name__)
