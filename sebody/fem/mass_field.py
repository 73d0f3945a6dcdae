"""How the mass of an FE model moves with its DOFs: points, their displacement and rotation."""

from dataclasses import dataclass

from numpy.typing import NDArray
from scipy import sparse

from sebody.errors import InputError


@dataclass(frozen=True, eq=False)
class MassField:
    """Points of mass: ``T = sum_pq m_pq v_p . v_q / 2 + sum_p w_p . J_p w_p / 2``.

    An FE mass matrix alone does not tell what turning the body does to its inertia: consistent
    masses of beams, for one, couple nodal rotations to displacements between the nodes. Where the
    matrix is a sum over points with a displacement (and a rotation) each, the products with
    the vectors that a rotation of the body makes of these are exact.

    Parameters
    ----------
    points : (p, 3), planar (p, 2)
        Undeformed positions [length].
    translation : (3 p, n_dofs), planar (2 p, n_dofs), sparse
        Displacements of the points from the DOFs.
    mass : (p, p), sparse
        Diagonal where points are those of an integration, m of a nodal mass ``m (x) I``.
    rotation : (3 p, n_dofs), planar (p, n_dofs), sparse, optional
        Rotation vectors of the points; none where no point has rotary inertia.
    inertia : (p, 3, 3), planar (p, 1, 1), optional
        Rotary inertia of the points in the model's axes [mass length^2].
    """

    points: NDArray
    translation: sparse.csr_array
    mass: sparse.csr_array
    rotation: sparse.csr_array | None = None
    inertia: NDArray | None = None

    def check(self, size: int, dimension: int) -> None:
        """Raise InputError unless the parts fit a model of `size` DOFs in so many dimensions."""
        count, angles = len(self.points), 1 if dimension == 2 else 3
        wanted = {"points": (count, dimension), "translation": (dimension * count, size),
                  "mass": (count, count), "rotation": (angles * count, size),
                  "inertia": (count, angles, angles)}
        for name, shape in wanted.items():
            part = getattr(self, name)
            if part is not None and part.shape != shape:
                raise InputError(f"mass_field.{name} has shape {part.shape}; {count} points of a "
                                 f"model with {size} DOFs need {shape}")
        if (self.rotation is None) != (self.inertia is None):
            raise InputError("mass_field has rotation or inertia without the other; give both")

    def matrix(self) -> sparse.csc_array:
        """The FE mass matrix these points make, (n_dofs, n_dofs)."""
        dimension = self.points.shape[1]
        weights = sparse.kron(self.mass, sparse.eye_array(dimension))
        total = self.translation.T @ weights @ self.translation
        if self.rotation is not None:
            total = total + self.rotation.T @ sparse.block_diag(list(self.inertia)) @ self.rotation
        return sparse.csc_array(total)


def nodal_field(mass: sparse.csc_array, coordinates: NDArray) -> MassField | None:
    """The nodes of a model without rotations as points; None unless its mass is ``m (x) I``."""
    dimension = coordinates.shape[1]
    by_axes = [[mass[i::dimension, k::dimension] for k in range(dimension)]
               for i in range(dimension)]
    largest = abs(mass).max()
    for i in range(dimension):
        for k in range(dimension):
            rest = by_axes[i][k] - by_axes[0][0] if i == k else by_axes[i][k]
            if rest.nnz and abs(rest).max() > _ROUNDING * largest:
                return None
    return MassField(coordinates, sparse.eye_array(mass.shape[0], format="csr"),
                     sparse.csr_array(by_axes[0][0]))


_ROUNDING = 1e-12  # of an assembled matrix, relative to its largest entry
