"""The kernels that are shipped: one table of superelements, and all others.

A kernel fuses one frame and one inertia option, so the loop makes one call an element and the
compiler sees all of its arithmetic. The formulas are derived once for each and only combined here:
sources add, and files multiply no further than this table; any other combination is made on demand.
"""

from sebody.derive.kernels.body_load import BODY_LOADS
from sebody.derive.kernels.catalogue import ELEMENTS as CATALOGUE
from sebody.derive.kernels.motion import MOTIONS

SUPERELEMENTS = (
    # layout, frame, inertia option; pinned numbers of modes where beams mostly need no others
    ("f2", "converged_mean", "b"),
    ("f2d", "converged_mean", "b"),
    ("f2m4", "converged_mean", "b"),
    ("f2m8", "converged_mean", "b"),
    ("f2", "mean", "b"),
    ("f2", "mean_small", "b"),
    ("f2", "converged_mean", "a"),
    ("f2t1", "converged_mean", "b"),
    ("f2t1", "positions", "b"),
    ("planar-f2", "converged_mean", "b"),
    ("planar-f2d", "converged_mean", "b"),
    ("planar-f2m2", "converged_mean", "b"),
    ("planar-f2m4", "converged_mean", "b"),
    ("planar-f2", "converged_mean", "a"),
    ("planar-f2", "positions", "b"),
    ("f2", "converged_mean", "c"),
    ("planar-f2", "converged_mean", "c"),
    ("planar-f2m2", "converged_mean", "c"),
    # for all other layouts: counts of nodes are read at run time
    ("any", "converged_mean", "b"),
    ("any", "positions", "b"),
    ("any", "mean", "b"),
    ("any", "mean_small", "b"),
    ("anyd", "converged_mean", "b"),
    ("anyd", "positions", "b"),
    ("planar-any", "converged_mean", "b"),
    ("planar-any", "positions", "b"),
    ("planar-anyd", "converged_mean", "b"),
    ("planar-anyd", "positions", "b"),
    ("any", "converged_mean", "c"),
    ("any", "positions", "c"),
    ("planar-any", "converged_mean", "c"),
    ("planar-any", "positions", "c"),
    ("any", "mean_axes", "c"),
    ("planar-any", "mean_axes", "c"),
    ("any", "converged_mean", "d"),
    ("any", "positions", "d"),
    ("planar-any", "converged_mean", "d"),
    ("planar-any", "positions", "d"),
)
ELEMENTS = (*CATALOGUE, *BODY_LOADS, *MOTIONS)
