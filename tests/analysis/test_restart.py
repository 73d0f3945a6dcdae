"""Stop, save, resume: the same bits as a run that does not stop."""

import numpy as np
import pytest

from sebody import InputError, Simulation, Tolerance, generalized_alpha
from sebody.analysis import resume, save_state
from sebody.scenes import chain, hinged_beam, spherical_beam_strong


@pytest.mark.parametrize("build, h, t_end, options", [
    (hinged_beam.build, 0.01, 4.0, {}),
    (hinged_beam.build, 0.01, 4.0, {"tolerance": Tolerance(1e-4)}),
    (hinged_beam.build, 0.01, 4.0, {"scheme": generalized_alpha(0.8, index=2), "output_every": 7}),
    (spherical_beam_strong.build, 0.01, 2.0, {}),       # a compiled function
    (lambda: chain.build(8), 0.01, 1.0, {}),            # sparse
], ids=["fixed", "variable", "index 2", "function", "sparse"])
def test_bit_for_bit(tmp_path, build, h, t_end, options):
    whole = Simulation(build().model, h, **options).run_to(t_end / 2).run_to(t_end).result()
    first = Simulation(build().model, h, **options).run_to(t_end / 2)
    path = save_state(first, tmp_path / "half.npz")
    second = resume(build().model, path)
    assert second.time == first.time and second.scheme == first.scheme
    result = second.run_to(t_end).result()
    assert np.array_equal(result.rows, whole.rows)
    assert result.iterations_per_step == whole.iterations_per_step


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
        with pytest.raises(InputError, match="is no restart file"):
            resume(hinged_beam.build().model, tmp_path / "broken.npz")
    with np.load(path) as file:
        arrays = {name: file[name] for name in file if name != "aux_old"}
    np.savez(tmp_path / "older.npz", **arrays)
    with pytest.raises(InputError, match=r"older.npz was written by another version of sebody "
                                         r"\(it differs in aux_old\): run the model again"):
        resume(hinged_beam.build().model, tmp_path / "older.npz")
    np.savez(tmp_path / "other.npz", t=np.zeros(3))
    with pytest.raises(InputError, match="is no restart file"):
        resume(hinged_beam.build().model, tmp_path / "other.npz")
