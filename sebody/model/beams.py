"""Straight beams as superelements."""

from numpy.typing import ArrayLike

from sebody.errors import InputError
from sebody.fem import Section, planar_beam, straight_beam
from sebody.model.bodies import superelement
from sebody.model.inputs import known
from sebody.model.mechanism import Mechanism
from sebody.model.nodes import node
from sebody.model.parts import Node
from sebody.reduction import craig_bampton


def beam(model: Mechanism, name: str, ends: tuple[Node | str, Node | str], section: Section,
         elements: int, bodies: int | None = None, modes: int = 0,
         up: ArrayLike | None = None, **placing) -> list[Node]:
    """A straight beam of equal superelements; with one element each, a nonlinear beam.

    A superelement of one finite element, with the mean of its two rotations as frame, has the
    strain energy of Simo and Reissner's geometrically exact beam: strains of the chord are
    ``Gamma = R_m^T (x_b - x_a) / l - t`` with the rotation R_m half way between those of the nodes,
    and each node is rotated by half of ``log(R_a^T R_b)`` against R_m. The exact linear stiffness
    does not lock; with no shear factor in the section it is that of Euler and Bernoulli. So beams
    without modes and with as many bodies as elements are the nonlinear reference for
    superelements.

    Parameters
    ----------
    ends : two Nodes or str
        Full nodes at the ends of the axis.
    section : Section
    elements : int
        Finite elements from end to end.
    bodies : int, optional
        Superelements; as many as elements by default.
    modes : int
        Internal modes of each.
    up : (3,), optional
        Direction of the section's y axis, see `sebody.fem.straight_beam`.
    **placing
        Arguments of `superelement`, such as ``frame``.

    Returns
    -------
    list of Node
        All nodes from end to end, named ``<name> 1`` and so on between them. Superelements are
        named alike; a single one is called `name`.

    Raises
    ------
    InputError
        No element, elements that cannot be divided among the bodies, or names that are taken.
    """
    first, last = (known(model, n) for n in ends)
    bodies = elements if bodies is None else bodies
    if elements != int(elements) or elements < 1:
        raise InputError(f"beam {name!r} has {elements} elements: give a whole number >= 1")
    if bodies != int(bodies) or bodies < 1 or elements % bodies:
        raise InputError(f"beam {name!r}: {elements} elements cannot be divided among {bodies} "
                         "bodies: give a multiple")
    step, each = (last.point - first.point) / bodies, elements // bodies
    nodes = [first, *(node(model, f"{name} {k}", first.point + k * step)
                      for k in range(1, bodies)), last]
    fe_model = (planar_beam(first.point, first.point + step, section, each) if model.planar else
                straight_beam(first.point, first.point + step, section, each, up))
    body = craig_bampton(fe_model, [(0, "full"), (each, "full")], modes)
    for k, pair in enumerate(zip(nodes, nodes[1:], strict=False), 1):
        superelement(model, name if bodies == 1 else f"{name} {k}", body, pair, **placing)
    return nodes
