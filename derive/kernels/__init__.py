"""Definition of a kernel: its steps in order, its name, and which kernels are shipped."""
