"""Studies over scenes and kernels: bench, chart, atlas, check."""
