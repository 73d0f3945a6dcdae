"""The page of the paper's figures: what its table says, and that the page is drawn."""

import matplotlib.image
import pytest

from sebody.scenes import paper_figures


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    path = tmp_path_factory.mktemp("page") / "figures.png"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sys.argv", ["paper_figures.py", str(path)])
        seen = {}
        patch.setattr(paper_figures, "draw", lambda *a, draw=paper_figures.draw: (
            seen.update(zip(("hinged", "spherical"), a, strict=False)), draw(*a)))
        paper_figures.main()
    return path, seen


def test_table(page):
    """What the paper says of its figures, and what is known of these scenes."""
    hinged, spherical = page[1]["hinged"], page[1]["spherical"]
    at_base, at_tip, mean_b = (paper_figures.error(hinged, name) for name in (
        "node at the base", "node at the tip", "mean frame, B"))
    assert at_base == pytest.approx(2.9e-3, rel=0.1) and at_tip < at_base
    assert mean_b == pytest.approx(8.9e-4, rel=0.05)
    assert paper_figures.error(spherical, "mean frame, B") < 6e-4
    late = spherical["mean frame, A"].t > 20.0
    # option A's spurious rate after the impulse, and B's
    a, b = (spherical[f"mean frame, {o}"].rate[late] for o in "AB")
    assert a.max() == pytest.approx(0.39, abs=0.02) and a.min() == pytest.approx(-0.21, abs=0.02)
    assert b.max() == pytest.approx(0.052, abs=0.003)
    assert b.min() == pytest.approx(-0.010, abs=0.003)


def test_picture(page):
    image = matplotlib.image.imread(page[0])
    assert image.shape[0] > 1000 and image[..., :3].std() > 0.05
