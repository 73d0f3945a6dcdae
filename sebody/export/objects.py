"""Object files of a model: those of the engine and of kernels are kept and never made again."""

from collections.abc import Sequence
from pathlib import Path

from sebody.compiler.code import Code, Place
from sebody.compiler.sources import room_hash
from sebody.engine import loop
from sebody.export.functions import FUNCTIONS, codes, place
from sebody.export.linking import Part, functions_object, model_object
from sebody.export.platforms import tag
from sebody.export.prepared import Prepared

KIND, ENGINE = "object", "engine"


def objects(model: Prepared, platform: str, processor: str) -> dict[str, bytes]:
    """The object files of a model for a platform, by name."""
    places = {ENGINE: _engine()} | {name: _own(place(name)) for name in model.kernels}
    target = f"{platform}.{tag(processor)}"
    found = {name: one.kept(KIND, target) for name, one in places.items()}
    missing = [name for name, content in found.items() if content is None]
    wanted = [one for name in missing for one in (FUNCTIONS if name == ENGINE else (name,))]
    made = codes(wanted, processor)
    for name in missing:
        found[name] = functions_object(_parts(name, made), platform, processor)
        places[name].keep(KIND, target, found[name])
    users = model.users()
    if users:
        found["users"] = functions_object(users, platform, processor)
    found["model"] = model_object(model.called, model.image.packed, platform, processor)
    return {name: content for name, content in found.items() if content is not None}


def _parts(name: str, made: dict[str, Code]) -> Sequence[Part]:
    if name == ENGINE:
        return [Part(one, one, made[one]) for one in FUNCTIONS]
    return [Part(name, "kernel", made[name])]


def _engine() -> Place:
    hashes = " ".join(dict.fromkeys(place(name).made_from for name in FUNCTIONS))
    return _own(Place(Path(loop.__file__), ENGINE, hashes))


def _own(one: Place) -> Place:
    """Object files depend on this room, too."""
    return one._replace(made_from=f"{one.made_from} {room_hash('export')}")
