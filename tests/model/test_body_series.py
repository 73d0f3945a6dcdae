"""Series of loads: against linear equations, against single loads, in lanes and gradients."""

import numpy as np
import pytest
from helpers import order
from lane_models import single
from numpy.testing import assert_allclose
from scipy.signal import lsim
from scipy.spatial.transform import Rotation

from sebody import (
    InputError,
    LimitWarning,
    Model,
    Result,
    Simulation,
    Tolerance,
    analysis as an,
    generalized_alpha,
    simulate,
)
from sebody.analysis import equilibrium, frequency_response, gradient, resume, save_state
from sebody.fem import Section, rectangle, straight_beam
from sebody.fem.loads import line_load
from sebody.io import LoadSeries
from sebody.model.histories import spline_of
from sebody.model.variants import keep_modes, planar, rigid
from sebody.reduction import craig_bampton
from sebody.verify.outside.jacket import MODES, jacket, loads, matrices

TURN = Rotation.from_rotvec((0.4, -0.7, 0.5)).as_matrix()
SECTION = Section(4e-4, 3e-8, 1e-8, 2e-8, 7e10, 0.3, 2700.0)
NAMES = ("tip.x", "root.ry", "mode 1", "wind")


def coordinates(result):
    """Displacements of the interface and modes of the jacket, without rotations."""
    place = result["interface.position"]
    return np.hstack([place - place[0], result["jacket.modes"]])


def states(step, rows):
    """The same of the linear equations under piecewise linear loads, exact."""
    M, K, C = matrices()
    A = np.block([[np.zeros((31, 31)), np.eye(31)],
                  [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    B = np.vstack([np.zeros((31, 31)), np.linalg.inv(M)])
    t = step * np.arange(len(rows))
    _, y, _ = lsim((A, B, np.eye(62), np.zeros((62, 31))), rows, t)
    return y[:, [0, 1, 2, *range(6, 31)]]


def by_numpy(rows, h, rho=0.9):
    """Generalized-alpha on the matrices of the jacket."""
    M, K, C = matrices()
    am, af = (2 * rho - 1) / (rho + 1), rho / (rho + 1)
    g = 0.5 + af - am
    b = 0.25 * (g + 0.5)**2
    q, v, a = np.zeros(31), np.zeros(31), np.linalg.solve(M, rows[0])
    S, found = np.linalg.inv((1 - am) * M + (1 - af) * (h * g * C + h * h * b * K)), [q]
    for before, after in zip(rows, rows[1:], strict=False):
        q_, v_ = q + h * v + h * h * (0.5 - b) * a, v + h * (1 - g) * a
        new = S @ ((1 - af) * after + af * before - am * M @ a - C @ ((1 - af) * v_ + af * v)
                   - K @ ((1 - af) * q_ + af * q))
        q, v, a = q_ + h * h * b * new, v_ + h * g * new, new
        found.append(q)
    return np.array(found)[:, [0, 1, 2, *range(6, 31)]]


def test_all_series_of_the_jacket_by_the_same_scheme():
    """At small loads, as products of rotations make a difference in proportion to these."""
    h, errors = 0.01, []
    for size in (1e-2, 1e-3):
        model, series = jacket(), loads(end=5.0, size=size)
        model.body_series("jacket", series)
        result = simulate(model, h, 5.0, generalized_alpha(0.9, tolerance=1e-12))
        exact, found = by_numpy(series.at(result.t), h), coordinates(result)
        errors.append([np.abs(found[:, k] - exact[:, k]).max() / np.abs(exact[:, k]).max()
                       for k in (slice(0, 3), slice(3, None))])
    (places, amplitudes), (near_places, near_amplitudes) = errors
    assert near_places < 1e-7 and near_amplitudes < 2e-6
    assert near_places < places / 8 and near_amplitudes < amplitudes / 8


def test_smooth_series_are_of_second_order_against_exact_solutions():
    rows = 0.02
    series = loads(step=rows, end=4.0, size=0.01, smooth=True)
    exact, steps, errors = states(rows, series.values), (0.02, 0.01, 0.005), []
    for h in steps:
        model = jacket()
        model.body_series("jacket", series)
        found = coordinates(simulate(model, h, 4.0))[::round(rows / h)]
        errors.append(np.abs((found - exact)[:, :3]).max() / np.abs(exact[:, :3]).max())
    assert order(steps, errors) > 1.8 and errors[-1] < 1e-3


def flying(load=None):
    """A turned damped beam with loads of its own and a heavier end, free in space."""
    fe = straight_beam((1, 2, 3), (1, 2, 3) + TURN @ (1.0, 0, 0), SECTION, 8)
    wind = line_load(fe, TURN @ (0.0, 5.0, 1.0))
    body = craig_bampton(fe, [(0, "full"), (8, "full")], 2, loads={"wind": wind}).damped(0.02)
    model = Model()
    nodes = [model.node(name, point) for name, point in zip(("root", "tip"), body.coordinates,
                                                            strict=True)]
    model.superelement("beam", body, nodes)
    model.rigid_body("weight", nodes[0], 2.0, (0.01, 0.02, 0.02))
    model.rigid_velocity((0, 0, 0), (0.5, 1.0, -2.0))
    if load:
        load(model, body)
    return model


def table(interpolation="linear"):
    """Some columns, with a jump."""
    t = np.array([0.0, 0.03, 0.08, 0.1, 0.1, 0.17, 0.25])
    values = np.random.default_rng(2).normal(size=(7, 4)) * (30.0, 2.0, 4.0, 1.0)
    if interpolation == "cubic":
        t, values = np.delete(t, 4), np.delete(values, 4, axis=0)
    return LoadSeries(t, values, NAMES, interpolation)


def vectors(body):
    """What the columns of `table` act on."""
    n = len(body.mass)
    return np.array([np.eye(n)[3], np.eye(n)[7], np.eye(n)[13], body.loads["wind"]])


def apart(series, courses):
    """How `flying` adds the columns as single loads."""
    def load(model, body):
        body.loads.update({f"column {k}": v for k, v in enumerate(vectors(body))})
        for k, course in enumerate(courses):
            model.body_load("beam", f"column {k}", course)
    return load


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_a_series_is_the_sum_of_its_columns(interpolation):
    """On a body that turns: motion, power and work, with fixed and variable steps."""
    series = table(interpolation)
    if interpolation == "linear":
        courses = [np.column_stack([series.t, column]) for column in series.values.T]
    else:
        from scipy.interpolate import CubicSpline
        ends = CubicSpline(series.t, series.values)
        courses = [spline_of(series.t, column, (ends(0.0, 1)[k], ends(0.25, 1)[k]))
                   for k, column in enumerate(series.values.T)]
    one = flying(lambda m, b: m.body_series("beam", series, name="all"))
    many = flying(apart(series, courses))
    # variable steps do not end at the same times, as rows of a spline are no corners
    fixed, variable = {"scheme": generalized_alpha(0.9, tolerance=1e-12)}, {
        "tolerance": Tolerance(1e-7)}
    for how, near in ((fixed, 1e-9), (variable, 1e-3 if interpolation == "cubic" else 1e-7)):
        found, exact = (simulate(model, 0.005, 0.3, **how) for model in (one, many))
        for name in ("tip.position", "root.angular_velocity", "beam.modes"):
            assert_allclose(found[name], exact[name], rtol=0,
                            atol=near * np.abs(exact[name]).max())
        works = sum(exact[f"column {k} on beam.work"] for k in range(4))
        assert_allclose(found["all.work"], works, rtol=0, atol=near * np.abs(works).max())
    assert np.abs(found["all.work"]).max() > 0.1


def test_amplitudes_columns_by_other_names_and_part_of_a_body():
    series = table().chosen(["tip.x", "mode 1"])
    renamed = LoadSeries(series.t, series.values, ("wave", "swell"))
    plain = flying(lambda m, b: m.body_series("beam", series.scaled(2.0)))
    named = flying(lambda m, b: m.body_series(
        "beam", renamed, 2.0, columns={"wave": "tip.x", "swell": "mode 1"}, name="sea"))
    one, two = (simulate(m, 0.005, 0.3)["tip.position"] for m in (plain, named))
    assert_allclose(one, two, rtol=0, atol=1e-12)
    fading = flying(lambda m, b: m.body_series("beam", renamed, lambda t: 2.0 - 0.0 * t,
                                               {"wave": "tip.x", "swell": "mode 1"}))
    assert_allclose(simulate(fading, 0.005, 0.3)["tip.position"], one, rtol=0, atol=1e-12)


def test_lanes_gradients_and_files(tmp_path):
    def load(model, body):
        model.body_series("beam", table(), name="sea")
    model, values = flying(load), {"sea.amplitude": np.linspace(0.5, 1.5, 9),
                                   "weight.mass": np.linspace(1.0, 3.0, 9)}
    found = an.Ensemble(model, 0.005).run(values, 0.3, {"x": an.final("tip.position")})
    for k in (0, 4, 8):
        one = single(model, {name: v[k] for name, v in values.items()}, 0.005, 0.3)
        assert_allclose(found["x"][k], one["tip.position"][-1], rtol=0, atol=1e-9)
    made = gradient(model, 0.005, 0.3, {"x": an.final("tip.position")}, ["sea.amplitude"])
    scheme = generalized_alpha(0.9, tolerance=1e-12)
    ends = [single(model, {"sea.amplitude": 1.0 + d}, 0.005, 0.3, scheme)["tip.position"][-1]
            for d in (-1e-3, 1e-3)]
    assert_allclose(made.matrix[:, 0], (ends[1] - ends[0]) / 2e-3, rtol=1e-5, atol=1e-8)
    run = Simulation(model, 0.005)
    run.run_to(0.15)
    save_state(run, tmp_path / "state.npz")
    whole = run.run_to(0.3).result()
    again = resume(model, tmp_path / "state.npz").run_to(0.3).result()
    assert again["tip.position"][-1].tobytes() == whole["tip.position"][-1].tobytes()
    read = Result.load(whole.save(tmp_path / "run.npz"))
    assert_allclose(read["sea.work"], whole["sea.work"], rtol=1e-12)
    other = flying(lambda m, b: m.body_series("beam", table().scaled(1.1), name="sea"))
    with pytest.raises(InputError, match="another model"):
        resume(other, tmp_path / "state.npz")


def test_variants_and_what_is_refused():
    model = flying(lambda m, b: m.body_series("beam", table(), name="sea"))
    fewer = keep_modes(model, "beam", 1).model
    assert np.shape(fewer.element("sea").constants["columns"]) == (13, 4)
    assert not fewer.element("sea").constants["columns"][:, 2].any()    # mode 1 is gone
    simulate(fewer, 0.005, 0.05)
    for change in (lambda: rigid(model, "beam"), lambda: planar(model),
                   lambda: frequency_response(equilibrium(jacket_with_series(), 1),
                                              "sea", ["interface.position"], [1.0])):
        with pytest.raises(InputError):
            change()
    with pytest.raises(InputError, match="whose columns have no amplitude in common"):
        frequency_response(equilibrium(jacket_with_series(), 1), "sea", ["interface.position"],
                           [1.0])
    with pytest.raises(InputError, match=r"nothing that column 'hat.x' acts on: columns are called "
                                         r"'root.x', 'root.rx', 'mode 1', 'wind'"):
        flying(lambda m, b: m.body_series("beam", LoadSeries([0.0], [[1.0]], ["hat.x"])))


def jacket_with_series():
    """Under loads that are constant."""
    model = jacket()
    model.body_series("jacket", LoadSeries([0.0], [[1e4]], ["x"]), name="sea")
    return model


def test_equilibria_and_a_missed_peak():
    model = jacket()
    model.body_series("jacket", LoadSeries([0.0], [[1e6, 3.0]], ["x", f"mode {MODES - 1}"]))
    result = equilibrium(model, 1)
    assert result["interface.position"][-1][0] == pytest.approx(0.0285365425, abs=5e-11)
    assert result["jacket.modes"][-1][-1] == pytest.approx(3.0 / 7976.34193, rel=1e-9)
    peak = LoadSeries([0.0, 0.11, 0.18, 0.24, 1.0], np.c_[np.zeros(5), [0, 0, 1e5, 0, 0]],
                      ["x", "y"])
    model = jacket()
    model.body_series("jacket", peak, name="sea")
    with pytest.warns(LimitWarning, match="column y of sea is 1e\\+05 at t = 0.18, between two"):
        simulate(model, 0.05, 0.5)


def test_the_impulse_of_close_rows_is_kept():
    """Of a blow within a step, as that of single loads, which tests of tables compare."""
    t, blow = [0.0, 0.111, 0.112, 0.113, 1.0], np.array([0.0, 0.0, 1e3, 0.0, 0.0])
    series = LoadSeries(t, np.outer(blow, (1.0, 0.02, 0.1, 0.05)), NAMES)
    courses = [np.column_stack([t, column]) for column in series.values.T]
    scheme = generalized_alpha(0.9, tolerance=1e-12)
    found, exact, still = (simulate(flying(load), 0.005, 0.2, scheme) for load in (
        lambda m, b: m.body_series("beam", series), apart(series, courses), None))
    for name in ("momentum", "beam.modes"):
        assert_allclose(found[name], exact[name], rtol=0, atol=1e-9 * np.abs(exact[name]).max())
    # vibrations of the blow are not resolved: 4 %, of steps a tenth as long 3e-4
    change = np.linalg.norm(found["momentum"][-1] - still["momentum"][-1])
    assert change == pytest.approx(np.linalg.norm([1, 0, 0] + 0.05 * TURN @ (0, 5, 1)), rel=0.05)


@pytest.mark.parametrize("bodies, elements", [(1, 12), (3, 12), (12, 12)])
@pytest.mark.parametrize("flat", [False, True])
def test_a_beam_under_a_force_that_grows_along_it(bodies, elements, flat):
    """``w(L) = 11 q L^4 / (120 E I)`` of the triangle from 0 at the clamp to q."""
    section, length, q = rectangle(0.02, 0.01, 7e10, 0.3, 2700.0), 2.0, 1.5
    along, across = ((np.array([0.6, 0.8]), np.array([-0.8, 0.6])) if flat else
                     (TURN[:, 0], TURN[:, 1]))
    model = Model(planar=flat)
    start = np.array([0.3, -0.2, 0.5])[:len(along)]
    root, tip = model.node("root", start), model.node("tip", start + length * along)
    up = {} if flat else {"up": TURN[:, 1]}
    model.beam("mast", (root, tip), section, elements, bodies, 0 if bodies == elements else 2, **up)
    model.fix(root)
    series = LoadSeries([0.0], [[0.0, 0.3 * q, q]], ["foot", "middle", "head"])
    made = model.beam_series("mast", series, [0.0, 0.3 * length, length], across)
    assert len(made) == bodies
    found = equilibrium(model, 1)["tip.position"][-1] - tip.point
    inertia = section.inertia_z
    assert found @ across == pytest.approx(11 * q * length**4 / (120 * 7e10 * inertia), rel=2e-3)
