"""Object files of a model: those of the engine and of kernels are kept and never made again."""

from collections.abc import Iterable
from pathlib import Path

from sebody.basics.errors import SebodyError
from sebody.compiler.code import Place
from sebody.compiler.sources import folder_hash
from sebody.compiler.workers import Task, call_all
from sebody.engine import loop
from sebody.export.functions import FUNCTIONS, codes, place
from sebody.export.linking import Part, functions_object, model_object
from sebody.export.platforms import tag
from sebody.export.prepared import Prepared

KIND, ENGINE = "object", "engine"


def objects(model: Prepared, platform: str, processor: str) -> dict[str, bytes]:
    """The object files of a model for a platform, by name.

    LLVM ends the process that asks for an instruction which a target lacks. So object files that
    are not kept yet are made in processes of their own, except those of users' functions.

    Raises
    ------
    InputError
        No folder for compiled code can be written.
    SebodyError
        LLVM has failed.
    """
    names, target = (ENGINE, *model.kernels), f"{platform}.{tag(processor)}"
    objects_of = {name: _place(name).kept(KIND, target) for name in names}
    missing = [name for name, content in objects_of.items() if content is None]
    if missing:
        codes(_of(missing), processor)
        call_all([Task(name, f"{__name__}:keep_one", (name, platform, processor))
                  for name in missing])
        objects_of |= {name: _place(name).kept(KIND, target) for name in missing}
    if lacking := [name for name, content in objects_of.items() if content is None]:
        raise SebodyError(f"LLVM has made no code of {', '.join(lacking)} for {platform} and "
                          f"{processor}: leave this platform out, or give another processor")
    made = {name: content for name, content in objects_of.items() if content is not None}
    users = model.users()
    if users:
        made["users"] = functions_object(users, platform, processor)
    made["model"] = model_object(model.called, model.image.packed, platform, processor)
    return made


def keep_one(name: str, platform: str, processor: str) -> None:
    """Make an object file, of the engine or of a kernel, and keep it."""
    made = codes(_of([name]), processor)
    parts = ([Part(one, one, made[one]) for one in FUNCTIONS] if name == ENGINE else
             [Part(name, "kernel", made[name])])
    _place(name).keep(KIND, f"{platform}.{tag(processor)}",
                      functions_object(parts, platform, processor))


def _of(names: Iterable[str]) -> list[str]:
    """Functions of the engine and kernels that some object files consist of."""
    return [one for name in names for one in (FUNCTIONS if name == ENGINE else (name,))]


def _place(name: str) -> Place:
    """The place where an object file is kept; it depends on this folder, too."""
    if name != ENGINE:
        own = place(name)
    else:
        hashes = " ".join(dict.fromkeys(place(one).made_from for one in FUNCTIONS))
        own = Place(Path(loop.__file__), ENGINE, hashes)
    return own._replace(made_from=f"{own.made_from} {folder_hash('export')}")
