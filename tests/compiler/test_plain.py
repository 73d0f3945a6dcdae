"""The plain way gives the numbers of the fast one: joints and a superelement.

Whole runs are in test_plain_runs.py, which continuous integration starts by itself.
"""

from plain_numbers import compared

KERNELS = ("element_planar_spring", "element_planar_on_line", "element_distance",
           "element_coincident_ground", "element_slide_drive", "element_planar_rigid_body",
           "superelement_planar_f2_converged_mean_material")
ROUNDING = 1e-12        # of numbers up to one: products and sums are fused in other places


def test_kernels_give_the_numbers_of_the_fast_way(tmp_path):
    differences, _ = compared(tmp_path, *KERNELS)
    assert len(differences) == len(KERNELS) * 2 * 5 * 3
    assert max(differences.values()) < ROUNDING
