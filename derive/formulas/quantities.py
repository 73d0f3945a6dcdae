"""The quantities of a superelement kernel: name, paper symbol, place in the kernel, unit."""

from sebody.derive.symbolic.spaces import Quantity, Space

# name: (kind, home, kernel array, paper symbol, meaning [unit])
TABLE = {
    "x": ("vector", "position", "qe", "x_i", "position of a boundary node [length]"),
    "v": ("vector", "position", "ve", "xdot_i", "its velocity [length/time]"),
    "a": ("vector", "position", "ae", "xddot_i", "its acceleration [length/time^2]"),
    "X": ("vector", "position", "X", "X_i", "node in the frame, undeformed [length]"),
    "alpha": ("scalar", "position", "alphas", "alpha_i", "frame weight of a position"),
    "fit": ("scalar", "position", "fits", "w_i", "weight in the rotation of best fit"),
    "u": ("vector", "position", "y", "u_i", "local elastic displacement, (11) [length]"),
    "vs": ("vector", "position", "yd", "xdot*_i", "velocity in frame axes, (33) [length/time]"),
    "acc": ("vector", "position", "acc", "R0^T xddot_i", "acceleration in frame axes"),
    "vsd": ("vector", "position", "ydd", "yddot_u", "local acceleration, (46), (58)"),
    "f": ("vector", "position", "s", "(Sbar y)_u", "elastic force conjugate to u_i [force]"),
    "px": ("vector", "position", "p", "(Mbar ydot)_x", "momentum conjugate to xdot*_i"),
    "pxd": ("vector", "position", "pd", "(Mbar yddot)_x", "its rate in local terms [force]"),
    "h": ("vector", "position", "h", "R0^T G_x,i", "force on the node in frame axes [force]"),
    "gx": ("vector", "position", "g", "G_x,i", "force on the node [force]"),
    "alpha_r": ("scalar", "rotation", "alpha_rs", "alpha_j", "frame weight of a rotation"),
    "R": ("rotation", "rotation", "R", "R_j", "rotation of a boundary node"),
    "Q": ("rotation", "rotation", "Q", "R0^T R_j", "rotation of a node in the frame"),
    "Om": ("axial", "rotation", "ve", "Omega_j", "material angular velocity [1/time]"),
    "A": ("axial", "rotation", "ae", "A_j", "material angular acceleration [1/time^2]"),
    "psi": ("axial", "rotation", "y", "psi_j", "local elastic rotation vector, (11) [rad]"),
    "beta": ("axial", "rotation", "beta", "beta_j", "rotation from the last frame, (15) [rad]"),
    "e0": ("scalar", "rotation", "e0s", "e", "coefficient of T^-1(psi_j)"),
    "e1": ("scalar", "rotation", "e1s", "de/ds", "its derivative"),
    "b0": ("scalar", "rotation", "b0s", "e", "coefficient of T^-1(beta_j)"),
    "b1": ("scalar", "rotation", "b1s", "de/ds", "its derivative"),
    "w": ("axial", "rotation", "yd", "Omega_j or Omega*_j", "angular velocity in T, (36), (52)"),
    "wd": ("axial", "rotation", "ydd", "yddot_w", "its rate in local terms, (46), (58)"),
    "m": ("axial", "rotation", "s", "(Sbar y)_psi", "elastic moment conjugate to psi_j"),
    "pw": ("axial", "rotation", "p", "(Mbar ydot)_w", "momentum conjugate to w_j"),
    "pwd": ("axial", "rotation", "pd", "(Mbar yddot)_w", "its rate in local terms"),
    "gt": ("axial", "rotation", "g", "G_theta,j", "moment on the node, material [moment]"),
    "eu": ("vector", "position", "eta", "d/dt u_i", "rate of an elastic displacement"),
    "ep": ("axial", "rotation", "eta", "d/dt psi_j", "rate of an elastic rotation"),
    "em": ("scalar", "mode", "eta", "d/dt y_I", "rate of an internal mode"),
    "fm": ("scalar", "mode", "s", "(Sbar y)_I", "elastic force of an internal mode"),
    "pmd": ("scalar", "mode", "pd", "(Mbar yddot)_I", "inertia force of an internal mode"),
    "gm": ("scalar", "mode", "g", "G_I", "force of an internal mode"),
    "qm": ("scalar", "mode", "qe", "y_I", "amplitude of an internal mode"),
    "vm": ("scalar", "mode", "ve", "ydot_I", "its rate"),
    "am": ("scalar", "mode", "ae", "yddot_I", "its acceleration"),
    "ym": ("scalar", "mode", "y", "y_I", "its place among the local coordinates"),
    "ydm": ("scalar", "mode", "yd", "ydot_I", "its place among the local velocities"),
    "yddm": ("scalar", "mode", "ydd", "yddot_I", "its place among the local accelerations"),
    "x0": ("vector", "element", "", "x_0", "origin of the frame, (14) [length]"),
    "R0": ("rotation", "element", "", "R_0", "rotation of the frame"),
    "beta0": ("axial", "element", "", "beta_0", "rotation of the frame since the last step, (16)"),
    "c2": ("scalar", "element", "", "c_2(beta0^2)", "coefficient of T(beta_0)"),
    "c3": ("scalar", "element", "", "c_3(beta0^2)", "coefficient of T(beta_0)"),
    "c4": ("scalar", "element", "", "c_4(beta0^2)", "for its derivative"),
    "c5": ("scalar", "element", "", "c_5(beta0^2)", "for its derivative"),
    "v0": ("vector", "element", "", "R0^T xdot_0", "velocity of the origin in frame axes"),
    "Om0": ("axial", "element", "", "Omega_0", "angular velocity of the frame [1/time]"),
    "mean": ("axial", "element", "", "sum alpha_j Omega_j", "weighted mean of rates"),
    "F": ("vector", "element", "", "sum f_i", "sum of the elastic forces [force]"),
    "W": ("axial", "element", "", "W", "moment on the frame [moment]"),
    "wp": ("axial", "element", "", "B^-T W", "moment pulled back through the frame's variation"),
    "Ms": ("axial", "element", "", "", "moment on the mean of the variations, (20) [moment]"),
    "P": ("vector", "element", "", "", "momentum of the body [mass length/time]"),
    "H": ("axial", "element", "", "", "its moment about the origin"),
    "field": ("vector", "element", "field", "g", "gravity [length/time^2]"),
    "gamma": ("vector", "element", "gamma", "R0^T g", "gravity in frame axes"),
    "d": ("vector", "element", "d", "r^T Mbar y", "first moment of mass of the deformation"),
    "mc": ("vector", "element", "mc", "m c", "first moment of mass at rest, about the origin"),
    "potential": ("scalar", "element", "", "", "potential of gravity [energy]"),
    "strain": ("scalar", "element", "", "V", "strain energy, (24) [energy]"),
    "mass": ("scalar", "element", "masses", "m", "mass of the body"),
    # directions of a variation: d is the differential of position, velocity or acceleration
    "dx": ("vector", "position", "dqe", "R0^T delta x_i", "variation of a position, frame axes"),
    "dv": ("vector", "position", "dve", "R0^T delta xdot_i", "variation of a velocity"),
    "da": ("vector", "position", "dae", "R0^T delta xddot_i", "variation of an acceleration"),
    "dth": ("axial", "rotation", "dqe", "delta Theta_j", "material variation of a rotation"),
    "dOm": ("axial", "rotation", "dve", "delta Omega_j", "variation of an angular velocity"),
    "dA": ("axial", "rotation", "dae", "delta A_j", "variation of an angular acceleration"),
    "dx0": ("vector", "element", "", "R0^T delta x_0", "variation of the origin, frame axes"),
    "dth0": ("axial", "element", "", "delta Theta_0", "material variation of the frame, (43)"),
}


class Quantities:
    """Access by name, ``q.psi``, to the quantities of `TABLE` in a given space."""

    def __init__(self, space: Space):
        self.space = space

    def __getattr__(self, name: str) -> Quantity:
        kind, home, array, _, _ = TABLE[name]
        return self.space.quantity(name, kind, home, array)
