"""Writes small files of OpenFAST's module BeamDyn, as its manual describes them."""

from pathlib import Path

import numpy as np

# matrices of a uniform blade in BeamDyn's order Fx Fy Fz Mx My Mz, x to the suction side, z along
K = np.diag([6e8, 7e8, 9e9, 8e9, 5e9, 2e9])
K[2, 3] = K[3, 2] = 4e8
K[3, 5] = K[5, 3] = -2e8
MASS, CENTRE, INERTIA = 300.0, (0.2, -0.1), (250.0, 120.0, 370.0)


def mass(m=MASS, centre=CENTRE, inertia=INERTIA):
    """Mass matrix of a section with rotary inertia about the reference axis."""
    x, y = centre
    M = np.diag([m, m, m, *inertia]).astype(float)
    for i, j, value in ((0, 5, -m * y), (1, 5, m * x), (2, 3, m * y), (2, 4, -m * x)):
        M[i, j] = M[j, i] = value
    return M


def rows(matrix):
    """Six lines."""
    return ["   " + "  ".join(f"{value: .10E}" for value in row) for row in matrix]


def stations(places, stiffness, masses, mu=None, damp_type=None):
    """Text of a blade file."""
    kind = (0 if mu is None else 1) if damp_type is None else damp_type
    lines = [" ------- BEAMDYN V1.00.* INDIVIDUAL BLADE INPUT FILE ------", " Made by a script",
             " ---------------------- BLADE PARAMETERS ------------------",
             f"{len(places)}   station_total    - Number of blade input stations (-)",
             f" {kind}   damp_type        - Damping type: 0: no damping; 1: damped",
             "  ---------------------- DAMPING COEFFICIENT---------------",
             "   mu1        mu2        mu3        mu4        mu5        mu6",
             "   (-)        (-)        (-)        (-)        (-)        (-)",
             "  ".join(f"{value:.6E}" for value in np.broadcast_to(0.0 if mu is None else mu, 6)),
             " ---------------------- DISTRIBUTED PROPERTIES-------------"]
    for place, one, its in zip(places, stiffness, masses, strict=True):
        lines += [f"  {place:.8f}", *rows(one), "", *rows(its), ""]
    return "\n".join(lines) + "\n"


def primary(points, twist, members=None, blade="blade.dat"):
    """Text of a primary file; `members` are the numbers of key points of each."""
    members = members or [len(points)]
    lines = ["--------- BEAMDYN with OpenFAST INPUT FILE -----------", "Made by a script",
             "---------------------- SIMULATION CONTROL ------------",
             "False         Echo             - Echo input data (flag)",
             "          2   quadrature       - Quadrature method (-)",
             '"DEFAULT"     dtbeam           - Time step size (s).',
             "---------------------- GEOMETRY PARAMETER ------------",
             f"          {len(members)}   member_total    - Total number of members (-)",
             f"         {len(points)}   kp_total        - Total number of key points (-)",
             *(f"     {k}     {count}       - Member number; Number of key points in this member"
               for k, count in enumerate(members, 1)),
             "         kp_xr       kp_yr       kp_zr     initial_twist",
             "          (m)         (m)         (m)         (deg)",
             *("  ".join(f"{value: .10E}" for value in (*point, angle))
               for point, angle in zip(points, twist, strict=True)),
             "---------------------- MESH PARAMETER ----------------",
             "          5   order_elem     - Order of interpolation function (-)",
             "---------------------- MATERIAL PARAMETER ------------",
             f'"{blade}"    BldFile - Name of file containing properties for blade (quoted string)']
    return "\n".join(lines) + "\n"


def write(folder, points=((0, 0, 0), (0, 0, 5.0), (0, 0, 10.0)), twist=(12.0, 5.0, -1.0),
          places=(0.0, 0.5, 1.0), stiffness=None, masses=None, mu=None, **others):
    """Both files; the path of the primary one."""
    folder = Path(folder)
    stiffness = [K * s for s in np.linspace(1, 0.2, len(places))] if stiffness is None else (
        stiffness)
    masses = [mass() * s for s in np.linspace(1, 0.3, len(places))] if masses is None else masses
    (folder / "blade.dat").write_text(stations(places, stiffness, masses, mu))
    (folder / "primary.dat").write_text(primary(points, twist, **others))
    return folder / "primary.dat"
