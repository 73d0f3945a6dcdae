"""Remarks of summaries on the bodies of a model: what they lack and why, kernels that would pay."""

from sebody.contract.names import layout_variant
from sebody.fem.materials import doubts
from sebody.kernels.loader import derive_command, load
from sebody.model.inertias import second_order
from sebody.model.mechanism import Mechanism

_SHOWN = 6          # names of bodies
# unknowns of a body up to which a kernel with its counts as constants takes a fifth to a half less
# time than a general one; with 34 there is no difference, see tests/benchmarks/README.md
PAYS = 24


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
    """Doubts about the materials in units that were named."""
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


def kernels_that_pay(model: Mechanism) -> dict[str, list[str]]:
    """Commands that make kernels, and the bodies on general kernels that gain by each."""
    commands: dict[str, list[str]] = {}
    for body in model.bodies.values():
        kernel = load(body.kernel)
        assert kernel is not None       # the model was built with it
        if kernel.N_POSITIONS is None and len(body.reduced.stiffness) <= PAYS:
            variant = layout_variant(body.layout, body.reduced.modes, bool(kernel.DAMPED),
                                     second_order(body.reduced, body.inertia, body.stiffening))
            command = derive_command(variant, kernel.FRAME, kernel.INERTIA)
            commands.setdefault(command, []).append(body.name)
    return commands
