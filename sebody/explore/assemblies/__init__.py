"""A model as one superelement: its small motion about an equilibrium, by that of some nodes.

The linearization has the matrices M, C, K on coordinates xi in which constraints are eliminated.
With the rows B of the interfaces (positions, then rotations in global axes),

    K Psi + B^T l = 0,  B Psi = 1                       static shapes               (1)
    N^T K N phi = w^2 N^T M N phi,  B N = 0             internal modes              (2)
    Phi = [Psi, N phi]                                                              (3)

the body has ``Phi^T M Phi``, ``Phi^T C Phi`` and ``Phi^T K Phi``. Everything inside moves as its
rows ``D = rows Phi`` of the reduced coordinates: nodes, bodies, their modes. All integrals of a
body's inertia are linear or quadratic in its shapes, so those of the whole are sums over the bodies
with the D of each.
"""
