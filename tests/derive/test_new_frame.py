"""The frame of the recipe in CONTRIBUTING.md: its motion in space follows from what it declares.

It is neither a mean nor a best fit. `test_recipes` adds it to a copy of the tree and looks at
fields and stresses in a plane.
"""

import numpy as np
import pytest
from plain_kernels import evaluated, executed
from recipes import recipe
from scipy.spatial.transform import Rotation

from sebody.contract.layout import MOTION, RESIDUAL
from sebody.derive.compiler import compile_kernel
from sebody.derive.kernels import motion, options
from sebody.verify.check.motions import motion_case
from sebody.verify.check.states import along_path, derivative
from sebody.verify.check.superelement_cases import Nodes


@pytest.fixture
def derived(monkeypatch):
    """The frame is one of the options."""
    names: dict = {}
    exec(recipe("A frame")[0].code, names)
    monkeypatch.setitem(options.FRAMES, "secant", names["FRAME"])
    monkeypatch.setitem(motion.MOTIONS, motion.motion_name("secant", False), ("secant", False))


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
