"""Files: those of finite element programs, and bodies in files of our own."""

from typing import TYPE_CHECKING

from sebody.basics.lazy import load_on_demand

if TYPE_CHECKING:
    from sebody.io.beamdyn import Blade as Blade, read_beamdyn as read_beamdyn
    from sebody.io.body_file import (
        BodyFile as BodyFile,
        load_body as load_body,
        read_body_file as read_body_file,
        save_body as save_body,
    )
    from sebody.io.extptfm import read_extptfm as read_extptfm, write_extptfm as write_extptfm
    from sebody.io.importing import import_body as import_body, read_fe_model as read_fe_model
    from sebody.io.load_series import LoadSeries as LoadSeries
    from sebody.io.ngsolve_space import from_ngsolve as from_ngsolve
    from sebody.io.registry import SOURCES as SOURCES, Source as Source
    from sebody.io.scikit_fem import from_skfem as from_skfem
    from sebody.io.sid import write_sid as write_sid

load_on_demand(__name__)
