"""The parts of a kernel: typed numbers, arrays, functions, steps and statements."""
