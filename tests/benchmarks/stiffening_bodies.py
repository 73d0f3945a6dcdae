"""Solids, plates and frames that `bench_stiffening` measures."""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq
from stiffened_models import (
    SLENDER,
    TURN,
    accelerations,
    block,
    cantilever,
    divided_elbow,
    elbow,
    idle_spin,
    linkage,
    places,
    plate,
    plate_frequencies,
)
from stiffening_beams import ETA, GROWTH, Values, frequencies

from sebody import Model, Simulation
from sebody.analysis import equilibrium, linearize, modes, vibrations
from sebody.fem import hexahedral_block
from sebody.reduction import RigidFace, craig_bampton

SOLID = {"flap 1": 7.360373, "lag 1": 4.263225}
START = {"at rest": 0.0, "flying": 0.0}


def solid(thickness: float, cells: tuple[int, int, int], internal: int, option: dict) -> Model:
    """Hexahedra, 40 long and 2 high, tied to a node at each end."""
    bricks = hexahedral_block([0, -thickness / 2, -1], [40, thickness, 2], cells, 1e6, 0.3, 1.0)
    x = bricks.coordinates[:, 0]
    ends = [RigidFace((place, 0.0, 0.0), np.flatnonzero(x == place)) for place in (0, 40)]
    model = Model()
    nodes = model.node("root", (0, 0, 0)), model.node("tip", (40, 0, 0))
    model.superelement("arm", craig_bampton(bricks, [(end, "full") for end in ends], internal),
                       nodes, **option)
    model.fix("root")
    return model


def spinning_solid(option: dict) -> Values:
    """40 x 2 x 2 hexahedra at eta = 6, six modes."""
    unit = np.sqrt(4.0 * 40.0**4 / (1e6 * 2.0**4 / 12))
    return frequencies(solid(2.0, (40, 2, 2), 6, option), (0.0, 0.0, ETA / unit), SOLID, unit)


def strip(option: dict) -> Values:
    """Euler's load of a thin strip, six modes."""
    def lowest(load: float) -> float:
        model = solid(0.3, (40, 1, 2), 6, option)
        model.force("tip", (-load, 0.0, 0.0))
        straight = equilibrium(model, 1, unstable="keep")
        return np.linalg.eigvals(linearize(straight).stiffness).real.min()
    return {"load": brentq(lowest, 5.0, 10.0, xtol=1e-4) if lowest(10.0) < 0 else np.inf}


def soft_blade(option: dict) -> Values:
    """Largest real part of an eigenvalue over the highest frequency, spins 1 to 6."""
    found = {}
    for torsion in (0.1, 0.01, 1e-3):
        section = replace(SLENDER, torsion=torsion, inertia_x=2e-6, inertia_y=1e-6,
                          inertia_z=1e-6)
        rates = []
        for eta in range(1, 7):
            spin = (0.0, 0.0, float(eta))
            one = modes(equilibrium(cantilever(option, section=section), 2, spin=spin), spin)
            rates.append(one.growth.max() / one.omega.max())
        found[f"GJ / EI {torsion:g}"] = max(rates)
    return found


def propeller(option: dict) -> Values:
    """Change of the square of a torsion frequency over that of the spin."""
    found = {}
    for name, (y, z) in {"square section": (1e-6, 1e-6), "thin section": (1e-7, 1.9e-6)}.items():
        section = replace(SLENDER, torsion=1e-2, bending_y=1e3, bending_z=1e3, inertia_x=y + z,
                          inertia_y=y, inertia_z=z)
        squares = []
        for spin in (0.0, 8.0):
            one = modes(equilibrium(cantilever(option, internal=0, span=16, section=section), 1,
                                    spin=(0, 0, spin)), (0, 0, spin))
            twist = np.argmax(np.abs(one.shape("n1.rotation")[0]))
            squares.append(one.values[twist].imag**2 - one.values[twist].real**2)
        found[name] = (squares[1] - squares[0]) / 64.0
    return found


PUSH = np.array([30.0, 4.0, -5.0])


def started(option: dict) -> Values:
    """A block by its corners, set spinning unstrained: largest acceleration by centripetal ones."""
    spin, found = 10.0 * TURN[:, 2], {}
    x = [node.point for node in block(option).nodes.values()]
    exact = np.abs(np.cross(spin, np.cross(spin, x))).max()
    for name, speed in zip(START, (0.0, 1.0), strict=True):
        run = Simulation(block(option, speed * PUSH, spin), 1e-4)
        found[name] = np.abs(accelerations(run)).max() / exact
    return found


def corners(option: dict) -> Values:
    """From centrifugal equilibrium: error of the accelerations, and their change by a speed."""
    spin = 10.0 * TURN[:, 2]
    run = equilibrium(block(option), 1, spin=spin)
    x = np.array([run.state.q[at] for at in places(run)])
    found, exact = accelerations(run), np.cross(spin, np.cross(spin, x))
    for at in places(run):
        run.state.v[at] += PUSH
    moved = accelerations(run)
    size = np.abs(exact).max()
    return {"error": np.abs(found - exact).max() / size,
            "change by a speed": np.abs(moved - found).max() / size}


def coupler(option: dict) -> Values:
    """Idle spin and largest strain energy of a coupler between ball joints, six modes."""
    result = linkage(option, 1, 6)
    return {"idle spin": idle_spin(result), "peak strain": result["energy.strain"].max()}


def divided_coupler() -> Values:
    """The same of sixteen bodies."""
    result = linkage({"inertia": "material"}, 16, 0)
    return {"idle spin": idle_spin(result), "peak strain": result["energy.strain"].max()}


def bent(option: dict) -> Values:
    """Largest relative error of four frequencies of an elbow at three spins."""
    first = vibrations(equilibrium(elbow(option), 1)).omega[0]
    found = {}
    for share in (0.21, 0.42, 0.63):
        spin = share * first * TURN[:, 2]
        coarse, fine = (modes(equilibrium(divided_elbow(n), 2, spin=spin), spin).omega[:4]
                        for n in (5, 10))
        exact = (4 * fine - coarse) / 3
        one = modes(equilibrium(elbow(option), 2, spin=spin), spin).omega[:4]
        found[f"at {share:g} omega 1"] = np.abs(one / exact - 1).max()
    return found


def corner_plate(option: dict) -> Values:
    """Largest relative error of four frequencies of a plate with four interfaces.

    NaN where small motion grows.
    """
    first, found = plate_frequencies(0.0)[0], {}
    for share in (0.5, 1.0, 2.0):
        spin, exact = (0.0, 0.0, share * first), plate_frequencies(share * first)[:4]
        one = modes(equilibrium(plate(option, 8), 2, spin=spin), spin)
        grows = one.growth.max() > GROWTH * first
        found[f"at {share:g} omega 1"] = (
            np.nan if grows else np.abs(one.omega[:4] / exact - 1).max())
    return found
