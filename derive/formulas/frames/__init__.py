"""Floating frames, one file each; `sebody.derive.kernels.manifest` lists them."""
