"""What derivation and runtime agree on: contents of all arrays, and names of kernels."""
