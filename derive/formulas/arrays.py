"""The arrays of a superelement kernel: state, local coordinates, forces and constants."""

from sebody.contract.layout import DAMPING_CONSTANTS, SUPERELEMENT_CONSTANTS
from sebody.derive.form import counts
from sebody.derive.form.arrays import Array, constant, pointed, scratch

qe, ve, ae = map(scratch, ("qe", "ve", "ae"))           # state of the element
y, yd, ydd = map(scratch, ("y", "yd", "ydd"))           # local coordinates; velocities in T
acc = scratch("acc")                                    # accelerations in axes of the frame
eta, etad = map(scratch, ("eta", "etad"))               # rates of the local coordinates
s, p, pd, h = map(scratch, ("s", "p", "pd", "h"))       # forces and momenta conjugate to them
friction, weight = map(scratch, ("friction", "weight"))
d, gamma = map(scratch, ("d", "gamma"))                 # first moment of mass, gravity
Q, beta = map(scratch, ("Q", "beta"))                   # rotations in the frame, and of it
COEFFICIENTS = tuple(map(scratch, ("e0s", "e1s", "e2s", "b0s", "b1s")))    # of T^-1

g = pointed("g", counts.n)                              # forces on the unknowns
field, frame = pointed("field", 3), pointed("frame", 9)
reference = pointed("reference", 9)
nodes = pointed("nodes", counts.ROTATIONS, whole=True)
unknowns = pointed("unknowns", counts.n, whole=True)
R, loads = pointed("R"), pointed("loads")
index = pointed("index", whole=True)

CONSTANTS = {part.name: constant(part) for part in (*SUPERELEMENT_CONSTANTS, *DAMPING_CONSTANTS)}
alphas, fits, alpha_rs, X, S, M, mass_columns, mass_rows, mc, full, masses, C = CONSTANTS.values()

ARRAYS: dict[str, Array] = {array.name: array for array in (
    qe, ve, ae, y, yd, ydd, acc, eta, etad, s, p, pd, h, d, gamma, Q, beta, *COEFFICIENTS, g, field,
    R, qe.d, ve.d, ae.d, *CONSTANTS.values())}
