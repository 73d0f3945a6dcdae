"""The data of the page of an animation against the result that it is made of."""

import moving_arm
import numpy as np
import pytest
from numpy.testing import assert_allclose
from page_data import PageData
from scipy.spatial.transform import Rotation

from sebody import InputError, Model, simulate
from sebody.fem import rectangle
from sebody.pictures import drawn_bodies, page_plots
from sebody.pictures.curves import values
from sebody.quantities.names import names
from sebody.results import animate

STEP = 1 / 65535        # of the range of a column


@pytest.fixture(scope="module")
def arm():
    return moving_arm.run()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pages")


@pytest.fixture(scope="module")
def page(arm, folder):
    return PageData(animate(arm, folder / "arm.html", "tip.velocity").read_text())


def test_every_quantity_of_the_result_can_be_plotted(arm, page):
    plots = page.header["plots"]
    frames = page.indices(plots["frames"])
    assert frames.tolist() == list(range(101)) and plots["left"] == 0
    found = {plot["name"]: plot for plot in plots["all"]}
    assert set(names(arm)) - {"t"} <= set(found) and {"energy", "constraints"} <= set(found)
    assert plots["all"][0]["name"] == "tip.velocity" and plots["all"][0]["owner"] == "overview"
    for name, plot in found.items():
        exact = values(arm, name)
        assert tuple(plot["labels"]) == exact.labels
        span = np.ptp(exact.numbers, axis=0)
        # half a step of each column, and rounding of its range
        assert (np.abs(page.values(plot["values"]) - exact.numbers) <= 0.51 / 16383 * span
                + 1e-11 * np.abs(exact.numbers).max(axis=0)).all(), name
    owners = {plot["name"]: plot["owner"] for plot in plots["all"]}
    assert owners["energy.kinetic"] == owners["momentum"] == "model"
    assert owners["upper 1.base.force"] == "upper 1.base"
    units = {plot["name"]: plot["unit"] for plot in plots["all"]}
    assert units["energy"] == "force length" and units["tip.rotation"] == "rad"
    assert units["gust.force"] == "force"


def test_quantities_without_room(arm, folder, monkeypatch):
    """Those that are chosen come first, then positions and forces; samples are thinned."""
    monkeypatch.setattr(page_plots, "NUMBERS", 60 * 201)
    page = PageData(animate(arm, folder / "few.html", "energy").read_text())
    plots = page.header["plots"]
    kept = [plot["name"] for plot in plots["all"]]
    columns = sum(len(plot["labels"]) for plot in plots["all"])
    # all but the time, and two groups, of which one is there twice
    assert 55 < columns <= 60 and plots["left"] == len(names(arm)) - 1 + 2 - (len(kept) - 1)
    assert "tip.position" in kept and "tip.acceleration" not in kept


def test_long_histories_are_thinned(folder):
    model = Model(planar=True)
    model.node("a", (0, 0), "translation")
    model.point_mass("m", "a", 1.0)
    model.gravity((0, -9.81))
    result = simulate(model, 1e-3, 4.0)
    page = PageData(animate(result, folder / "long.html").read_text())
    frames = page.indices(page.header["plots"]["frames"])
    t = page.values(page.header["t"])[:, 0]
    assert len(t) <= 1801 and t[-1] == pytest.approx(4.0) and frames[-1] == len(t) - 1
    plot = next(one for one in page.header["plots"]["all"] if one["name"] == "a.position")
    assert_allclose(page.values(plot["values"])[:, 1], -9.81 / 2 * t[frames]**2,
                    atol=0.6 * 78.5 / 16383)        # half a step of the plot


def of_stations(page, body, frame):
    """Displacements of the stations from the frame, and the undeformed body at its reference."""
    a = page.values(body["amplitudes"])[frame]
    moved = (page.values(body["moves"]) @ a).reshape(3, -1).T
    points, size = page.vectors(body["points"]), page.header["size"]
    held = next(one for one in body["held"] if one["node"] == body["reference"])

    def of(columns):
        return np.array([0.0 if k < 0 else a[k] for k in columns])
    E = Rotation.from_rotvec(of(held["rotation"])).as_matrix()
    still = np.array(held["point"]) + of(held["position"]) / size + (
        points - held["point"]) @ E.T
    return size * (points + moved - still)


def test_displacements_from_the_support_follow_from_the_data(arm, page):
    """Of bodies that have their reference: against the field of the result, at FE nodes."""
    bodies = {body["name"]: body for body in page.header["bodies"]}
    nodes = [node["name"] for node in page.header["nodes"]]
    references = {name: body["reference"] and nodes[body["reference"]]
                  for name, body in bodies.items()}
    assert references == {"upper 1": "base", "upper 2": "base", "fore 1": "fork",
                          "fore 2": "fork", "bob": None}
    for name in ("upper 1", "fore 1"):
        field, labels = arm.field(name), page.indices(bodies[name]["labels"])
        # shapes and amplitudes are in steps of their range; the reference has this error, too
        moves, a = (page.values(bodies[name][one]) for one in ("moves", "amplitudes"))
        seen = 2 * STEP * page.header["size"] * (
            np.abs(a).max(axis=0) * np.ptp(moves, axis=0)
            + np.ptp(a, axis=0) * np.abs(moves).max(axis=0)).sum() + 1e-4 * np.abs(
            field.displacement(60)).max()       # amplitudes of less than 1e-5 of the largest
        for frame in (30, 60, 100):
            exact = field.displacement(frame, axes="body")
            found = of_stations(page, bodies[name], frame)
            lengths = np.linalg.norm(exact, axis=1)
            ours = np.linalg.norm(found, axis=1)
            # amplitudes and shapes in steps of their range
            assert_allclose(ours[labels > 0], lengths[labels[labels > 0] - 1],
                            atol=seen)
            assert lengths.max() > 300 * seen


def test_where_values_are_largest(arm, page):
    """Against envelopes of the fields over all recorded states."""
    fields = {field["name"]: field for field in page.header["fields"]}
    for name in ("displacement", "von_mises"):
        found = {body: arm.field(body).envelope(name) for body in arm.model.bodies}
        body = max(found, key=lambda one: found[one].largest)
        peak, drawn = fields[name]["peak"], page.header["bodies"]
        assert peak["value"] == pytest.approx(found[body].largest, rel=1e-6)
        assert drawn[peak["body"]]["name"] == body
        assert page.values(page.header["t"])[peak["frame"], 0] == pytest.approx(found[body].time)
        label = page.indices(drawn[peak["body"]]["labels"])[peak["station"]] - 1
        assert label == found[body].node
    stress = page.values(drawn[peak["body"]]["stress"])
    assert stress.max() == pytest.approx(1.0)


def test_stresses_of_large_bodies_are_of_some_frames(arm, folder, monkeypatch):
    """Every so many frames, those of the field; the largest one is among them."""
    monkeypatch.setattr(drawn_bodies, "STRESSES", 60)
    page = PageData(animate(arm, folder / "few.html").read_text())
    field = next(one for one in page.header["fields"] if one["name"] == "von_mises")
    largest = {}
    for body in page.header["bodies"][:4]:
        stress = field["largest"] * page.values(body["stress"])
        stride, labels = body["stride"], page.indices(body["labels"])
        assert stride == -(-101 * arm.field(body["name"]).count // 60)
        exact = [arm.field(body["name"]).von_mises(k) for k in range(0, 101, stride)]
        assert len(stress) == len(exact)
        for one, other in zip(stress, exact, strict=True):
            assert_allclose(one[labels > 0], other[labels[labels > 0] - 1],
                            atol=field["largest"] / 4000)
        rows = np.max(exact, axis=1)
        largest[rows.max()] = body["name"], stride * int(rows.argmax())
    peak = field["peak"]
    assert peak["value"] == pytest.approx(max(largest), rel=1e-6)
    assert (page.header["bodies"][peak["body"]]["name"], peak["frame"]) == largest[max(largest)]


def test_loads_are_arrows(arm, page):
    """Against directions and tables of the model; a follower turns with its node."""
    found = {arrow["name"]: arrow for arrow in page.header["arrows"]}
    t = arm.t
    exact = {"gust": np.interp(t, [0, 0.05], [10.0, 30.0])[:, None] * moving_arm.TURN[:, 1],
             "twist": np.interp(t, [0, 0.05], [0.0, -8.0])[:, None]
             * (arm["elbow.rotation"] @ moving_arm.TURN[:, 0])}
    assert {name: arrow["kind"] for name, arrow in found.items()} == {"gust": "force",
                                                                      "twist": "torque"}
    for name, values_of in exact.items():
        arrow = found[name]
        assert_allclose(arrow["largest"] * page.values(arrow["values"]), values_of,
                        atol=2 * STEP * 30)
        assert page.header["nodes"][arrow["node"]]["name"] == {"gust": "tip",
                                                               "twist": "elbow"}[name]
    gravity = moving_arm.GRAVITY
    assert_allclose(page.header["gravity"], gravity / np.linalg.norm(gravity))


def test_a_load_on_a_body_is_its_resultant(folder):
    from sebody.fem import straight_beam
    from sebody.reduction import craig_bampton

    beam = straight_beam((0, 0, 0), (2, 0, 0), rectangle(0.02, 0.03, 2.1e11, 0.3, 7800.0), 4)
    push = np.zeros(beam.stiffness.shape[0])
    push[2 * 6 + 1], push[1 * 6 + 2] = 3.0, 4.0      # y of node 2, z of node 1
    body = craig_bampton(beam, [(0, "full"), (4, "full")], 2, loads={"push": push})
    model = Model()
    model.superelement("beam", body, [model.node("a", (0, 0, 0)), model.node("b", (2, 0, 0))])
    model.body_load("beam", "push", [(0, 0.0), (0.01, 2.0), (1, 2.0)])
    model.fix("a")
    result = simulate(model, 1e-3, 0.02)
    page = PageData(animate(result, folder / "load.html").read_text())
    arrow, = page.header["arrows"]
    assert arrow["node"] is None and page.header["bodies"][arrow["body"]]["name"] == "beam"
    total = arrow["largest"] * page.values(arrow["values"])[-1]
    # the load turns with the frame of the bent beam
    assert_allclose(total, [0.0, 6.0, 8.0], atol=0.02)


def test_entries_are_bodies_and_whole_beams(page):
    entries, bodies = page.header["entries"], page.header["bodies"]
    assert [(one["name"], one["rigid"], [bodies[k]["name"] for k in one["bodies"]])
            for one in entries] == [("upper", False, ["upper 1", "upper 2"]),
                                    ("fore", False, ["fore 1", "fore 2"]), ("bob", True, ["bob"])]
    assert len({one["colour"] for one in entries}) == 3


def test_nodes_at_one_place(page):
    sets = {}
    for node in page.header["nodes"]:
        sets.setdefault(node["set"], []).append(node["name"])
    assert sorted(map(sorted, sets.values())) == sorted(map(sorted, [
        ["hub", "base"], ["elbow", "fork"], ["tip", "bob"], ["post"], ["upper 1"], ["fore 1"]]))
    fixed = {node["name"] for node in page.header["nodes"] if node["fixed"]}
    assert fixed == {"hub", "base", "post"}


def test_references_by_argument(arm, folder):
    def references(given):
        page = PageData(animate(arm, folder / "given.html", reference=given).read_text())
        nodes = [node["name"] for node in page.header["nodes"]]
        return [body["reference"] and nodes[body["reference"]] for body in page.header["bodies"]]
    assert references("elbow") == ["elbow", "elbow", "fork", "fork", None]
    assert references("frame") == [None] * 5
    with pytest.raises(InputError, match="displacements cannot be measured from 'post': give a "
                                         "node of a flexible body, base, elbow, fore 1, fork, "):
        references("post")


def test_colours_by_argument(arm, folder):
    page = PageData(animate(arm, folder / "given.html", colour="von_mises").read_text())
    assert page.header["colour"] == "von_mises"
    with pytest.raises(InputError, match="colour"):
        animate(arm, folder / "given.html", colour="stress")
    model = Model()
    model.rigid_body("stone", model.node("a", (0, 0, 0)), 1.0, [1, 1, 1])
    model.gravity((0, 0, -1))
    result = simulate(model, 0.1, 1.0)
    with pytest.raises(InputError, match="colour is 'von_mises', but the stresses of all "
                                         "bodies are unknown"):
        animate(result, folder / "stone.html", colour="von_mises")
    with pytest.raises(InputError, match="colour is 'displacement', but no body of the model has "
                                         "the cells"):
        animate(result, folder / "stone.html", colour="displacement")
