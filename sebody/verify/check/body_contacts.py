"""Criteria of contacts of points inside bodies: those of laws, and where the point is.

The point is placed a second time by rotations of SciPy, from the definition of the body's frame.
"""

from types import ModuleType, SimpleNamespace

import numpy as np
from scipy.spatial.transform import Rotation

from sebody.contract.layout import (
    AT_FRAME,
    AT_ROTATIONS,
    FRAME_CONSTANTS,
    RESIDUAL,
)
from sebody.verify.check import laws
from sebody.verify.check.definitions import frame_rotation, local_coordinates
from sebody.verify.check.states import (
    LIMIT,
    STATES,
    Case,
    CheckRow,
    along_path,
    arguments,
    called,
    changed,
    constants_of,
    derivative,
    index_row,
    with_constants,
)
from sebody.verify.check.superelement_cases import Nodes, nodes_of, placed_case

FRAME = 9       # numbers of the frame, before those that the contact keeps
SURFACES = ("plane", 1.0), ("round", 0.0)   # with values of the constant `flat`
BENT = "Hx", "Hy", "Hz"     # constants of second order
KINDS = 3       # of nodes, of those that general kernels are checked with


def body_contact_case(module: ModuleType, seed: int, nodes: Nodes, flat: float) -> Case:
    """A generic state of a body and, behind it, of the node that carries a surface."""
    body, values, random = placed_case(module, seed, nodes=nodes)
    d, turn = body.dimension, 1 if body.planar else 3
    turned = random.normal(size=turn)
    R = np.zeros(0) if body.planar else Rotation.from_rotvec(turned).as_matrix().ravel()
    q = np.r_[body.q, random.normal(size=d), turned if body.planar else 0 * turned]
    kept = np.zeros(len(module.MEMORY))
    index = np.r_[index_row(len(q), nodes.positions, nodes.rotations + 1), 0]
    index[AT_ROTATIONS], index[AT_FRAME] = nodes.rotations, FRAME
    case = Case(module, len(q), index, np.zeros(0), q, np.r_[body.R, R],
                np.r_[body.v, random.normal(size=d + turn)],
                np.r_[body.a, random.normal(size=d + turn)],
                np.r_[body.reference, kept], np.r_[body.frames, kept])
    counts = case.counts
    given = {part.name: values[part.name] if part.name in values else 1.0 + 0.5 * random.uniform(
        -1, 1, size=[counts.get(size, size) for size in part.shape]) for part in module.CONSTANTS}
    small = {name: 0.5 * random.normal(size=given[name].shape) for name in ("Phi", "point")}
    for name in BENT[:d]:
        one = 0.2 * random.normal(size=given[name].shape)
        small[name] = one + one.T
    # weak damping: a contact that opens fast has no force
    return with_constants(case, given | small | {"flat": flat, "damping": 0.1 * given["damping"]})


def _body(case: Case) -> Case:
    """The body alone, as the definitions of frames read it."""
    parts = tuple(p for p in case.module.CONSTANTS if p in FRAME_CONSTANTS or p.name == "Gam")
    module = SimpleNamespace(FRAME=case.module.FRAME, PLANAR=case.planar, CONSTANTS=parts,
                             __name__="body")
    index = index_row(case.own, case.n_positions, case.n_rotations)
    made = Case(module, case.own, index, np.zeros(0), case.q[:case.own],
                case.R[:9 * case.n_rotations], case.v[:case.own], case.a[:case.own],
                case.reference[:FRAME], case.frames[:FRAME])
    constants = constants_of(case)
    return with_constants(made, {part.name: constants[part.name] for part in parts})


def _depth(case: Case) -> float:
    """The depth of the point, by rotations of SciPy."""
    body, c, d = _body(case), constants_of(case), case.dimension
    R0 = frame_rotation(body).as_matrix()[:d, :d]
    y = local_coordinates(body)
    r = c["point"] + y @ c["Phi"] + [y @ c[name] @ y / 2 for name in BENT[:d]]
    origin = c["alphas"] @ body.q[:body.first_rotation].reshape(-1, d)
    turn = (Rotation.from_rotvec([0, 0, case.q[-1]]).as_matrix() if case.planar
            else case.R[-9:].reshape(3, 3))[:d, :d]
    s = (origin + R0 @ r - case.q[case.own:case.own + d]) @ turn
    if c["flat"] > 0:
        return float(c["radius"] - (c["e"] @ s - c["level"]))
    across = s - c["e"] * (c["e"] @ s)
    return float(c["radius"] - c["side"] * (np.linalg.norm(across) - c["size"]))


def _kept(case: Case, name: str) -> float:
    """A number that the kernel keeps of a state."""
    given = arguments(case)
    called(case, RESIDUAL, given)
    return float(given.frames[FRAME + case.module.MEMORY.index(name)])


def place(case: Case) -> float:
    """Depth against the definition."""
    return abs(_kept(case, "depth") / _depth(case) - 1)


def rate(case: Case) -> float:
    """Its rate against differences along a path."""
    exact = derivative(lambda t: _depth(along_path(case, t)), 0.002)
    return abs(_kept(case, "rate") / exact - 1)


CRITERIA = laws.CRITERIA | {"place of the point": place, "its rate": rate}


def _cases(module: ModuleType, seed: int, nodes: Nodes) -> dict[str, Case]:
    """In every branch on a surface of one kind; what is round in a plane is a circle."""
    surface, flat = SURFACES[seed % len(SURFACES)]
    case = body_contact_case(module, seed, nodes, flat)
    circle = {"e": np.zeros(2)} if case.planar and not flat else {}
    return {", ".join(filter(None, (surface, branch))): changed(one, **circle)
            for branch, one in laws.cases(module, case).items()}


def check_body_contact(name: str, module: ModuleType) -> list[CheckRow]:
    """All criteria, with some numbers of nodes and modes, on a plane or what is round."""
    return [CheckRow(name, f"{criterion}, {branch}", seed, measure(case), None, LIMIT, nodes)
            for nodes in nodes_of(module)[:KINDS] for seed in range(STATES)
            for branch, case in _cases(module, seed, nodes).items()
            for criterion, measure in CRITERIA.items()]
