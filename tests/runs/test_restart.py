"""Stop, save, resume: the same bits as a run that does not stop; models are in test_readings."""

import numpy as np
import pytest
from helpers import multipliers_first

from sebody import InputError, Model, Simulation, Tolerance, generalized_alpha
from sebody.analysis import resume, save_state
from sebody.assembly import build as assembly
from sebody.scenes import chain, hinged_beam, spherical_beam_strong


@pytest.mark.parametrize("build, h, t_end, options", [
    (hinged_beam.build, 0.01, 4.0, {"tolerance": Tolerance(1e-4)}),
    (hinged_beam.build, 0.01, 4.0, {"scheme": generalized_alpha(0.8, index=2), "output_every": 7}),
    (spherical_beam_strong.build, 0.01, 2.0, {}),       # a compiled function
], ids=["variable", "index 2", "function"])
def test_bit_for_bit(tmp_path, build, h, t_end, options):
    whole = Simulation(build().model, h, **options).run_to(t_end / 2).run_to(t_end).result()
    first = Simulation(build().model, h, **options).run_to(t_end / 2)
    path = save_state(first, tmp_path / "half.npz")
    second = resume(build().model, path)
    assert second.time == first.time and second.scheme == first.scheme
    result = second.run_to(t_end).result()
    assert np.array_equal(result.rows, whole.rows)
    assert result.iterations_per_step == whole.iterations_per_step


def test_factors_with_row_exchanges_are_made_again(tmp_path, monkeypatch):
    """They are in no file; the matrix is kept over steps as short as these."""
    monkeypatch.setattr(assembly, "number", multipliers_first(assembly.number))
    whole = Simulation(chain.build(4).model, 1e-3).run_to(6e-3).run_to(12e-3)
    first = Simulation(chain.build(4).model, 1e-3).run_to(6e-3)
    assert first.state.control.pivoted == 1
    again = resume(chain.build(4).model, save_state(first, tmp_path / "half.npz")).run_to(12e-3)
    assert np.array_equal(again.result().rows, whole.result().rows)


def test_wrong_files(tmp_path):
    run = Simulation(hinged_beam.build().model, 0.01).run_to(0.1)
    with pytest.raises(InputError, match="must end in .npz"):
        save_state(run, tmp_path / "state.txt")
    with pytest.raises(InputError, match="does not exist: make it"):
        save_state(run, tmp_path / "nowhere" / "state.npz")
    path = save_state(run, tmp_path / "state.npz")
    with pytest.raises(InputError, match="is of another model"):
        resume(hinged_beam.build(modes=2).model, path)
    with pytest.raises(InputError, match="is of another model"):
        other = hinged_beam.build()
        other.model.gravity((0, 0, -1.0))
        other.model.force("tip", (0, 0, 1.0))
        resume(other.model, path)
    with pytest.raises(InputError, match="does not exist: give one that was saved"):
        resume(hinged_beam.build().model, tmp_path / "none.npz")
    for content in (b"not zip", b""):
        (tmp_path / "broken.npz").write_bytes(content)
        with pytest.raises(InputError, match="is damaged or no restart file"):
            resume(hinged_beam.build().model, tmp_path / "broken.npz")
    with np.load(path) as file:
        arrays = {name: file[name] for name in file if name != "aux_old"}
    np.savez(tmp_path / "older.npz", **arrays)
    with pytest.raises(InputError, match=r"older.npz was written by another version of sebody "
                                         r"\(it differs in aux_old\): run the model again"):
        resume(hinged_beam.build().model, tmp_path / "older.npz")
    np.savez(tmp_path / "other.npz", t=np.zeros(3))
    with pytest.raises(InputError, match="is damaged or no restart file"):
        resume(hinged_beam.build().model, tmp_path / "other.npz")


def small(mass=1.0, stiffness=5.0, times=(0.0, 1.0, 2.0), values=(0.0, 0.3, 0.4),
          direction=(1.0, 0.0), start=(1.0, 0.0), push=2.0, delay=0.0, on="ball",
          gravity=0.0):
    """A mass on a spring whose other end is moved: a model of which any part can be another."""
    model = Model(planar=True)
    model.node("end", (0.0, 0.0))
    model.move("end", direction, list(zip(times, values, strict=True)))
    model.fix("end", "rotation")
    for name, point in (("ball", start), ("second", (2.0, 0.0))):
        model.rigid_body(name, model.node(name, point), mass, 1.0)
    model.spring("ball", "end", stiffness, length=1.0)
    model.force(on, (1.0, 0.0), [(delay, 0.0), (delay + 1.0, push)])
    model.gravity((0.0, gravity))
    return model


@pytest.mark.parametrize("change", [
    {"mass": 1.5}, {"stiffness": 6.0}, {"times": (0.0, 1.0, 2.5)}, {"values": (0.0, 0.3, 0.5)},
    {"direction": (0.0, 1.0)}, {"start": (1.0, 0.5)}, {"push": 3.0}, {"delay": 1.0},
    {"on": "second"}, {"direction": (2.0, 0.0)}, {"gravity": -9.81}],
    ids=lambda change: next(iter(change)))
def test_a_state_goes_on_with_its_own_model_only(tmp_path, change):
    """Unknowns and names are those of the saved model; one number, or what it acts on, is not."""
    path = save_state(Simulation(small(), 0.01).run_to(0.1), tmp_path / "state.npz")
    resume(small(), path)
    with pytest.raises(InputError, match="is of another model: build the one it was saved from"):
        resume(small(**change), path)


def test_a_state_goes_on_with_its_own_kernels_only(tmp_path):
    """Two inertia options have the same unknowns and the same constants."""
    run = Simulation(hinged_beam.build(modes=0, inertia="frame_axes").model, 0.01).run_to(0.1)
    path = save_state(run, tmp_path / "state.npz")
    with pytest.raises(InputError, match="is of another model"):
        resume(hinged_beam.build(modes=0, inertia="material").model, path)


def test_the_file_says_which_constraints_are_redundant(tmp_path):
    """Found from ranks, where rounding decides: another machine may see another number.

    A hinge, regularized by hand where this machine would not, is on file as such, and a run that
    goes on from the file is that of the state saved, bit for bit.
    """
    def hinged():
        model = Model(planar=True)
        model.rigid_body("bob", model.node("pin", (0.0, 0.0)), 1.0, 0.1, centre=(1.0, 0.0))
        model.revolute("pin", explicit=True)
        model.gravity((0.0, -9.81))
        return model
    first = Simulation(hinged(), 0.01)
    assert not first.start.redundant
    first.system.regularized[0] = 1
    path = save_state(first.run_to(0.5), tmp_path / "half.npz")
    second = resume(hinged(), path)
    assert second.system.regularized[0] == 1
    whole, rest = first.run_to(1.0).result(), second.run_to(1.0).result()
    assert np.array_equal(rest.rows, whole.rows)
    assert not np.array_equal(rest.rows, Simulation(hinged(), 0.01).run_to(1.0).result().rows)
