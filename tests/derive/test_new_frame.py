"""A frame made here, neither a mean nor a best fit: all else follows from what it declares.

In a plane the secant frame keeps ``sum w_j X_j u_j = 0`` with components X along x and u along y: a
weighted sum of the nodes stays at its height over the x axis of the frame. In space two such sums
keep their direction and the plane they are in, as do the vectors of an attitude by two stars.
"""

import numpy as np
import pytest
import sympy as sp
from plain_kernels import evaluated, executed
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation
from sebody.contract.layout import MOTION, RESIDUAL, FrameTraits
from sebody.derive.compiler import Variant, compile_kernel, file_name
from sebody.derive.form.counts import FIRST_ROTATION, ROTATIONS
from sebody.derive.form.functions import RELATIVE_ANGLES, RELATIVE_ROTATIONS
from sebody.derive.form.steps import Solve, Stage, Sum, search
from sebody.derive.formulas import arrays
from sebody.derive.formulas.elastic import conjugate_to, virtual_work
from sebody.derive.formulas.frames.frame import (
    Condition,
    Frame,
    FrameOption,
    inverse_tangent_values,
    kept_rotation,
    origin_stage,
    pulled_back,
)
from sebody.derive.kernels import motion, options
from sebody.derive.printing.numba.options import options_text
from sebody.derive.symbolic.rotations import cross
from sebody.fem import Section, planar_beam
from sebody.generated import options as generated
from sebody.model import frames
from sebody.reduction import craig_bampton
from sebody.verify.check.motions import motion_case
from sebody.verify.check.states import along_path, derivative
from sebody.verify.check.superelements import Nodes

NAME = "secant"


def unit(a):
    return a / sp.sqrt(a.dot(a))


def weight(q):
    """What the displacement of a node has in the condition, by rows."""
    w, X = q.fit.symbols[0], q.X.symbols
    if q.space.planar:
        return sp.Matrix([[0, 0, 0], [0, 0, 0], [0, w * X[0], 0]])
    T2, T3 = (q.space.quantity(name, "vector", "element").symbols for name in ("T2", "T3"))
    return sp.Matrix.vstack(w * X[0] * T2.T, w * X[0] * T3.T, w * X[1] * T3.T)


def located(q):
    """The rotation in closed form, from sums over the nodes."""
    w, X, gap = q.fit.symbols[0], q.X.symbols, q.x.symbols - q.x0.symbols

    def of(name, kind="vector"):
        return q.space.quantity(name, kind, "element")
    if q.space.planar:
        height, d = of("height", "scalar"), of("along")
        (x, y, _), h = d.symbols, height.symbols[0]
        size = sp.sqrt(x**2 + y**2)
        s, c = h / size, sp.sqrt(1 - (h / size)**2)
        cos, sin = (x * c + y * s) / size, (y * c - x * s) / size
        return (Stage("sums of the nodes", "position", adds=(
                    (d, w * X[0] * gap), (height, sp.Matrix([w * X[0] * X[1]])))),
                Stage("rotation of the frame", "element", sets=((q.R0, sp.Matrix(
                    [[cos, -sin, 0], [sin, cos, 0], [0, 0, 1]])),)))
    D1, D2, d1, d2, T1, T2, T3, t1, t2, t3 = map(of, (
        "D1", "D2", "d1", "d2", "T1", "T2", "T3", "t1", "t2", "t3"))
    steps = [Stage("sums of the nodes", "position", adds=(
        (D1, w * X[0] * X), (D2, w * X[1] * X), (d1, w * X[0] * gap), (d2, w * X[1] * gap)))]
    for one, other, first, second, third in ((D1, D2, T1, T2, T3), (d1, d2, t1, t2, t3)):
        a, b = one.symbols, other.symbols
        steps += [Stage("axis along a sum", "element", sets=((first, unit(a)),)),
                  Stage("normal to both", "element", sets=((third, unit(cross(a, b))),)),
                  Stage("in their plane", "element",
                        sets=((second, cross(third.symbols, first.symbols)),))]
    pairs = (t1, T1), (t2, T2), (t3, T3)
    turned = sum((t.symbols * T.symbols.T for t, T in pairs), sp.zeros(3, 3))
    return (*steps, Stage("rotation of the frame", "element", sets=((q.R0, turned),)))


def secant(q):
    """The frame: its variation is that of its condition."""
    matrix, r = weight(q), q.X.symbols + q.u.symbols

    def equation(rate, of, origin):
        return matrix * (of.symbols - origin.symbols + cross(r, rate.symbols))

    def solved(rate, of, origin, invert):
        return Solve("weighted rates", rate, (Sum("position", equation(rate, of, origin)),),
                     sp.zeros(3, 1), "B", invert=invert)
    back = equation(q.wp, q.dx, q.dx0)
    own = sp.Matrix.hstack(*[back.diff(s) if isinstance(s, sp.Symbol) else sp.zeros(3, 1)
                             for s in q.wp.symbols])
    work, psi = q.wp.symbols.dot(equation(q.dth0, q.dx, q.dx0)), arrays.y.at(FIRST_ROTATION)
    angles = ((RELATIVE_ANGLES, ROTATIONS, arrays.qe.at(FIRST_ROTATION)) if q.space.planar else
              (RELATIVE_ROTATIONS, ROTATIONS, arrays.nodes, arrays.R))
    return Frame(
        locate=(*located(q), kept_rotation(q),
                search("elastic rotations", *angles, arrays.frame, psi, operations=60),
                *inverse_tangent_values(q, q.psi, (q.e0, q.e1))),
        velocity=(origin_stage(q, q.v0, q.vs), solved(q.Om0, q.vs, q.v0, True)),
        variation=(solved(q.dth0, q.dx, q.dx0, False),),
        pull=(pulled_back(q, (Sum("position", own.T * q.wp.symbols),),
                          (Sum("position", back),)),),
        work=virtual_work, position=-conjugate_to(work, q.dx.symbols),
        origin=-conjugate_to(work, q.dx0.symbols), rotation=sp.zeros(3, 1),
        conditions=(condition(q),))


def condition(q):
    return Condition(q.u, weight(q), (q.fit, q.X))


SECANT = FrameOption(FrameTraits("secant frame", needs_rotations=False, fewest_positions=(3, 2)),
                     secant, condition)


@pytest.fixture
def derived(monkeypatch):
    """The frame is one of the options."""
    monkeypatch.setitem(options.FRAMES, NAME, SECANT)
    for planar in (False, True):
        name = motion.motion_name(NAME, planar)
        monkeypatch.setitem(motion.MOTIONS, name, (NAME, planar))


@pytest.fixture
def known(derived, monkeypatch, tmp_path):
    """Its kernels and traits are where a derivation puts them: nothing else is told of it."""
    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path))
    for kernel in (Variant("planar-any", NAME, "c"), "motion_planar_secant"):
        (tmp_path / file_name(kernel)).write_text(compile_kernel(kernel, shipped=False))
    scope = {}
    exec(options_text({NAME: SECANT.traits}, {}, {
        key: value for key, value in options.frame_conditions().items() if key == (NAME, True)}),
        scope)
    monkeypatch.setitem(generated.CONDITIONS, (NAME, True), scope["CONDITIONS"][NAME, True])
    monkeypatch.setitem(frames.FRAMES, NAME, frames.Frame(NAME, scope["FRAMES"][NAME]))


def swung(frame, load):
    """A beam of three nodes, hinged at one end, in general position."""
    section = Section(area=0.01, inertia_y=1e-5, inertia_z=1e-5, torsion=1e-5,
                      youngs_modulus=1e9, poisson_ratio=0.3, density=1000.0)
    fe = planar_beam((0.3, -0.2), (2.1, 1.3), section, 12)
    body = craig_bampton(fe, [(0, "full"), (5, "full"), (12, "full")], 2)
    model = Model(planar=True)
    model.gravity((load, -9.81 * load))
    nodes = [model.node(f"n{k}", fe.coordinates[k, :2]) for k in (0, 5, 12)]
    model.superelement("beam", body, nodes, frame=frame)
    model.revolute(nodes[0])
    model.force(nodes[2], (300.0 * load, -200.0 * load))
    return Simulation(model, 0.002).run_to(0.3).result()


def apart(load):
    """How far fields in the frame are from those in another one, and the largest of these."""
    ours, other = swung(NAME, load), swung("converged_mean", load)
    mine, theirs = ours.field("beam"), other.field("beam")
    found = {}
    for step in range(0, len(ours.t), 5):
        for k in (0, 5, 12):        # nodes of the boundary are where the run has them
            for name in ("position", "velocity"):
                assert getattr(mine, name)(step)[k] == pytest.approx(
                    ours[f"n{k}.{name}"][step], abs=1e-11)
        for name in ("position", "velocity", "acceleration", "section_forces"):
            a, b = (getattr(field, name)(step) for field in (mine, theirs))
            found.setdefault(name, []).append((np.abs(a - b).max(), np.abs(b).max()))
    return {name: np.max(pairs, axis=0) for name, pairs in found.items()}


def test_motion_fields_and_stresses_in_a_plane(known):
    """They differ from those in another frame by terms of second order in the deformation.

    By a few per cent of the largest, as modes that follow loads move with a frame on positions.
    """
    small, large = apart(0.1), apart(0.4)
    for name, (difference, size) in large.items():
        assert 13.0 < difference / small[name][0] < 20.0        # 16, and terms of third order
        assert difference < 0.06 * size


def definition(case):
    """Place and rotation of the frame in space, and local coordinates, by NumPy."""
    x, X = (a.reshape(case.n_positions, 3) for a in (
        case.q[:case.first_rotation], motion_constants(case)["X"]))
    alpha, w = (motion_constants(case)[name] for name in ("alphas", "fits"))
    origin = alpha @ x

    def axes(points):
        a, b = (w * X[:, 0]) @ points, (w * X[:, 1]) @ points
        first, third = a / np.linalg.norm(a), np.cross(a, b) / np.linalg.norm(np.cross(a, b))
        return np.array([first, np.cross(third, first), third])
    R0 = axes(x - origin).T @ axes(X)
    psi = Rotation.from_matrix(R0.T @ case.R.reshape(-1, 3, 3)).as_rotvec()
    return origin, R0, np.r_[((x - origin) @ R0 - X).ravel(), psi.ravel(),
                             case.q[case.first_mode:]]


def motion_constants(case):
    return case.row.unpack(case.counts, case.constants)


def test_motion_in_space(derived):
    """As plain Python, against the definition and differences of it."""
    plain = executed(compile_kernel("motion_secant"))
    slices = MOTION.slices
    for seed in (0, 1):
        case = motion_case(plain, seed, Nodes(4, 2, 1))

        def written(t, case=case):
            moved = along_path(case, t)
            done = evaluated(moved, RESIDUAL, forces=np.zeros(MOTION.size(case.counts)))
            return {name: done.forces[at] for name, at in slices(case.counts).items()}
        found, (origin, R0, y) = written(0.0), definition(case)
        assert found["rotation"] == pytest.approx(R0.ravel(), abs=1e-12)
        assert found["y"] == pytest.approx(y, abs=1e-12)
        assert found["origin"] == pytest.approx(origin, abs=1e-12)

        def rate(of, case=case):
            return derivative(lambda t: of(definition(along_path(case, t))), 0.003)
        turned = R0.T @ rate(lambda d: d[1])
        assert found["spin"] == pytest.approx(
            [turned[2, 1], turned[0, 2], turned[1, 0]], abs=1e-9)
        assert found["y_rate"] == pytest.approx(rate(lambda d: d[2]), abs=1e-9)
        assert found["velocity"] == pytest.approx(R0.T @ rate(lambda d: d[0]), abs=1e-9)
        for name, of in (("y_second", "y_rate"), ("spin_rate", "spin")):
            exact = derivative(lambda t, of=of: written(t)[of], 0.003)  # noqa: B023
            assert found[name] == pytest.approx(exact, abs=1e-9)
