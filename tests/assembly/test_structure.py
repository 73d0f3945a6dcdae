"""Index arrays are remembered by structure: equal models share them, all others have their own."""

from dataclasses import fields
from functools import cache

import numpy as np
import pytest

from sebody import Model, Simulation
from sebody.assembly import build as assembly
from sebody.assembly.structure import indices
from sebody.engine.links import Links
from sebody.engine.system import System
from sebody.fem import Section, planar_beam
from sebody.reduction import craig_bampton

# what an array of indices, and of zeros and ones, is called; the others have numbers of the model
INDICES = [f.name for f in fields(System) if f.name not in (
    "address", "index", "constants", "rotation_at", "dimension", "part", "inertias",
    "massless_axes", "magnitude", "table_at", "table_times", "table_pieces", "corners", "jumps",
    "functions", "gravity_ports", "gravity_fields", "series", "series_times", "series_values",
    "prescribed", "prescribed_factor",
    "links", "control", "regularized", "massless", "body_stiffness", "body_mass", "damped",
    "guarded", "aid", "routines", "shared")]
OF_LINKS = [f.name for f in fields(Links) if f.name != "arm_vectors"]
CHANGES = {
    "support of another node": {"support": 1}, "another support": {"fixed": True},
    "none": {"support": None}, "fewer modes": {"modes": 2}, "other zeros": {"inertia": "material"},
    "other bodies first": {"order": (1, 0, 2)}, "a spring elsewhere": {"spring": (0, 2)},
    "no spring": {"spring": None}, "an arm elsewhere": {"linked": 2}, "no arm": {"linked": None},
    "two arms": {"arms": 2}, "a joint of bodies": {"joint": True}}


@cache
def beam(x, modes, modulus):
    section = Section(area=1e-3, inertia_y=1e-7, inertia_z=1e-7, torsion=1e-7,
                      youngs_modulus=modulus, poisson_ratio=0.3, density=2.7e3)
    return craig_bampton(planar_beam((x, 0.1), (x + 1.0, 0.3), section, elements=4),
                         [(0, "full"), (4, "full")], modes=modes)


def row(modes=4, inertia="floating_field", order=(0, 1, 2), support=0, fixed=False, spring=(1, 2),
        linked=1,
        arms=1, joint=False, arm=0.2, modulus=7e10, gravity=9.81, prefix="node"):
    """Beams and a weight that share nodes, or are pinned; a spring, and a force on a rigid arm."""
    model = Model(planar=True)
    nodes = [model.node(f"{prefix} {k}", (0.4 + k, 0.1 + 0.2 * k)) for k in range(3)]
    first = model.node("first", (1.4, 0.3)) if joint else nodes[1]
    parts = (lambda: model.superelement("left", beam(0.4, modes, modulus), [nodes[0], first],
                                        inertia=inertia),
             lambda: model.superelement("right", beam(1.4, 4, modulus), nodes[1:],
                                        inertia=inertia),
             lambda: model.rigid_body("weight", nodes[2], 2.0, 0.1))
    for k in order:
        parts[k]()
    if joint:
        model.revolute(first, to=nodes[1], explicit=True)
    if support is not None:
        if fixed:
            model.fix(nodes[support])
        else:
            model.revolute(nodes[support], explicit=True)
    root = nodes[linked] if linked is not None else nodes[1]
    for k in range(arms if linked is not None else 0):
        root = model.attach(f"end {k}", root.point + [arm, 0.3], to=root)
    model.force(root, (0.3, 1.0))
    if spring is not None:
        model.spring(*(nodes[k] for k in spring), stiffness=1e3)
    model.gravity((0.0, -gravity))
    return model


def arrays(model):
    """Index arrays by name."""
    system, _ = assembly.build(model)
    return ({name: getattr(system, name) for name in INDICES}
            | {f"links.{name}": getattr(system.links, name) for name in OF_LINKS})


def equal(one, other):
    return all(one[name].dtype == other[name].dtype and np.array_equal(one[name], other[name])
               for name in one)


@pytest.fixture(scope="module")
def fresh():
    """Index arrays of all models, each computed with nothing remembered."""
    found = {}
    for name, change in {"": {}, **CHANGES}.items():
        indices.cache_clear()
        found[name] = arrays(row(**change))
    return found


@pytest.mark.parametrize("change", CHANGES)
def test_a_model_that_differs_in_one_thing_has_its_own(change, fresh):
    """Also after all the others, whose arrays are remembered by then."""
    for other in CHANGES.values():
        arrays(row(**other))
    assert equal(arrays(row()), fresh[""])
    found = arrays(row(**CHANGES[change]))
    assert equal(found, fresh[change]) and not equal(found, fresh[""])


def test_the_kind_of_solver_is_part_of_the_structure(monkeypatch):
    dense = arrays(row())
    monkeypatch.setattr(assembly, "DENSE_LIMIT", 5)
    sparse = arrays(row())
    assert not dense["block_starts"].size and sparse["block_starts"].size
    monkeypatch.undo()
    assert equal(arrays(row()), dense)


def test_other_numbers_and_names_share_arrays():
    """Those that runs write to, or that have numbers of the model, are never shared."""
    (one, _), (other, _) = (assembly.build(row(**given)) for given in (
        {}, {"arm": 0.3, "modulus": 2e11, "gravity": 1.6, "prefix": "point"}))
    assert all(getattr(one, name) is getattr(other, name) for name in INDICES)
    assert all(getattr(one.links, name) is getattr(other.links, name) for name in OF_LINKS)
    others = {f.name for f in fields(System)} - {*INDICES, "links"}
    assert not any(np.shares_memory(getattr(one, name), getattr(other, name)) for name in others)
    assert not np.array_equal(one.links.arm_vectors, other.links.arm_vectors)
    assert not np.array_equal(one.constants, other.constants)


def test_a_run_does_not_write_to_them():
    indices.cache_clear()
    model = row()
    before = {name: array.copy() for name, array in arrays(model).items()}
    run = Simulation(model, 1e-3).run_to(0.01)
    assert run.system.J_entry is arrays(model)["J_entry"]
    assert equal(before, arrays(model))
