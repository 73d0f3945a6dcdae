"""Equal bodies that are evaluated eight at a time, against their own kernel one by one."""

import ctypes

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sebody import Model, Simulation, generalized_alpha, plane
from sebody.analysis import Ensemble, final, gradient, resume, save_state
from sebody.assembly import equal_bodies
from sebody.compiler.choice import why_no_lanes
from sebody.contract.equal_row import OWN
from sebody.contract.layout import ENERGIES, ENERGY, HALF_TURN, HEADER, RESIDUAL, TANGENT
from sebody.engine.state import Scheme
from sebody.fem import planar_beam
from sebody.kernels.abi import Arguments
from sebody.parameters.table import handle
from sebody.reduction import craig_bampton
from sebody.results.audit import momentum_defect
from sebody.runs.fingerprint import fingerprint
from sebody.scenes import chain
from sebody.scenes.chain import link_body

if why_no_lanes():
    pytest.skip(why_no_lanes(), allow_module_level=True)

TURN = Rotation.from_rotvec([0.4, -0.7, 0.3])
LINK = link_body(2)
MANY = 31
_WORD, _PLACE = ctypes.c_int64, ctypes.c_void_p


def orientation(k: int, turned: bool) -> Rotation:
    """Of link k of a chain: of all the same, or along a curve in space."""
    return TURN * Rotation.from_rotvec(turned * 0.02 * (k - 9) * np.array([0.3, 0.4, 1.0]))


def net(turned: bool, closed: bool = True) -> Model:
    """A chain in space of equal links, among them others, with a branch, springs and a contact.

    Its ends are held, so it is a closed loop, or it flies.
    """
    model, other = Model(), link_body(1, elements=4)
    model.gravity((0.0, -9.81, 2.0) if closed else (0.0, 0.0, 0.0))
    start = last = model.node("start", (0.1, 0.2, 0.3))
    for k in range(MANY + 6):       # three of them others
        axes = orientation(k, turned).as_matrix()
        sideways = axes @ np.array([[0, 0, -1], [0, 1, 0], [1, 0, 0]])
        other_one = k in (9, 10, 20)
        end = model.node(f"end {k}", last.point + axes[:, 2 if other_one else 0])
        nodes = [last, end]
        if k % 5 == 4 and not other_one:    # the other way round
            nodes, axes = nodes[::-1], axes @ np.diag([-1.0, -1.0, 1.0])
        model.superelement(f"link {k}", other if other_one else LINK, nodes,
                           rotation=sideways if other_one else axes)
        last = end
        if k < MANY + 5:
            last = model.node(f"begin {k}", end.point, at=end)
            model.revolute(end, TURN.apply([0.1, 0.2 * (-1) ** k, 1.0]), to=last)
    axes = orientation(3, turned).as_matrix()
    tip = model.node("tip of the branch", start.point + axes[:, 0])
    model.superelement("branch", LINK, [start, tip], rotation=axes)
    if closed:
        model.fix("start", "position")
        model.spherical(last)
        model.spring("end 12", "end 25", stiffness=200.0, damping=1.0)
        model.force("end 30", (1.0, 2.0, 3.0), [(0.0, 0.0), (0.05, 40.0)])
        model.contact("end 33", stiffness=1e4, exponent=1.5,
                      on=plane((0.0, 1.0, 0.0), model.nodes["end 33"].point - [0.0, 1e-3, 0.0]))
    return model


def run(model: Model, together: bool, until: float, scheme: Scheme | None = None) -> Simulation:
    simulation = Simulation(model, 0.005, scheme)
    if not together:
        equal_bodies.evaluate_alone(model, simulation.system)
    return simulation.run_to(until)


@pytest.mark.parametrize("turned", [False, True])
def test_a_loop_in_space_with_other_bodies_loads_and_contacts_moves_as_one_by_one(turned):
    """Newton's iteration ends at 1e-8 of the increments; up to there both differ by rounding."""
    model = net(turned)
    together, alone = (run(model, how, 0.1) for how in (True, False))
    assert together.system.address[0] != alone.system.address[0]
    assert together.system.count.max() > MANY
    one, other = together.result(), alone.result()
    assert one.iterations_per_step == pytest.approx(other.iterations_per_step, rel=0.02)
    for name in ("end 5", "end 33", "end 25", "tip of the branch"):
        for what in ("position", "velocity"):
            np.testing.assert_allclose(one[f"{name}.{what}"], other[f"{name}.{what}"], rtol=0,
                                       atol=1e-8 * np.abs(other[f"{name}.{what}"]).max())


def test_momenta_of_a_flying_chain_are_constant():
    """No force acts from outside: Newton's iteration leaves 1e-8 of the increments."""
    model = net(turned=True, closed=False)
    model.rigid_velocity(TURN.apply([0.5, 0.2, 0.1]), TURN.apply([0.02, 0.1, 0.3]))
    result = run(model, True, 0.1).result()
    for angular, name in ((False, "momentum"), (True, "moment")):
        defect, _ = momentum_defect(result, angular)
        size = np.abs(result.energies[:, ENERGIES.slices({"ports": 0})[name]]).max()
        assert size > 1.0 and np.abs(defect).max() < 1e-7 * size


class Call:
    """Calls of the kernels of a run's first batch, in a state of any numbers."""

    def __init__(self, turned: bool):
        simulation = Simulation(net(turned), 0.005)
        self.closely = 1e-12 if turned else 1e-13
        self.system, self.state = simulation.system, simulation.state
        rng = np.random.default_rng(5)
        for name, size in (("q", 0.01), ("v", 1.0), ("a", 10.0)):
            array = getattr(self.state, name)
            array += size * rng.normal(size=array.size)
        own = self.state.R.reshape(-1, 3, 3)
        own[:] = own @ Rotation.from_rotvec(0.2 * rng.normal(size=(len(own), 3))).as_matrix()
        self.state.T[:] += 0.1 * rng.normal(size=self.state.T.size)
        self.state.set_coefficients(c_mass=40.0, c_damping=3.0, c_stiffness=1.0, c_geo=1.0,
                                    c_constraint=1.0)
        self._frames = self.state.frames.copy()

    def __call__(self, together: bool, task: int, first: int, count: int):
        """Status, forces, matrices, frames and energies of some bodies."""
        system, state = self.system, self.state
        width, stride = int(system.width[0]), int(system.stride[0])
        index = system.index[first * stride:]
        state.frames[:], state.energy[:] = self._frames, 0.0
        forces, matrices = np.full((count, width), np.nan), np.zeros((count, width, width))
        given = Arguments(
            index=index, constants=system.constants, q=state.q, R=state.R, v=state.v, a=state.a,
            references=state.frames_old, frames=state.frames, T=state.T, loads=state.loads,
            coefficients=state.coefficients, forces=forces, matrices=matrices, work=state.work,
            energies=state.energy)
        address = int(system.address[0]) if together else int(index[stride - OWN])
        status = ctypes.CFUNCTYPE(_WORD, *[_WORD] * 4, *[_PLACE] * len(given))(address)(
            task, count, stride, width, *(array.ctypes.data for array in given))
        return status, forces, matrices, state.frames.copy(), state.energy.copy()


@pytest.fixture(scope="module", params=[False, True])
def call(request):
    return Call(request.param)


@pytest.mark.parametrize("first, count", [(0, 1), (3, 2), (1, 3), (5, 8), (2, 11), (0, MANY)])
def test_any_number_of_bodies_in_a_general_state(call, first, count):
    """Forces and frames to 1e-13 of the largest: products are rounded in another order.

    Constants of bodies that are turned were rotated: they are rounded more.
    """
    for task in (RESIDUAL, TANGENT, ENERGY):
        one, other = call(True, task, first, count), call(False, task, first, count)
        assert one[0] == other[0] == 0
        for found, expected in zip(one[1:], other[1:], strict=True):
            np.testing.assert_allclose(found, expected, rtol=0,
                                       atol=call.closely * max(np.abs(expected).max(), 1e-300))


def test_a_body_without_a_frame_is_told_as_by_its_own_kernel(call):
    """The node of one body is turned by half a revolution; bodies before it have their forces."""
    system, state = call.system, call.state
    row = system.index[20 * system.stride[0]:21 * system.stride[0]]
    end = state.R[9 * row[HEADER + 1]:][:9]
    kept = end.copy()
    end[:] = (Rotation.from_rotvec([np.pi, 0.0, 0.0]).as_matrix() @ kept.reshape(3, 3)).ravel()
    one, other = (call(how, RESIDUAL, 0, 30) for how in (True, False))
    end[:] = kept
    assert one[0] == other[0] == HALF_TURN
    np.testing.assert_allclose(one[1][:20], other[1][:20], rtol=0,
                               atol=call.closely * np.abs(other[1][:20]).max())


def test_who_is_evaluated_together(monkeypatch):
    """Enough equal bodies; not where vectors are missing; a model is the same in both."""
    enough = -(-equal_bodies.WORTH_IT // len(LINK.mass) ** 2)
    model = chain.build(links=enough, modes=2).model
    few = Simulation(chain.build(links=enough - 1, modes=2).model, 0.01)
    many = Simulation(model, 0.01)
    own, together = int(few.system.address[0]), int(many.system.address[0])
    assert own != together and many.system.stride[0] > few.system.stride[0]
    monkeypatch.setattr(equal_bodies, "why_no_lanes", lambda: "none here")
    scalar = Simulation(model, 0.01)
    assert scalar.system.address[0] == own
    assert scalar.state.work.size == many.state.work.size       # restart files fit both
    assert fingerprint(scalar) == fingerprint(many)


def arc(links: int = 12) -> Model:
    """Links in a plane, each oriented differently, and turned by more than half a revolution."""
    fe_model = planar_beam((0.0, 0.0), (0.6, 0.0), chain.SECTION, 6)
    body = craig_bampton(fe_model, [(0, "full"), (6, "full")], 4)
    model = Model(planar=True)
    model.gravity((1.0, -9.81))
    last = model.node("base", (0.2, -0.1))
    model.revolute(last)
    for k in range(links):
        angle = 2.0 + 0.35 * k
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        end = model.node("tip" if k == links - 1 else f"end {k}", last.point + 0.6 * turn[:, 0])
        model.superelement(f"link {k}", body, [last, end], rotation=turn)
        if k < links - 1:
            last = model.node(f"begin {k}", end.point, at=end)
            model.revolute(end, to=last)
    model.rigid_body("weight", "tip", 3.0, 0.1)
    return model


@pytest.fixture()
def small(monkeypatch):
    """Few bodies are enough."""
    monkeypatch.setattr(equal_bodies, "WORTH_IT", 1)


def tip(model: Model, values: dict[str, float], until: float,
        scheme: Scheme | None = None) -> np.ndarray:
    """Where the tip is, with other constants; links one by one."""
    handles = [handle(model, name) for name in values]
    for one, value in zip(handles, values.values(), strict=True):
        one.set(np.asarray(value, dtype=float))
    try:
        return run(model, False, until, scheme).result()["tip.position"][-1]
    finally:
        for one in handles:
            one.reset()


def test_an_arc_in_a_plane_moves_as_one_by_one_and_keeps_its_energy(small, tmp_path):
    """A run that was saved goes on with the same bits; energy is kept to the order of the step."""
    together, alone = (Simulation(arc(), 0.005, generalized_alpha(1.0)) for _ in range(2))
    equal_bodies.evaluate_alone(alone.model, alone.system)
    assert together.system.count.max() == 12
    assert together.system.address[0] != alone.system.address[0]
    path = save_state(together.run_to(0.1), tmp_path / "half.npz")
    result, other = together.run_to(0.2).result(), alone.run_to(0.2).result()
    np.testing.assert_array_equal(resume(arc(), path).run_to(0.2).state.q, together.state.q)
    np.testing.assert_allclose(result["tip.position"], other["tip.position"], rtol=0, atol=1e-9)
    assert result.energy_balance() == pytest.approx(other.energy_balance(), rel=1e-3)
    assert result.energy_balance() < 1e-4       # 2.2e-5


def test_constants_that_vary_are_those_of_every_link(small):
    """One link is made softer: it is another body then, in ensembles and in gradients."""
    model = arc()
    soft = np.array([0.3, 1.0, 2.5])
    found = Ensemble(model, 0.005).run({"link 3.stiffness": soft}, 0.1,
                                       {"tip": final("tip.position")})["tip"]
    for value, one in zip(soft, found, strict=True):
        np.testing.assert_allclose(one, tip(model, {"link 3.stiffness": value}, 0.1), atol=1e-9)


def test_gradients_are_differences_of_runs_one_by_one(small):
    """Differences are good to the runs' tolerance over their size, 1e-7, and its square."""
    model, size, scheme = arc(), 1e-3, generalized_alpha(0.9, tolerance=1e-10)
    found = gradient(model, 0.005, 0.15, {"tip": final("tip.position")},
                     ["link 3.mass", "weight.mass"], scheme=scheme)
    for name in ("link 3.mass", "weight.mass"):         # factors
        up, down = (tip(model, {name: 1.0 + change}, 0.15, scheme) for change in (size, -size))
        expected = (up - down) / (2 * size)
        np.testing.assert_allclose(found.of("tip", name).ravel(), expected, rtol=0,
                                   atol=1e-5 * np.abs(expected).max())
