"""Floating frames, one file each; `sebody.derive.kernels.options` lists them."""
