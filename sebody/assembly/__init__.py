"""From a model to the arrays of the engine."""
