"""Many runs of one model: advice, ensembles, sweeps, charts; inspection of bodies."""
