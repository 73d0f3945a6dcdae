"""Runs of models: simulations, starts, schemes, restarts, equilibria."""
