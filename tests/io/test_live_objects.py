"""FE models of live objects of scikit-fem and NGSolve, against each other and CalculiX."""

import numpy as np
import pytest
from scipy.linalg import eigh

from sebody import InputError
from sebody.fem import FEModel
from sebody.fem.stress import elasticity
from sebody.io import from_ngsolve, from_skfem
from sebody.io.importing import rigid_residual
from sebody.reduction import RigidFace, craig_bampton

E, NU, RHO = 2.1e6, 0.3, 7.8e-3
ENDS = (0.0, 141.42)


def skfem_model(mesh, element, material=(E, NU)):
    skfem = pytest.importorskip("skfem")
    from skfem.helpers import dot
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    basis = skfem.Basis(mesh, skfem.ElementVector(element), intorder=5)
    stiffness = linear_elasticity(*lame_parameters(E, NU)).assemble(basis)
    mass = skfem.BilinearForm(lambda u, v, w: RHO * dot(u, v)).assemble(basis)
    return from_skfem(basis, stiffness, mass, *material)


def beam():
    """The mesh of the CalculiX beam, of the same elements, with the same points of integration."""
    skfem = pytest.importorskip("skfem")
    across = np.linspace(-1.5, 1.5, 3)
    mesh = skfem.MeshHex.init_tensor(np.linspace(*ENDS, 25), across, across)
    return skfem_model(mesh, skfem.ElementHexS2())


@pytest.fixture(scope="module")
def two_bodies(beam_body):
    """The same beam by scikit-fem, its ends tied here, and by CalculiX, tied there."""
    model = beam()
    x = model.coordinates[:, 0]
    faces = [(RigidFace((end, 0, 0), np.flatnonzero(np.isclose(x, end))), "full") for end in ENDS]
    return craig_bampton(model, faces, 8), beam_body


def test_two_sources_give_the_same_body(two_bodies):
    squares = [eigh(body.stiffness, body.mass, eigvals_only=True)[6:14] for body in two_bodies]
    np.testing.assert_allclose(*np.sqrt(squares), rtol=1e-6)


def test_two_sources_give_the_same_inertia_and_stiffening(two_bodies):
    """What does not depend on how modes of equal frequency are turned, nor on scales of E."""
    found = []
    for body in two_bodies:
        one, held = body.invariants.about((70.71, 0.0, 0.0)), slice(0, 12)
        slaved = slice(len(body.mass), None)
        found.append([
            one.J0, one.h[:, :, held], one.K[:, held, held], one.J2[:, :, held, held],
            np.einsum("tb,bij->tij", one.S1[:, slaved], one.Q)[:, held, held],
            np.einsum("klb,bij->klij", one.h[:, :, slaved], one.Q)[:, :, held, held],
            np.einsum("ke,eij->kij", one.E, one.Ghat)[held, held, held]])
    for mine, theirs in zip(*found, strict=True):
        # fourteen digits of matrices whose condition takes six
        np.testing.assert_allclose(mine, theirs, atol=1e-6 * np.abs(mine).max())


def kinds():
    skfem = pytest.importorskip("skfem")
    box = np.linspace(0, 2, 3), np.linspace(0, 1, 2), np.linspace(0, 1, 2)
    hexahedra, tetrahedra = skfem.MeshHex.init_tensor(*box), skfem.MeshTet.init_tensor(*box)
    pairs = [(hexahedra, skfem.ElementHex1()), (hexahedra, skfem.ElementHexS2()),
             (hexahedra, skfem.ElementHex2()),
             (tetrahedra, skfem.ElementTetP1()), (tetrahedra, skfem.ElementTetP2())]
    for mesh, element in pairs:
        crooked = mesh.translated(0.03 * np.ones(3))
        crooked.p[:] += 0.05 * np.sin(3 * crooked.p[[1, 2, 0]])
        yield skfem_model(crooked, element)


def test_geometric_stiffness_turns_forces():
    """Turning a stressed body turns its internal forces: ``K_G(u) (e x X) = e x f(u)``."""
    rng = np.random.default_rng(5)
    for model in kinds():
        u = rng.standard_normal(model.stiffness.shape[0])
        tangent, forces = model.geometric_stiffness(u), (model.stiffness @ u)[model.rows]
        rows = model.rows.ravel()
        for axis in np.eye(3):
            turn, turned = np.zeros_like(u), np.zeros_like(u)
            turn[rows] = np.cross(axis, model.coordinates).ravel()
            turned[rows] = np.cross(axis, forces).ravel()
            np.testing.assert_allclose(tangent @ turn, turned, atol=1e-11 * np.abs(turned).max())


def test_node_sets_and_cells_of_scikit_fem():
    skfem = pytest.importorskip("skfem")
    mesh = skfem.MeshHex.init_tensor(*[np.linspace(0, 1, 3)] * 3).with_boundaries(
        {"left": lambda x: x[0] == 0.0})
    model = skfem_model(mesh, skfem.ElementHexS2(), material=())
    left = list(model.node_sets["left"])
    assert len(left) == 21 and not model.coordinates[left, 0].any()
    assert model.geometric_stiffness is None and model.mass_field is not None
    (kind, cells), = model.cells
    assert (kind, cells.shape) == ("hexahedron20", (8, 20))


def test_wrong_bases_are_refused():
    skfem = pytest.importorskip("skfem")
    mesh = skfem.MeshHex()
    eye = np.eye(8)
    with pytest.raises(InputError, match="the basis of ElementHex1 elements does not consist of"):
        from_skfem(skfem.Basis(mesh, skfem.ElementHex1()), eye, eye)
    with pytest.raises(InputError, match="basis is 3: give a Basis of an ElementVector"):
        from_skfem(3, eye, eye)
    vector = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex1()))
    with pytest.raises(InputError, match="give both youngs_modulus and poisson_ratio"):
        from_skfem(vector, np.eye(24), np.eye(24), 1.0)
    with pytest.raises(InputError, match=r"stiffness has shape \(8, 8\)"):
        from_skfem(vector, eye, eye)


@pytest.mark.parametrize("order", [1, 2])
def test_ngsolve_is_scikit_fem(order):
    """The same tetrahedra, of nodes in another order: equal matrices node by node."""
    ngsolve = pytest.importorskip("ngsolve", reason="large, an extra")
    skfem = pytest.importorskip("skfem")
    from netgen.csg import CSGeometry, OrthoBrick, Pnt

    geometry = CSGeometry()
    geometry.Add(OrthoBrick(Pnt(0, 0, 0), Pnt(3, 1, 1)).bc("side"))
    mesh = ngsolve.Mesh(geometry.GenerateMesh(maxh=1.0))
    space = ngsolve.VectorH1(mesh, order=order)
    u, v = space.TnT()
    strain, other = ((ngsolve.Grad(w) + ngsolve.Grad(w).trans) / 2 for w in (u, v))
    shear, lame = E / (2 * (1 + NU)), E * NU / (1 + NU) / (1 - 2 * NU)
    energy = (2 * shear * ngsolve.InnerProduct(strain, other)
              + lame * ngsolve.div(u) * ngsolve.div(v))
    mine = from_ngsolve(space, ngsolve.BilinearForm(energy * ngsolve.dx).Assemble(),
                        ngsolve.BilinearForm(RHO * u * v * ngsolve.dx).Assemble(), E, NU)
    points = np.array([vertex.point for vertex in mesh.vertices]).T
    cells = np.array([[v.nr for v in element.vertices] for element in mesh.Elements()]).T
    element = skfem.ElementTetP1() if order == 1 else skfem.ElementTetP2()
    theirs = skfem_model(skfem.MeshTet(points, cells), element)
    order = rows_of_the_same_nodes(mine, theirs)
    for name in ("stiffness", "mass"):
        one, two = getattr(mine, name), getattr(theirs, name)
        one = one[order][:, order]
        assert abs(one - two).max() < 1e-12 * abs(two).max()
    u = np.random.default_rng(1).standard_normal(len(order))
    back = np.empty_like(u)
    back[order] = u
    tangent = mine.geometric_stiffness(back)[order][:, order]
    assert abs(tangent - theirs.geometric_stiffness(u)).max() < 1e-10 * abs(tangent).max()
    assert len(mine.node_sets["side"]) > 8
    with pytest.raises(InputError, match="0 of them free|give VectorH1"):
        from_ngsolve(ngsolve.VectorH1(mesh, order=3), None, None)


def test_a_curved_mesh_of_ngsolve():
    """Middles of edges lie on the cylinder that the mesh is curved to; the matrices fit them."""
    ngsolve = pytest.importorskip("ngsolve", reason="large, an extra")
    from netgen.occ import Cylinder, OCCGeometry, Pnt, Z

    geometry = OCCGeometry(Cylinder(Pnt(1, 2, 3), Z, r=1, h=3))

    def read(curve, order):
        mesh = ngsolve.Mesh(geometry.GenerateMesh(maxh=1.0))
        if curve > 1:
            mesh.Curve(curve)
        space = ngsolve.VectorH1(mesh, order=order)
        u, v = space.TnT()
        strain, other = (ngsolve.Sym(ngsolve.Grad(w)) for w in (u, v))
        shear, lame = E / (2 * (1 + NU)), E * NU / (1 + NU) / (1 - 2 * NU)
        energy = (2 * shear * ngsolve.InnerProduct(strain, other)
                  + lame * ngsolve.Trace(strain) * ngsolve.Trace(other))
        return from_ngsolve(space, ngsolve.BilinearForm(energy * ngsolve.dx).Assemble(),
                            ngsolve.BilinearForm(RHO * u * v * ngsolve.dx).Assemble(), E, NU)
    model, straight = read(2, 2), read(1, 2)
    assert rigid_residual(model) < 1e-12
    radii = [np.hypot(*(one.coordinates[:, :2] - [1, 2]).T) for one in (model, straight)]
    outer = radii[0] > 1 - 1e-3         # parabolas leave the circle by a little
    assert outer.sum() > 1.2 * (radii[1] > 1 - 1e-3).sum() and radii[1][outer].min() < 0.97
    u = np.random.default_rng(2).standard_normal(model.stiffness.shape[0])
    wanted = model.stiffness @ u
    np.testing.assert_allclose(model.geometric_stiffness.forces(u), wanted,
                               atol=1e-10 * np.abs(wanted).max())
    assert model.geometric_stiffness.volume == pytest.approx(3 * np.pi, rel=2e-3)
    for curve, order, said in ((2, 1, r"take VectorH1\(mesh, order=2\) with mesh.Curve\(2\)"),
                               (3, 2, r"curved, of order 3, .*: call mesh.Curve\(2\)")):
        with pytest.raises(InputError, match=said):
            read(curve, order)


def rows_of_the_same_nodes(one: FEModel, other: FEModel):
    """Row of `one` that is the DOF of each row of `other`."""
    distances = np.linalg.norm(one.coordinates[:, None] - other.coordinates[None], axis=2)
    nodes = distances.argmin(axis=0)
    assert distances.min(axis=0).max() < 1e-12
    order = np.empty(one.stiffness.shape[0], dtype=int)
    order[other.rows.ravel()] = one.rows[nodes].ravel()
    return order


GRADIENT = 1e-3 * np.array([[0.3, -0.7, 0.2], [0.5, 0.4, -0.6], [-0.1, 0.8, -0.9]])


def test_models_know_their_stresses():
    """Of an affine displacement they are uniform."""
    strain = 1e-3 * np.array([0.3, 0.4, -0.9, 0.2, 0.1, -0.2])
    found = 0
    for model in kinds():
        one, = model.stress
        stress = one.stress((model.coordinates @ GRADIENT.T)[:, :, None])
        expected = np.broadcast_to(elasticity(E, NU) @ strain, stress.shape[:3])
        np.testing.assert_allclose(stress[..., 0], expected, rtol=1e-9)
        found += 1
    assert found == 5
    skfem = pytest.importorskip("skfem")
    assert skfem_model(skfem.MeshHex(), skfem.ElementHex1(), ()).stress == ()


def test_two_sources_give_the_same_stresses(two_bodies):
    """Of unit boundary coordinates, at all nodes, those that CalculiX ties and drops included."""
    found = []
    for body in two_bodies:
        recovery = body.recovery
        one, = recovery.stress
        shapes = recovery.shapes[:, :12].reshape(len(recovery.coordinates), -1, 12)
        values = one.at_nodes(one.stress(shapes))
        order = np.lexsort(recovery.coordinates.T.round(6))
        found.append(np.array([values[one.nodes == node].mean(axis=0) for node in order
                               if (one.nodes == node).any()]))
    mine, theirs = found
    assert mine.shape == theirs.shape and len(mine) == 741
    np.testing.assert_allclose(mine, theirs, rtol=0, atol=1e-6 * np.abs(mine).max())
