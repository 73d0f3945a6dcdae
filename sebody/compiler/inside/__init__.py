"""The fast way to compile: all that uses Numba beyond its public interface."""
