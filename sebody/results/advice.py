"""What a summary says of kernels: where one made for the layout would pay."""

from sebody.contract.names import layout_variant
from sebody.kernels.loader import derive_command, load
from sebody.model.inertias import second_order
from sebody.model.mechanism import Mechanism

# unknowns of a body up to which a kernel with its counts as constants takes a fifth to a half less
# time than a general one; with 34 there is no difference, see tests/benchmarks/README.md
PAYS = 24


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
