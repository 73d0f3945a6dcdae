"""What the bodies of a model lack, and why."""

from sebody.fem.materials import doubts
from sebody.model.mechanism import Mechanism


def cautions(model: Mechanism) -> list[str]:
    """Missing stresses, stiffening and exact inertia, and materials that speak for other units.

    Sentences ``body 'rod' has no stresses: why; what to do``, one for all bodies of a reason.
    """
    owners: dict[str, list[str]] = {}
    for body in model.bodies.values():
        for text in body.reduced.cautions:
            owners.setdefault(text, []).append(repr(body.name))
    sentences = [f"{'body' if len(names) == 1 else 'bodies'} {_listed(names)} "
                 f"{'has' if len(names) == 1 else 'have'} {text}" for text, names in owners.items()]
    return sentences + _of_materials(model)


def _of_materials(model: Mechanism) -> list[str]:
    """What speaks against the materials in units that were named."""
    if not model.units:
        return []
    sentences: dict[str, None] = {}
    for body in model.bodies.values():
        for text in doubts(body.reduced.materials, model.units):
            sentences[f"body {body.name!r}: {text}"] = None
    return list(sentences)


def _listed(names: list[str]) -> str:
    """Names, the first few of many."""
    shown = names if len(names) <= _SHOWN else [*names[:_SHOWN - 1],
                                                f"{len(names) - _SHOWN + 1} more"]
    return " and ".join(filter(None, [", ".join(shown[:-1]), shown[-1]]))


_SHOWN = 6
