"""The inertia option of a superelement, and its stiffening: chosen here alone."""

from sebody.basics import inputs
from sebody.basics.errors import InputError
from sebody.generated import options
from sebody.model.frames import FRAMES
from sebody.reduction.body import ReducedBody

BY_LETTER = {traits.letter: name for name, traits in options.INERTIA_OPTIONS.items()}


def known_inertia(inertia: str | None) -> str | None:
    """Name of an inertia option that is given by its name or by its letter; None stays None.

    Raises
    ------
    InputError
        There is no such option; the message lists them.
    """
    name = BY_LETTER.get(inertia, inertia) if isinstance(inertia, str) else inertia
    if name is None or (isinstance(name, str) and name in options.INERTIA_OPTIONS):
        return name
    listed = ", ".join(f"{own!r} ({letter})" for letter, own in BY_LETTER.items())
    raise InputError(f"inertia {inputs.shown(inertia)} is unknown: use one of {listed}")


def chosen_inertia(name: str, body: ReducedBody, frame: str, inertia: str | None,
                   stiffening: bool | None) -> tuple[str, bool]:
    """The option and the stiffening of a body; what is None follows from the data of the body.

    Options are given by their names, see `known_inertia`.

    Raises
    ------
    InputError
        Options that do not exist, or need more than the frame or the body gives; with the remedy.
    """
    if stiffening is not None:
        stiffening = inputs.flag(stiffening, f"superelement {name!r}: stiffening")
    option = best_inertia(body, frame) if inertia is None else inertia
    _check_option(option, frame)
    if stiffening:
        _check_stiffening(name, body, option, frame)
    if not options.INERTIA_OPTIONS[option].field:
        return option, False
    if body.invariants is None:
        raise InputError(f"superelement {name!r}: inertia {option!r} needs the mass and modes of "
                         "the FE model, and the body has reduced matrices alone: reduce it from a "
                         "model, use inertia='rigid_part', or use inertia='material' as the paper "
                         "does")
    return option, body.invariants.stiffens if stiffening is None else stiffening


def best_inertia(body: ReducedBody, frame: str) -> str:
    """The most exact option that a body has the constants for, and the frame the rates."""
    if FRAMES[frame].traits.incremental:    # the paper's own frames, with the paper's option
        return "material"
    return "rigid_part" if body.invariants is None else "floating_field"


def needs_damped_kernel(body: ReducedBody, inertia: str) -> bool:
    """Tell whether the body is damped and the kernels of its option are not for both kinds."""
    return body.damping is not None and not options.INERTIA_OPTIONS[inertia].rates


def second_order(body: ReducedBody, inertia: str, stiffening: bool) -> tuple[int, int] | None:
    """Numbers of slaved coordinates and stress resultants, of options that have them."""
    if body.invariants is None or not options.INERTIA_OPTIONS[inertia].field:
        return None
    return (body.invariants.slaved, body.invariants.resultants) if stiffening else (0, 0)


def _check_option(inertia: str, frame: str) -> None:
    if options.INERTIA_OPTIONS[inertia].rates and FRAMES[frame].traits.incremental:
        raise InputError(f"inertia {inertia!r} needs the exact rates of a frame that depends on "
                         f"the state alone, which {frame!r} does not: use one of "
                         f"{_exact_frames()}")


def _check_stiffening(name: str, body: ReducedBody, inertia: str, frame: str) -> None:
    """Refuse stiffening of a body without geometric stiffness, or with another inertia."""
    what = f"superelement {name!r}: stiffening"
    if FRAMES[frame].traits.incremental:
        raise InputError(f"{what} needs a frame that depends on the state alone, which {frame!r} "
                         f"does not: use one of {_exact_frames()}")
    if body.invariants is None:
        raise InputError(f"{what} needs the mass, modes and geometric stiffness of the FE model, "
                         "and the body has reduced matrices alone: reduce it from a model, or "
                         "divide the body")
    if not options.INERTIA_OPTIONS[inertia].field:
        raise InputError(f"{what} is a part of inertia 'floating_field', not of {inertia!r}: leave "
                         "inertia out, or stiffening")
    if not body.invariants.stiffens:
        raise InputError(f"{what} needs a geometric stiffness, and the FE model of the body has "
                         "none, or a negligible one: give it as "
                         "FEModel(geometric_stiffness=...), or divide the body")


def _exact_frames() -> str:
    return ", ".join(sorted(n for n, f in FRAMES.items() if not f.traits.incremental))
