"""The bar of a run: rate, time left, repeated runs, and where it is not shown."""

import io
import re
from contextlib import redirect_stderr

import pytest

from sebody import InputError, Simulation, Tolerance, simulate, simulate_within
from sebody.basics import progress
from sebody.scenes import hinged_beam


class Terminal(io.StringIO):
    def isatty(self):
        return True


def lines(calls, t_end, monkeypatch):
    """What is shown on a terminal after calls (seconds, part)."""
    times = iter((0.0, *(seconds for seconds, _ in calls)))
    monkeypatch.setattr(progress.time, "perf_counter", times.__next__)
    stream = Terminal()
    with redirect_stderr(stream):
        bar = progress.Progress(t_end)
        for _, part in calls:
            bar(part)
        bar.close()
    return [re.sub(r"^\[.*\] +", "", line).rstrip() for line in
            stream.getvalue().removesuffix("\n").split("\r")[1:]]


def test_rate_and_time_left(monkeypatch):
    assert lines([(2.0, 0.1), (4.0, 0.2), (12.0, 0.4)], 50.0, monkeypatch) == [
        "10 %  t = 5 of 50", "20 %  t = 10 of 50, 2.5 a second, 16 s left",
        "40 %  t = 20 of 50, 1.5 a second, 20 s left"]
    assert lines([(2.0, 0.0), (3.0, 1e-4)], 1.0, monkeypatch)[1] == (
        "0 %  t = 0.0001 of 1, 0.0001 a second, 2 h 46 min left")
    assert lines([(2.0, 0.0), (3.0, 0.01)], 1.0, monkeypatch)[1].endswith("1 min 39 s left")


def test_a_run_that_goes_on_is_timed_from_where_it_begins(monkeypatch):
    shown = lines([(2.0, 0.5), (4.0, 0.6)], 10.0, monkeypatch)
    assert shown[1] == "60 %  t = 6 of 10, 0.5 a second, 8 s left"


def test_repeated_runs_are_counted(monkeypatch):
    shown = lines([(2.0, 0.5), (4.0, 1.0), (6.0, 0.25)], 8.0, monkeypatch)
    assert shown[2] == "25 %  t = 2 of 8, 1 a second, 6 s left, run 2"


def test_python_shows_a_bar_when_asked(monkeypatch):
    monkeypatch.setattr(progress, "PATIENCE", 0.0)

    def model():
        return hinged_beam.build(modes=2, elements=4).model
    runs = {"simulate": lambda **how: simulate(model(), 0.01, 0.2, **how),
            "run_to": lambda **how: Simulation(model(), 0.01).run_to(0.2, **how),
            "within": lambda **how: simulate_within(model(), 0.01, 0.2, Tolerance(1e-3), **how)}
    for name, run in runs.items():
        stream, pipe = Terminal(), io.StringIO()
        with redirect_stderr(stream):
            run(progress=True)
        assert "100 %  t = 0.2 of 0.2" in stream.getvalue(), name
        assert stream.getvalue().endswith("\n")
        with redirect_stderr(pipe):
            run(progress=True)
        with redirect_stderr(stream):
            before = stream.getvalue()
            run(progress=False)
        assert (pipe.getvalue(), stream.getvalue()) == ("", before), name
        with pytest.raises(InputError, match="progress is 'yes': give a function of the part"):
            run(progress="yes")
