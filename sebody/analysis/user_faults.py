"""Faults of users' functions in a run: which of them raised, or gave what is not finite."""

from collections.abc import Iterator

from sebody.kernels.user_functions import UserFunction
from sebody.model.mechanism import Mechanism


def functions(model: Mechanism) -> Iterator[tuple[str, UserFunction]]:
    """The compiled functions of a model, and what each of them is."""
    for element in (*model.constraints, *model.loads):
        if element.function is not None:
            yield f"user force {element.name!r}", element.function
        if element.history is not None:
            for function in element.history.functions:
                yield f"the function of {element.name!r}", function
    for triplet in model.triplets():
        for motion in triplet.motions:
            for function in motion.history.functions:
                yield f"the function of {motion.name!r}", function


def forget(model: Mechanism) -> None:
    """Forget faults of other runs."""
    for _, function in functions(model):
        function.forget()


def fault(model: Mechanism, since: float) -> str:
    """The first function with a fault at a time or later, and what it did; empty if none has."""
    for what, function in functions(model):
        if did := function.fault(since):
            return f"{what} {did}: correct it"
    return ""
