"""Numbers of a model that can be varied or set, by name: one table for all that vary them."""
