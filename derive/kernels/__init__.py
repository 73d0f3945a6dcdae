"""What a kernel is: its steps in order, its name, and which kernels are shipped."""
