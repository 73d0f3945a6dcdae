"""What a user runs: simulations, equilibria, small motion about a state."""
