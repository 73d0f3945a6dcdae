"""Right calls of what users import: any argument may be replaced by a thing of a wrong kind."""

from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from malformed import fe_files
from malformed.read_files import SECTION, ball_scene, body, mechanism
from malformed.run_cases import pendulum

from sebody import Model, Result, Simulation, analysis as an, fem, io, reduction, results
from sebody.explore.ensembles import Output
from sebody.explore.sweep import sweep, variations
from sebody.model import variants

X, Y = (0.0, 0.0, 0.0), (4.0, 0.0, 0.0)
MATERIAL = {"youngs_modulus": 1e4, "poisson_ratio": 0.25, "density": 1.5}


class Call(NamedTuple):
    """A function and right arguments, all by name."""

    function: Callable
    arguments: Callable[[], Mapping[str, Any]]


class Colour:
    """A class that nothing knows."""


@cache
def run() -> Simulation:
    """A small mechanism that has moved."""
    return Simulation(mechanism(), 0.05).run_to(0.2)


@cache
def result() -> Result:
    """Its result."""
    return run().result()


@cache
def hanging() -> Simulation:
    """A pendulum at rest, with a load."""
    model = pendulum()
    model.attach("load", (0.0, -1.0), "pin")
    model.force("load", (1.0, 0.0), [(0.0, 0.0), (1.0, 0.0)], name="push")
    return Simulation(model, 0.1)


@cache
def beam() -> fem.FEModel:
    """A beam in space."""
    return fem.straight_beam(X, Y, SECTION, 4)


@cache
def beam_body() -> reduction.ReducedBody:
    """A planar beam."""
    return body()


@cache
def two_beams() -> Model:
    """Two beams in a row, at rest."""
    model = Model()
    for name, x in (("a", 0.0), ("c", 2.0)):
        model.node(name, (x, 0.0, 0.0))
    model.beam("beam", ("a", "c"), SECTION, elements=2, modes=0)
    return model


@cache
def ensemble() -> an.Ensemble:
    """Runs of the mechanism."""
    return an.Ensemble(mechanism(), 0.05)


def shafts() -> Model:
    """A ball on springs, about an axis."""
    model = Model()
    ball, ground = model.node("ball", (0.1, 0.0, 0.0)), model.node("ground", (0.1, 0.0, 0.0))
    model.rigid_body("weight", ball, 2.0, np.diag([0.1, 0.2, 0.25]))
    model.fix(ground)
    model.bushing(ball, ground, (500.0, 400.0, 300.0), turning_stiffness=(50.0, 40.0, 30.0))
    return model


def bearing() -> Model:
    """A disc out of balance in a bearing along x."""
    model = Model()
    ball, ground = model.node("ball", (0.0, 0.0, 0.0)), model.node("ground", (0.0, 0.0, 0.0))
    model.rigid_body("disc", ball, 2.0, (0.1, 0.1, 0.1))
    model.fix(ground)
    model.bushing(ground, ball, (50.0, 40.0, 30.0), turning_stiffness=(0.0, 40.0, 30.0))
    model.unbalance(ball, 0.1)
    return model


@cache
def damped() -> Simulation:
    """A ball on a spring and a damper, with a load."""
    model = Model()
    ball, ground = model.node("ball", (0.1, 0.0, 0.0)), model.node("ground", (0.1, 0.0, 0.0))
    model.rigid_body("weight", ball, 2.0, np.diag([0.1, 0.2, 0.25]))
    model.fix(ground)
    model.bushing(ball, ground, (500.0, 400.0, 300.0), (5.0, 4.0, 3.0), (50.0, 40.0, 30.0),
                  (0.5, 0.4, 0.3))
    model.force(ball, (1.0, 0.0, 0.0), [(0.0, 0.0), (1.0, 0.0)], name="push")
    return Simulation(model, 0.1)


def _reduced(**arguments: Any) -> reduction.ReducedBody:
    """A block of bricks with the stress operator."""
    model = replace(fe_files.BLOCK, stress=(fem.SolidStress(**arguments),))
    return reduction.reduce(model, {0: "translation", 3: "translation", 12: "translation"})


# values by name, of every kind that users mix up; those too large ask for more than any memory
JUNK = {
    "none": None, "text": "colour", "empty": "", "number": 3, "fraction": 2.5, "negative": -1,
    "zero": 0, "true": True, "nan": float("nan"), "infinite": float("inf"), "huge": 10**18,
    "enormous": 10**400, "list": [], "numbers": [1.0, 2.0], "texts": ["a", "b"], "dict": {},
    "tuple": (1, "a"), "bytes": b"colour", "complex": 1j, "function": lambda: None, "class": Colour,
    "object": Colour(), "array": np.full((2, 2), np.nan), "path": Path("colour"), "set": {1},
    "dates": np.array(["2020-01-01"], dtype="M8[D]"), "model": "a model", "result": "a result",
    "run": "a run", "body": "a body", "fe": "an FE model"}


def junk(name: str) -> Any:
    """A value of a wrong kind; those that take time are made when they are asked for."""
    return {"model": mechanism, "result": result, "run": run, "body": body, "fe": beam}.get(
        name, lambda: JUNK[name])()


ANALYSIS = {
    "Ensemble": Call(an.Ensemble, lambda: {"model": mechanism(), "h": 0.05, "scheme": None,
                                           "output_every": 1}),
    "Ensemble.run": Call(lambda **a: ensemble().run(**a), lambda: {
        "parameters": {"push.amplitude": [1.0, 2.0]}, "t_end": 0.1,
        "outputs": {"tip": an.final("tip.position")}, "threads": 1, "progress": None}),
    "maximum": Call(an.maximum, lambda: {"quantity": "tip.position", "norm": False}),
    "minimum": Call(an.minimum, lambda: {"quantity": "tip.position", "norm": False}),
    "rms": Call(an.rms, lambda: {"quantity": "tip.position", "norm": False}),
    "integral": Call(an.integral, lambda: {"quantity": "tip.position", "norm": False}),
    "final": Call(an.final, lambda: {"quantity": "tip.position", "norm": False}),
    "at_time": Call(an.at_time, lambda: {"quantity": "tip.position", "t": 0.1, "norm": False}),
    "Output": Call(lambda **a: ensemble().run({}, 0.1, {"tip": Output(**a)}), lambda: {
        "quantity": "tip.position", "kind": "at", "time": 0.1, "norm": False}),
    "frequency_response": Call(an.frequency_response, lambda: {
        "run": hanging(), "load": "push", "quantities": "load.position", "omega": [1.0, 2.0],
        "spin": None, "frame": "auto", "hub": None}),
    "campbell": Call(an.campbell, lambda: {
        "model": shafts(), "speeds": [0.0, 1.0], "axis": (0.0, 0.0, 1.0), "count": 2, "steps": 2,
        "frame": "auto", "hub": None}),
    "critical_speeds": Call(an.critical_speeds, lambda: {
        "model": bearing(), "axis": None, "orders": [1.0], "count": 3, "fastest": 9.0, "steps": 1,
        "frame": "auto", "hub": None}),
    "synchronous_response": Call(an.synchronous_response, lambda: {
        "model": bearing(), "speeds": [1.0, 2.0], "quantities": "ball.position", "axis": "x",
        "steps": 1, "frame": "auto", "hub": None}),
    "equilibrium": Call(an.equilibrium, lambda: {
        "model": pendulum(), "steps": 2, "t": 0.0, "tolerance": 1e-9, "spin": None,
        "unstable": "leave", "hub": None}),
    "linearize": Call(an.linearize, lambda: {
        "run": hanging(), "spin": None, "frame": "auto", "hub": None}),
    "modes": Call(an.modes, lambda: {
        "run": hanging(), "spin": None, "frame": "auto", "hub": None}),
    "effective_masses": Call(an.effective_masses, lambda: {"run": hanging(), "count": 1}),
    "random_response": Call(an.random_response, lambda: {
        "run": damped(), "psd": {"push": [(0.1, 1.0), (3.0, 2.0)]}, "quantities": "ball.position",
        "spin": None, "frame": "auto", "hub": None, "coherence": None}),
    "shock_spectrum": Call(an.shock_spectrum, lambda: {
        "t": [0.0, 1.0, 2.0], "acceleration": [0.0, 1.0, 0.0], "frequencies": [0.5, 2.0, 4.0, 5.0],
        "damping": 0.05}),
    "combined": Call(an.combined, lambda: {
        "values": [1.0, -2.0, 0.5], "frequencies": [1.0, 2.0, 3.0], "damping": 0.05,
        "rule": "CQC"}),
    "vibrations": Call(an.vibrations, lambda: {"run": hanging(), "count": 1}),
    "energy_gain": Call(an.energy_gain, lambda: {"model": mechanism(), "until": 0.1}),
    "resume": Call(an.resume, lambda: {"model": mechanism(), "path": "none.npz"}),
    "save_state": Call(an.save_state, lambda: {"run": run(), "path": "state.npz"}),
    "advise": Call(an.advise, lambda: {
        "model": mechanism(), "h": 0.05, "t_end": 0.1, "quantities": "tip.position",
        "tolerance": 1e-2, "budget": 1.0, "progress": None}),
}
RESULTS = {
    "plot": Call(lambda quantity, **a: results.plot(a.pop("results"), quantity, **a), lambda: {
        "results": result(), "quantity": "tip.position", "output": "a.png", "spectrum": False}),
    "animate": Call(lambda quantity, **a: results.animate(a.pop("result"), a.pop("output"),
                                                          quantity, **a), lambda: {
        "result": result(), "output": "a.html", "quantity": "tip.position", "title": "a title",
        "speed": 1.0}),
    "report": Call(lambda quantity, **a: results.report(a.pop("result"), a.pop("output"),
                                                        quantity, **a), lambda: {
        "result": result(), "output": "a.html", "quantity": "tip.position", "title": "a title"}),
    "save_picture": Call(results.save_picture, lambda: {
        "result": result(), "path": "a.png", "base": "base", "tip": "tip"}),
    "load": Call(Result.load, lambda: {"path": "none.npz"}),
    "save": Call(lambda **a: result().save(**a), lambda: {"path": "a.npz"}),
    "save_vtk": Call(lambda **a: result().save_vtk(**a), lambda: {"path": "a.pvd", "every": 2}),
    "to_pandas": Call(lambda **a: result().to_pandas(**a), lambda: {"names": ["tip.position"]}),
    "to_xarray": Call(lambda **a: result().to_xarray(**a), lambda: {"names": ["tip.position"]}),
    "field": Call(lambda **a: result().field(**a), lambda: {"name": "rod"}),
    "quantity": Call(lambda name: result()[name], lambda: {"name": "tip.position"}),
    **{f"field.{name}": Call(lambda name=name, **a: getattr(result().field("rod"), name)(**a),
                             lambda: {"step": 1, "t": None, "axes": "global"})
       for name in ("position", "displacement", "velocity", "acceleration")},
    "field.at": Call(lambda **a: result().field("rod").at(**a), lambda: {
        "node": 1, "axes": "global", "static": True}),
    "field.section_forces": Call(lambda **a: result().field("rod").section_forces(**a), lambda: {
        "step": 1, "t": None, "static": True}),
    "field.section_strains": Call(lambda **a: result().field("rod").section_strains(**a), lambda: {
        "step": 1, "t": None, "static": True}),
    "field.envelope": Call(lambda **a: result().field("rod").envelope(**a), lambda: {
        "quantity": "displacement", "static": True}),
    "field.label": Call(lambda **a: result().field("rod").label(**a), lambda: {"label": 1}),
}
FEM = {
    "straight_beam": Call(fem.straight_beam, lambda: {
        "start": X, "end": Y, "section": SECTION, "elements": 2, "up": (0.0, 1.0, 0.0)}),
    "beam_along": Call(fem.beam_along, lambda: {
        "axis": fem.Axis([X, Y]), "section": SECTION, "elements": 2}),
    "Axis": Call(fem.Axis, lambda: {
        "curve": [X, (2.0, 1.0, 0.0), Y], "twist": lambda place: place, "up": (0.0, 1.0, 0.0),
        "kinks": [1]}),
    "GeneralSection": Call(fem.GeneralSection, lambda: {
        "stiffness": np.eye(6), "mass": np.eye(6), "outline": None, "fibres": (),
        "retardation": 0.1, "name": "station 1"}),
    "Stations": Call(fem.Stations, lambda: {
        "places": [0.0, 1.0], "sections": [fem.GeneralSection(np.eye(6), np.eye(6))] * 2}),
    "planar_beam": Call(fem.planar_beam, lambda: {
        "start": X[:2], "end": Y[:2], "section": SECTION, "elements": 2}),
    "frame": Call(fem.frame, lambda: {
        "points": [X, Y, (4.0, 3.0, 0.0)], "members": [(0, 1), (1, 2)], "section": SECTION,
        "elements": 2, "up": None}),
    "hexahedral_block": Call(fem.hexahedral_block, lambda: {
        "corner": X, "size": (2.0, 1.0, 1.0), "divisions": (2, 1, 1), **MATERIAL}),
    "solid_stress": Call(fem.solid_stress, lambda: {
        "coordinates": fe_files.BLOCK.coordinates, "cells": fe_files.BLOCK.cells,
        "youngs_modulus": 1.0, "poisson_ratio": 0.2}),
    "StressModes": Call(fem.StressModes, lambda: {
        "points": np.zeros((2, 3)), "modes": np.zeros((2, 6, 4)), "nodes": [0, 1]}),
    "SolidStress": Call(_reduced, lambda: {
        "kind": "hexahedron", "nodes": fe_files.BLOCK.cells[0][1],
        "coordinates": fe_files.BLOCK.coordinates, "elasticity": np.eye(6), "strains": None}),
    "circle": Call(fem.circle, lambda: {"radius": 0.1, **MATERIAL}),
    "rectangle": Call(fem.rectangle, lambda: {"height": 0.1, "width": 0.2, **MATERIAL}),
    "FEModel": Call(fem.FEModel, lambda: {
        "stiffness": beam().stiffness, "mass": beam().mass, "coordinates": beam().coordinates,
        "node_dofs": beam().node_dofs, "mass_field": None, "geometric_stiffness": None,
        "dof_map": None, "labels": None, "node_sets": {}, "cells": (), "source": "", "units": "",
        "outlines": None, "stress": ()}),
}
REDUCTION = {
    "reduce": Call(reduction.reduce, lambda: {
        "fe_model": beam(), "boundary": {0: "full", 4: "full"}, "modes": 1,
        "method": "craig-bampton", "select": None, "recover": None, "loads": None,
        "residual_modes": False, "paths": {"rail": [0, 1, 2, 3, 4]}}),
    "reduce_model": Call(reduction.reduce_model, lambda: {
        "run_or_model": two_beams(), "interfaces": ("a", "c"), "modes": 1, "preload": True}),
    "craig_bampton": Call(reduction.craig_bampton, lambda: {
        "fe_model": beam(), "boundary": [(0, "full"), (4, "full")], "modes": 1, "select": None,
        "recover": None, "loads": None}),
    "Accuracy": Call(reduction.Accuracy, lambda: {"tolerance": 1e-2, "up_to": 3.0}),
    "RigidFace": Call(reduction.RigidFace, lambda: {"point": X, "nodes": (0, 1)}),
    "MeanFace": Call(reduction.MeanFace, lambda: {"nodes": (0, 1, 2), "point": X,
                                                  "weights": "equal"}),
    "component_modes": Call(reduction.component_modes, lambda: {
        "stiffness": beam().stiffness, "mass": beam().mass, "boundary_dofs": list(range(6)),
        "modes": 1, "select": None}),
    "frame_weights": Call(reduction.frame_weights, lambda: {
        "coordinates": [X, Y], "centre_of_mass": (1.0, 0.0, 0.0)}),
    "body_weights": Call(reduction.body_weights, lambda: {"body": beam_body()}),
    "ReducedBody": Call(reduction.ReducedBody, lambda: {
        one.name: getattr(beam_body(), one.name) for one in fields(reduction.ReducedBody)
        if one.init}),
    "grounded_body": Call(reduction.grounded_body, lambda: {
        "stiffness": np.eye(7), "mass": np.eye(7), "coordinates": [X], "keeps": ("full",),
        "modes": 1, "damping": np.eye(7), "base": Y, "coupling": np.zeros((7, 6)),
        "rigid_mass": np.eye(6), "self_weight_stiffness": np.zeros((7, 7)),
        "loads": {"wind": np.ones(7)}, "units": "m", "outputs": {"OTM": np.ones((2, 7))}}),
    "grounded_from_fe": Call(reduction.grounded_from_fe, lambda: {
        "fe_model": beam(), "boundary": [(4, "full")], "base": 0, "modes": 1,
        "gravity": (0.0, 1.0, 0.0), "loads": np.zeros(30)}),
    "self_weight_stiffness": Call(reduction.self_weight_stiffness, lambda: {
        "fe_model": beam(), "boundary": {4: "full"}, "base": 0, "modes": 1,
        "gravity": (0.0, 1.0, 0.0), "loads": np.zeros(30)}),
    "appendage": Call(reduction.appendage, lambda: {
        "masses": np.eye(6), "frequencies": [1.0, 2.0], "participation": 0.1 * np.ones((2, 6)),
        "damping": 0.01, "point": X, "units": "m"}),
    "damped": Call(lambda **a: beam_body().damped(**a), lambda: {
        "ratio": 0.1, "mass": 0.0, "stiffness": 0.0}),
    "rotated": Call(lambda **a: beam_body().rotated(**a), lambda: {"rotation": np.eye(2)}),
    "recovering": Call(lambda **a: beam_body().recovering(**a), lambda: {"nodes": [0, 1]}),
    "displacements": Call(lambda **a: beam_body().displacements(**a), lambda: {"y": np.zeros(8)}),
}
IO = {
    "save_body": Call(io.save_body, lambda: {
        "body": beam_body(), "path": "body.npz", "names": ("a", "b", "c"), "units": "m",
        "provenance": {"source": "here"}, "recovery": True}),
    "load_body": Call(io.load_body, lambda: {"path": "none.npz"}),
    "read_body_file": Call(io.read_body_file, lambda: {"path": "none.npz"}),
    "LoadSeries": Call(io.LoadSeries, lambda: {
        "t": [0.0, 1.0], "values": np.eye(2), "names": ("a", "b"), "interpolation": "linear",
        "others": {"c": [0.0, 1.0]}}),
    "LoadSeries.from_csv": Call(io.LoadSeries.from_csv, lambda: {
        "path": "none.csv", "interpolation": "linear", "columns": ["a"]}),
    "read_beamdyn": Call(io.read_beamdyn, lambda: {"path": "none.dat", "blade": None}),
    "read_extptfm": Call(io.read_extptfm, lambda: {"path": "none.dat", "interface": X, "base": Y}),
    "write_extptfm": Call(io.write_extptfm, lambda: {
        "body": reduction.grounded_body(np.eye(7), np.eye(7), [X], modes=1), "path": "a.dat",
        "series": io.LoadSeries([0.0, 1.0], np.eye(2), ["x", "mode 0"]), "form": "flex",
        "comment": "here"}),
    "write_sid": Call(io.write_sid, lambda: {"body": beam_body(), "path": "a.sid", "names": None}),
    "import_body": Call(io.import_body, lambda: {
        "path": "none.inp", "interfaces": {"a": "1"}, "modes": 0, "method": "guyan",
        "kind": "calculix", "units": "", "output": None}),
    "read_fe_model": Call(io.read_fe_model, lambda: {"path": "none.inp", "kind": None}),
    "from_skfem": Call(io.from_skfem, lambda: {
        "basis": None, "stiffness": beam().stiffness, "mass": beam().mass,
        "youngs_modulus": 1.0, "poisson_ratio": 0.2, "units": ""}),
}
VARIANTS = {
    "planar": Call(variants.planar, lambda: {"model": shafts()}),
    "rigid": Call(variants.rigid, lambda: {"model": mechanism(), "name": "rod"}),
    "divide": Call(variants.divide, lambda: {
        "model": mechanism(), "name": "rod", "bodies": 2, "elements": 4}),
    "keep_modes": Call(variants.keep_modes, lambda: {
        "model": mechanism(), "name": "rod", "modes": 0}),
    "with_options": Call(variants.with_options, lambda: {
        "model": mechanism(), "name": "rod", "frame": None, "inertia": None, "stiffening": False}),
    "drop_triplet": Call(variants.drop_triplet, lambda: {
        "model": mechanism(), "name": "rod", "node": "tip", "what": "rotation"}),
    "can_be_dropped": Call(variants.can_be_dropped, lambda: {"model": mechanism()}),
    "can_be_shared": Call(variants.can_be_shared, lambda: {"model": mechanism()}),
    "shared": Call(variants.shared, lambda: {"model": mechanism(), "name": None}),
    "copied": Call(variants.copied, lambda: {"model": mechanism()}),
}
SWEEP = {
    "sweep": Call(sweep, lambda: {
        "build": ball_scene, "outputs": {"end": an.final("ball.position")},
        "listed": {"push": [1.0, 2.0]}, "sampled": None, "runs": None, "seed": 0, "sampler": "lhs",
        "sobol_n": None, "fixed": {"t_end": 0.2}, "output": None, "threads": 1, "cluster": None,
        "progress": None}),
    "distribution": Call(variations.distribution, lambda: {
        "kind": "normal", "numbers": (1.0, 0.1), "what": "push"}),
}
CALLS = ANALYSIS | RESULTS | FEM | REDUCTION | IO | VARIANTS | SWEEP
