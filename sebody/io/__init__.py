"""Files: those of finite element programs, and bodies in files of our own."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.io.beamdyn import Blade, read_beamdyn
    from sebody.io.body_file import BodyFile, load_body, read_body_file, save_body
    from sebody.io.extptfm import read_extptfm, write_extptfm
    from sebody.io.importing import import_body, read_fe_model
    from sebody.io.load_series import LoadSeries
    from sebody.io.ngsolve_space import from_ngsolve
    from sebody.io.registry import SOURCES, Source
    from sebody.io.scikit_fem import from_skfem
    from sebody.io.sid import write_sid

__all__ = ["SOURCES", "Blade", "BodyFile", "LoadSeries", "Source", "from_ngsolve", "from_skfem",
           "import_body", "load_body", "read_beamdyn", "read_body_file",
           "read_extptfm", "read_fe_model", "save_body", "write_extptfm", "write_sid"]

load_on_demand(__name__)
