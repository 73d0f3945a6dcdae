"""The kernels that are shipped: one table."""

SUPERELEMENTS = (
    # layout, frame, inertia option
    ("f2", "converged_mean", "b"),
    ("f2", "mean", "b"),
    ("f2", "mean_small", "b"),
    ("f2", "converged_mean", "a"),
    ("f2t1", "converged_mean", "b"),
    ("f2r1", "converged_mean", "b"),
    ("f3", "converged_mean", "b"),
    ("f2t1", "positions", "b"),
    ("t8", "positions", "b"),
    ("f8", "converged_mean", "b"),
    ("planar-f2", "converged_mean", "b"),
    ("planar-f2", "converged_mean", "a"),
    ("planar-f2", "positions", "b"),
    ("planar-f3", "converged_mean", "b"),
)
ELEMENTS = ("revolute_ground", "revolute", "spherical_ground", "spherical",
            "planar_spherical_ground", "planar_spherical", "force", "torque", "planar_force",
            "planar_torque")
