"""Functions that generated code may call, its signature, and the loader of kernels."""
