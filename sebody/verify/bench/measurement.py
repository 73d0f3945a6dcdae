"""Results of one benchmark run."""

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class Measurement:
    """Cost and error of one variant of a scene, from the same runs.

    Parameters
    ----------
    scene, variant : str
        What was run; variants of the peer begin with its name.
    unknowns : int
    h : float
        Time step.
    us_per_step : float
        Median over the runs [microseconds].
    iterations_per_step : float or None
    tip_error : float or None
        Relative L2 error of the tip's path, where a reference is known.
    flops_per_step : float or None
        From the operation counts of the kernels.
    wall_seconds : float
        Median time of a whole run; of an ensemble, of all its runs.
    thread_efficiency : float or None
        Of an ensemble, see `sebody.verify.bench.ensemble`.
    processor_seconds : float or None
        Of the peer's beams: what the processor worked, in the run with the least.
    energy_drift : float or None
        Of a conservative motion, see `sebody.verify.bench.following`.
    """

    scene: str
    variant: str
    unknowns: int
    h: float
    us_per_step: float
    iterations_per_step: float | None
    tip_error: float | None
    wall_seconds: float
    flops_per_step: float | None = None
    thread_efficiency: float | None = None
    processor_seconds: float | None = None
    energy_drift: float | None = None

    def as_dict(self) -> dict:
        """For JSON."""
        return asdict(self)
