"""Many short runs: an ensemble in threads, against single runs, the peer in processes, the loop."""

import os
import time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

import numpy as np

from sebody.catalogue import builder
from sebody.explore.ensembles import Ensemble, maximum
from sebody.explore.ensembles.work import processors
from sebody.runs.simulation import Simulation
from sebody.verify.bench import peer
from sebody.verify.bench.measurement import Measurement
from sebody.verify.bench.own import OPTION_B

SCENE = "ensemble"
RUNS, T_END = 10_000, 3.0       # of 300 steps
ALONE = 200             # runs one by one, and of the peer a process: the rest follows
SEED = 1


def measure(runs: int = RUNS) -> list[Measurement]:
    """Hinged beams of different torque and stiffness: all together, then a few one by one.

    `wall_seconds` is that of all runs, set-up apart; `us_per_step` of it a step of a run on all
    processors together. `thread_efficiency` is the time of one thread over that of all threads
    times their number; none for single runs and for Exudyn.
    """
    rows = [_together(inertia, runs) for inertia in (None, "material")] + [_one_by_one(runs)]
    return rows + ([_peer(runs)] if peer.available() else [])


def _parameters(runs: int) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(SEED)
    return {"torque on base.rotation.amplitude": rng.uniform(0.8, 1.2, runs),
            "beam.stiffness": rng.uniform(0.8, 1.2, runs)}


def _together(inertia: str | None, runs: int) -> Measurement:
    scene = builder("hinged-beam")(**({} if inertia is None else {"inertia": inertia}))
    ensemble = Ensemble(scene.model, scene.h)
    parameters, outputs = _parameters(runs), {"tip": maximum("tip.position")}
    few = {name: values[:max(1, runs // 5)] for name, values in parameters.items()}
    ensemble.run({name: values[:2] for name, values in few.items()}, T_END, outputs)
    alone = min(ensemble.run(few, T_END, outputs, threads=1).seconds for _ in range(2))
    seconds = min(ensemble.run(parameters, T_END, outputs).seconds for _ in range(2))
    steps = round(T_END / scene.h)
    efficiency = alone * runs / len(few["beam.stiffness"]) / (processors() * seconds)
    return Measurement(SCENE, f"{processors()} threads" + (OPTION_B
                                                           if inertia == "material" else ""),
                       _unknowns(scene), scene.h, 1e6 * seconds / (runs * steps), None, None,
                       seconds, thread_efficiency=efficiency)


def _unknowns(scene) -> int:
    return Simulation(scene.model, scene.h).numbering.free


def _one_by_one(runs: int) -> Measurement:
    """A `Simulation` for each run, which is what a loop in a script does; scaled to all runs."""
    scene = builder("hinged-beam")(inertia="material")
    began, inside, count = time.perf_counter(), 0.0, min(ALONE, runs)
    for _ in range(count):
        run = Simulation(scene.model, scene.h).run_to(T_END)
        inside += run.seconds
    seconds = (time.perf_counter() - began) * runs / count
    steps = round(T_END / scene.h)
    return Measurement(SCENE, f"one by one, in the loop {inside * runs / count:.2f} s" + OPTION_B,
                       _unknowns(scene), scene.h, 1e6 * seconds / (runs * steps), None, None,
                       seconds)


def _peer(runs: int) -> Measurement:
    """The peer's fastest spatial model in as many processes, as its parameter variation runs."""
    workers, count = os.cpu_count() or 1, 10
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        list(pool.map(_peer_runs, [1] * workers))       # imports apart
        began = time.perf_counter()
        unknowns = list(pool.map(_peer_runs, [count] * workers))[0]
        seconds = (time.perf_counter() - began) * runs / (count * workers)
    return Measurement(SCENE, f"{peer.NAME} beams in space, {workers} processes", unknowns, 0.01,
                       1e6 * seconds / (runs * round(T_END / 0.01)), None, None, seconds)


def _peer_runs(count: int) -> int:
    models = peer.imported("peer_models")
    return [models.spatial_beams(0.01, 2, T_END).unknowns for _ in range(count)][0]
