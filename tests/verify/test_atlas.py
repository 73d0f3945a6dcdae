"""Every number of the atlas; warnings fire in their cases and in no regular scene."""

import math
import re
import warnings
from importlib import import_module

import numpy as np
import pytest
from matplotlib.figure import Figure

from sebody import LimitWarning, Simulation, generalized_alpha, hht, simulate
from sebody.catalogue import kernel_files, scenes
from sebody.cli.entry import main
from sebody.runs.limits.watch import spin_limit
from sebody.scenes import heavy_top, hinged_beam, spherical_beam_strong, spin_up
from sebody.verify import atlas
from sebody.verify.atlas.beams import arm
from sebody.verify.atlas.finding import Row
from sebody.verify.atlas.theory import cantilever, divergence


@pytest.mark.parametrize("name", atlas.CASES)
def test_numbers_known_beforehand_are_measured(name, tmp_path, monkeypatch):
    finding = atlas.explore(name)
    check_picture(finding, tmp_path / "case.png", monkeypatch)
    assert finding.rows and finding.curves and finding.theory and finding.program
    wrong = [row for row in finding.rows if not row.passed]
    assert not wrong, wrong


def check_picture(finding, path, monkeypatch):
    """One line explains it, no text leaves it, and it shows more than a step."""
    figures, save = [], Figure.savefig
    monkeypatch.setattr(Figure, "savefig", lambda figure, *args, **options: (
        figures.append(figure), save(figure, *args, **options)))
    atlas.draw([finding], path)
    figure, = figures
    axes, = figure.axes
    figure.draw_without_rendering()         # at its own resolution, not that of the file
    assert finding.line and "\n" not in finding.line
    texts = [*axes.texts, axes.title, axes._left_title, axes.xaxis.label, axes.yaxis.label,
             axes.xaxis, axes.yaxis, *([axes.legend_] if axes.legend_ else [])]
    assert finding.line in [text.get_text() for text in axes.texts]
    for one in texts:
        box = one.get_tightbbox()
        assert box is None or (box.x0 >= 0.0 and box.x1 <= figure.bbox.x1 and box.y0 >= 0.0
                               and box.y1 <= figure.bbox.y1), one
    assert max(len(np.unique(y)) for _, y in finding.curves.values()) > 2
    check_styles(finding, axes)


def check_styles(finding, axes):
    """Theory is dashed in one colour, which nothing that is measured has."""
    assert set(finding.predicted) < set(finding.curves)
    lines = {line.get_label(): line for line in axes.lines}
    theory = {lines[label].get_color() for label in finding.predicted}
    assert len(theory) == 1
    for label, (x, _) in finding.curves.items():
        line = lines[label]
        if label in finding.predicted:
            assert line.get_linestyle() == "--" and (len(x) == 1) == (line.get_marker() == "x")
        else:
            assert line.get_linestyle() == "-" and line.get_color() not in theory


def test_kernels_that_are_compiled_at_once_exist():
    assert set(atlas.KERNELS) <= set(kernel_files())


def test_rows_can_fail():
    assert Row("", 1.0, 1.05, 0.1).passed and not Row("", 1.0, 1.2, 0.1).passed
    assert Row("", 0.0, 1e-3, 1e-2).passed and not Row("", 0.0, 1.0, 1e-2).passed
    assert Row("", math.inf, math.inf, 0.1).passed and not Row("", math.inf, 2.0, 0.1).passed
    assert not Row("", 1.0, math.nan, 0.1).passed


def test_page_and_table(tmp_path, capsys):
    page = tmp_path / "atlas.png"
    assert main(["atlas", "collinear", "damping", "--output", str(page)]) == 0
    out = capsys.readouterr().out
    assert "collinear: nearly collinear nodes" in out
    assert re.search(r"offset 0.3: turn +theory +3.33333e-06 +measured 3.33", out)
    assert re.search(r"offset 1e-08: refused +program +1 +measured 1 +ok", out)
    assert "DIFFERS" not in out and page.stat().st_size > 10_000
    assert main(["atlas", "moon"]) == 2
    assert "the atlas has no case 'moon': there are divergence" in capsys.readouterr().err
    assert main(["atlas", "damping", "--output", str(tmp_path / "a.txt")]) == 2


def warned(run):
    with warnings.catch_warnings(record=True) as found:
        warnings.simplefilter("always")
        run()
    return [str(w.message) for w in found if issubclass(w.category, LimitWarning)]


@pytest.mark.parametrize("name", scenes())
def test_regular_scenes_are_not_warned(name):
    scene = import_module(f"sebody.scenes.{name.replace('-', '_')}").build()
    t_end = min(scene.t_end, 400 * scene.h) if name in ("four-bar", "squeezer") else scene.t_end
    assert warned(lambda: simulate(scene.model, scene.h, t_end)) == []


def test_spin_is_warned_of_once():
    scene = spin_up.build("kane", 1, frame="node", inertia="material")
    run = Simulation(scene.model, 0.01)

    def go():
        for t in (9.0, 9.5, 10.0):
            run.run_to(t)
    messages = warned(go)
    spins = [m for m in messages if m.startswith("spin ")]
    assert len(spins) == 1
    assert "is above the limit 2.48 of body 'arm'" in spins[0]
    assert "divide the body in two" in spins[0]
    assert run.result().warnings == tuple(messages)
    assert "WARNING              spin" in run.result().summary()


@pytest.mark.parametrize("frame", ["node", "mean"])
def test_the_limit_of_one_body_is_that_of_theory(frame):
    body = arm(1, frame).bodies["arm"]
    limit = divergence(cantilever(1, frame), option_b=True)
    assert spin_limit(body, np.array([0.0, 0.0, 1.0])) == pytest.approx(limit, rel=1e-6)
    assert spin_limit(body, None) <= limit


def test_spin_about_any_axis_of_a_beam_in_space():
    run = Simulation(spherical_beam_strong.build(inertia="material").model, 0.005)
    messages = warned(lambda: run.run_to(30.0))
    assert any("of body 'beam'" in m and m.startswith("spin") for m in messages)


def test_local_rotation_is_warned_of():
    scene = hinged_beam.build(elements=4)
    scene.model.force("tip", (0.0, 0.0, 1.0), [(0.0, 0.0), (0.05, 2e4), (0.1, 0.0)])
    messages = warned(lambda: Simulation(scene.model, 0.001).run_to(0.3))
    assert any(m.startswith("local rotation") and "of body 'beam' exceeds the linear range" in m
               for m in messages)


def test_schemes_without_damping_are_warned_of():
    def start(scheme, explicit):
        return warned(lambda: Simulation(heavy_top.build(explicit).model, 1e-3, scheme))
    for scheme in (hht(0.0), generalized_alpha(1.0)):
        assert "oscillate and grow" in start(scheme, True)[0]
        assert start(scheme, False) == []       # no multipliers
    assert start(hht(0.0, index=2), True) == [] and start(hht(-0.01), True) == []


def test_flat_bodies_are_warned_of():
    from sebody.verify.atlas.geometry import triangle
    assert warned(lambda: Simulation(triangle(0.1), 0.01)) == []
    messages = warned(lambda: Simulation(triangle(1e-4), 0.01))
    assert len(messages) == 1
    assert messages[0].startswith("nodes of body 'plate' lie nearly on a line (spread ")
