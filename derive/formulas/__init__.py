"""Formulas of superelements, joints, bodies and forces, each proved before it is used."""
