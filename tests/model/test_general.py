"""General kernels, for any nodes: the specialised ones' numbers, and models of their own."""

import numpy as np
import pytest

from sebody import InputError, Model, generalized_alpha, simulate
from sebody.assembly.batches import make_batches
from sebody.assembly.build import work_size
from sebody.assembly.numbering import number
from sebody.contract.layout import ENERGY, RESIDUAL, TANGENT
from sebody.contract.names import ANY, general_layout, layout_variant, superelement_name
from sebody.derive.kernels.manifest import SUPERELEMENTS
from sebody.fem import frame as fe_frame, planar_beam, straight_beam
from sebody.kernels.loader import load
from sebody.model.frames import FRAMES
from sebody.reduction import craig_bampton
from sebody.scenes.hinged_beam import SECTION
from sebody.verify.check import states
from sebody.verify.check.superelement_cases import superelement_case

GENERAL = [row for row in SUPERELEMENTS if ANY in row[0]]


def general(layout):
    """The general layout for another one, damped or not."""
    return layout_variant(general_layout(layout), damped=layout.endswith("d"))


SPECIAL = [row for row in SUPERELEMENTS if row not in GENERAL
           and (general(row[0]), *row[1:]) in GENERAL]
CONSERVING = generalized_alpha(rho=1.0, tolerance=1e-10)
GRAVITY = (0.0, -40.0, 0.0)


def test_what_is_shipped():
    assert len(GENERAL) == 20 and len(SPECIAL) == 19


@pytest.mark.parametrize("layout, floating, inertia", SPECIAL, ids=lambda x: x)
def test_general_kernel_equals_the_specialised_one(layout, floating, inertia):
    special, any_nodes = (load(superelement_name(name, floating, inertia))
                          for name in (layout, general(layout)))
    case = superelement_case(special, 3, gravity=1.0, damping=0.1 * layout.endswith("d"))
    for task in (RESIDUAL, TANGENT, ENERGY):
        coefficients = (1.0, 0.3, 2.0, 1, 1)
        for one, same in zip(*(states.evaluate(c, task, coefficients)
                               for c in (case, case._replace(module=any_nodes))), strict=True):
            # the same sums; products may enter them with one rounding or two
            assert states.difference(same, one) <= 1e-13


def test_general_kernels_have_no_counts():
    for row in GENERAL:
        kernel = load(superelement_name(*row))
        assert {kernel.N_POSITIONS, kernel.N_ROTATIONS, kernel.ROTATIONS, kernel.MODES,
                kernel.N_MODES, getattr(kernel, "SECOND_ORDER", None)} == {None}


def reduced(keeps, modes, fe_model):
    """A beam of 12 elements, reduced to nodes along it."""
    places = np.linspace(0, 12, len(keeps)).round().astype(int)
    return craig_bampton(fe_model, list(zip(map(int, places), keeps, strict=True)), modes)


def place(model, name, body, along, **options):
    """A reduced body on nodes of its own; the first is hinged to the ground."""
    nodes = [model.node(f"{name}{k}", point, keep) for k, (point, keep) in enumerate(
        zip(body.coordinates + along, body.keeps, strict=True))]
    model.superelement(name, body, nodes, **options)
    model.fix(nodes[0], "position")
    return nodes


def beam(keeps, modes=2):
    return reduced(keeps, modes, straight_beam((0, 0, 0), (100, 0, 0), SECTION, 12))


def balance(model, t_end=2.0):
    """Drift of the energy while the bodies fall on their hinges, of steps h and h/2."""
    return [simulate(model(), h, t_end, CONSERVING).energy_balance() for h in (0.02, 0.01)]


def spatial():
    """f5, f1t2r1 without modes, t5 with the frame of best fit, f1."""
    model = Model()
    model.gravity(GRAVITY)
    place(model, "long", beam(["full"] * 5), (0, 0, 0))
    place(model, "mixed", beam(["full", "translation", "translation", "rotation"], 0), (0, 0, 50))
    corners = np.array([[0, 0, 0], [60, 0, 0], [60, 40, 0], [0, 40, 0], [30, 20, 30.0]])
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), *((k, 4) for k in range(4))]
    roof = craig_bampton(fe_frame(corners, edges, SECTION, 3),
                         [(k, "translation") for k in range(5)], 2)
    place(model, "roof", roof, (0, 0, 100), frame="positions")
    return model


def planar():
    """planar-f4 and planar-t2r1."""
    model = Model(planar=True)
    model.gravity(GRAVITY[:2])
    line = planar_beam((0, 0), (100, 0), SECTION, 12)
    place(model, "long", reduced(["full"] * 4, 2, line), (0, 0))
    place(model, "mixed", reduced(["translation", "rotation", "translation"], 0, line), (0, 50))
    return model


@pytest.mark.parametrize("model, kernels", [
    (spatial, ["any_converged_mean", "any_converged_mean", "any_positions"]),
    (planar, ["planar_any_converged_mean"] * 2)])
def test_any_layout_runs_and_keeps_its_energy(model, kernels):
    assert [b.kernel for b in model().bodies.values()] == [f"superelement_{k}_floating_field"
                                                           for k in kernels]
    coarse, fine = balance(model)
    assert fine < 1e-4 and fine < coarse / 3.5      # of second order in the step


def test_a_summary_says_once_where_a_kernel_of_its_own_would_pay():
    """Small bodies gain by constants; a large one does not, nor one whose kernel has them."""
    model = planar()
    line = planar_beam((0, 0), (100, 0), SECTION, 12)
    for k, keeps in enumerate((["full"] * 4, ["full"] * 9, ["full"] * 2)):
        place(model, f"more{k} ", reduced(keeps, 2, line), (0, 100 + 50 * k))
    lines = simulate(model, 0.01, 0.02).summary().splitlines()
    counts = [(len(body.invariants.Q), len(body.invariants.lam))
              for body in (model.bodies["long"], model.bodies["mixed"])]
    assert [line for line in lines if line.startswith("general kernel")] == [
        f"general kernel       used for {bodies}: for a faster, specific kernel run python -m "
        f"sebody.derive {variant}s{slaved}e{resultants}:converged_mean:floating_field"
        for (bodies, variant), (slaved, resultants) in zip((
            ("long, more0 ", "planar-f4m2"), ("mixed", "planar-t2r1m0")), counts, strict=True)]


def test_bodies_of_equal_width_and_other_counts_have_batches_of_their_own():
    """planar-f3t2 and planar-f4r1 with a mode have 14 and 14 unknowns, f2t3 with two as well."""
    model = Model(planar=True)
    line = planar_beam((0, 0), (100, 0), SECTION, 12)
    bodies = {"a": ["full"] * 3 + ["translation"] * 2, "b": ["full"] * 4 + ["rotation"],
              "c": ["full"] * 4 + ["rotation"], "d": ["full"] * 2 + ["translation"] * 3}
    for k, (name, keeps) in enumerate(bodies.items()):
        modes = 14 - sum({"full": 3, "translation": 2, "rotation": 1}[keep] for keep in keeps)
        place(model, name, reduced(keeps, modes, line), (0, 50 * k))
    batches = make_batches(model, number(model))
    found = [(b.width, len(b.rows)) for b in batches.all[:batches.first_joint]]
    assert found == [(14, 1), (14, 2), (14, 1)]
    assert all(len({len(row) for row in b.rows}) == 1 for b in batches.all)


def test_scratch_memory_is_that_of_the_nodes():
    """Rows hold nine numbers for each rotation where that is more than the unknowns: 45, not 32."""
    model = Model()
    place(model, "long", beam(["full"] * 5), (0, 0, 0), inertia="material")
    assert work_size(model) == load(model.element("long").kernel).WORK_ROWS * 48


def test_a_specialised_kernel_of_the_user_comes_first(monkeypatch, tmp_path):
    """Found by name, not run."""
    from sebody.compiler.sources import TEXT, folder_hash

    monkeypatch.setenv("SEBODY_KERNELS", str(tmp_path))
    kernel = tmp_path / "superelement_f5_converged_mean_floating_field.py"
    kernel.write_text(f'SOURCES = "{folder_hash(*TEXT)}"')
    model = Model()
    place(model, "long", beam(["full"] * 5), (0, 0, 0))
    assert model.element("long").kernel == "superelement_f5_converged_mean_floating_field"


def test_a_frame_the_nodes_cannot_define_is_refused():
    for option, message in (
            ({"frame": "positions"}, "lie on a line, so the frame 'positions' cannot determine"),
            ({"inertia": "frame_axes"},
             "there is no kernel for layout 'f5', frame 'converged_mean', "
                               "inertia 'frame_axes': make it with")):
        with pytest.raises(InputError, match=message):
            place(Model(), "long", beam(["full"] * 5), (0, 0, 0), **option)


@pytest.mark.parametrize("frame, damping", [
    *((name, 0.0) for name, one in FRAMES.items() if not one.traits.modes),
    ("converged_mean", 0.02), ("node", 0.02),
    ("positions", 0.02)])
def test_four_full_nodes_have_option_b_with_every_frame(frame, damping):
    """The paper's option serves all reduced matrices, so nothing has to be derived for it."""
    corners = np.array([[0, 0, 0], [60, 0, 0], [60, 40, 10], [0, 40, 0.0]])
    body = craig_bampton(fe_frame(corners, [(0, 1), (1, 2), (2, 3)], SECTION, 2),
                         [(k, "full") for k in range(4)], 1)
    model = Model()
    nodes = place(model, "bent", body.damped(damping) if damping else body, (0, 0, 0),
                  frame=frame, inertia="material")
    model.gravity(GRAVITY)
    result = simulate(model, 0.02, 0.2)
    assert len(nodes) == 4 and result.steps == 10 and result.cuts == 0
