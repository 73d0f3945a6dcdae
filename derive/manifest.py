"""The kernels that are shipped: one table."""

SUPERELEMENTS = (
    # layout, frame, inertia option
    ("f2", "converged_mean", "b"),
    ("f2", "mean", "b"),
    ("planar-f2", "converged_mean", "b"),
)
ELEMENTS = ("revolute_ground", "revolute", "force", "torque", "planar_force", "planar_torque")
