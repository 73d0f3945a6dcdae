"""Scenes in files of a user: run like shipped ones, and their errors named by file and line."""

import inspect
import shlex

import numpy as np
import pytest

from sebody.catalogue import builder, scenes
from sebody.cli.entry import main
from sebody.cli.listing import meanings_of

PENDULUM = '''"""A pendulum of my own."""

from lengths import LENGTH
from sebody import Model
from sebody.scenes.scene import Scene


def build(mass: float, centre=(LENGTH, 0.0), *, gravity=9.81):
    """The scene.

    Parameters
    ----------
    mass : float
        Mass of the bob,
        without the rod.
    gravity
        Along -y.

    Raises
    ------
    InputError
        A mass of zero.
    """
    model = Model(planar=True)
    model.gravity((0.0, -gravity))
    base = model.node("base", (0.0, 0.0))
    model.fix(base, "position")
    model.rigid_body("bob", base, mass, 0.1, centre)
    model.attach("tip", centre, base)
    return Scene("mine", "pendulum", model, h=0.01, t_end=0.2)
'''


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A folder to work in, with a scene and a module that the scene imports."""
    (tmp_path / "mine.py").write_text(PENDULUM)
    (tmp_path / "lengths.py").write_text("LENGTH = 1.5\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_file_is_run_with_other_parameters(folder, capsys):
    assert main(["run", "mine.py", "--set", "mass=2", "--set", "centre=[2.0, 0.0]", "--every", "5",
                 "--output", "mine.npz"]) == 0
    assert capsys.readouterr().out.startswith("mine: pendulum\nunknowns             1\n")
    with np.load("mine.npz") as saved:
        assert saved["t"] == pytest.approx([0.0, 0.05, 0.1, 0.15, 0.2])     # 5 steps of 0.01
        assert saved["tip.position"][0] == pytest.approx([2.0, 0.0])
        # let go from the horizontal: the first acceleration is m g l / (m l^2 + I) of the angle
        fall = 0.5 * 2 * 9.81 * 2 / (2 * 2**2 + 0.1) * saved["t"][1]**2
        assert saved["tip.position"][1, 1] == pytest.approx(-2 * fall, rel=1e-2)


def test_parameters_are_listed_with_defaults_and_meaning(folder, capsys):
    assert main(["list", "mine.py"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "mine.py: A pendulum of my own.",
        "parameters, each with its default: change one by --set NAME=VALUE",
        "  mass               Mass of the bob, without the rod.",
        "  centre=(1.5, 0.0)",
        "  gravity=9.81       Along -y."]
    assert main(["list", "squeezer"]) == 0
    assert capsys.readouterr().out.splitlines()[1] == "it has no parameters"


def test_parameters_of_every_shipped_scene_have_a_meaning():
    for scene in scenes():
        build = builder(scene)
        meanings = meanings_of(build)
        assert list(meanings) == list(inspect.signature(build).parameters), scene
        assert all(meanings.values()), scene


MODEL = "from sebody import Model\nfrom sebody.scenes.scene import Scene\ndef build():\n    "
RETURN = "return Scene(name, summary, model, h, t_end), from sebody.scenes.scene"


@pytest.mark.parametrize("text, message", [
    ("x = 1\ny = (\n", "wrong.py, line 2: '(' was never closed"),
    ("import no_such_module\nbuild = 1\n", "wrong.py, line 1: ModuleNotFoundError: No module"),
    ("import sys\n\nsys.exit(0)\nbuild = 1\n", "wrong.py, line 3: SystemExit: 0"),
    ("x = 1\n", "scene file wrong.py has no function build: write 'def build() -> Scene' as in "),
    ("raise ValueError('it ran')\n", "scene file wrong.py has no function build: "),
    ("build = 1\n", "scene file wrong.py has no function build: "),
    ("def build():\n    pass\n", f"what build of wrong.py returned is None: {RETURN}"),
    (MODEL + "return Model()\n", "what build of wrong.py returned is"),
    (MODEL + "return 1 / 0\n", "wrong.py, line 4: ZeroDivisionError: division by zero"),
    (MODEL + "Model().node('a', 3)\n", "wrong.py, line 4: "),
    (MODEL + "return Scene('a', '', None, 0.1, 1.0)\n", "the model of wrong.py is None: give Scene "
     "a sebody.Model"),
    (MODEL + "return Scene('a', '', Model(), 0.0, 1.0)\n", "h of the scene of wrong.py is 0.0: "
     "give a positive number"),
    (MODEL + "return Scene('a', '', Model(), 0.1, '1')\n", "t_end of the scene of wrong.py is '1'"),
])
def test_errors_in_a_file_are_named_with_their_line(folder, capsys, text, message):
    (folder / "wrong.py").write_text(text)
    assert main(["run", "wrong.py"]) == 2
    assert capsys.readouterr().err.startswith("error: " + message)


@pytest.mark.parametrize("arguments, message", [
    (["none.py"], "scene file none.py does not exist: give the name "),
    (["mine.py"], "scene 'mine.py' needs mass: give --set mass=VALUE"),
    (["mine.py", "--set", "size=1"], "scene 'mine.py' has no parameter 'size': there are mass, "
     "centre=(1.5, 0.0), gravity=9.81"),
    (["mine.py", "--set", "mass=1", "--set", "gravity=strong"], "parameter gravity is 'strong': "
     "give a value of type float, such as 9.81"),
    (["hinged-beam", "--every", "0"], "output_every is 0: give a whole number"),
    (["hinged-beam", "--every", "2", "--accuracy", "1e-3"], "with --accuracy --step is the grid"),
    (["hinged-beam", "--every", "2", "--resume", "a.npz"], "--resume continues with the every "
                                                           "that"),
])
def test_arguments_that_do_not_fit(folder, capsys, arguments, message):
    assert main(["run", *arguments]) == 2
    assert capsys.readouterr().err.startswith("error: " + message)


def test_nodes_of_the_picture_are_looked_for_before_the_run(folder, capsys):
    (folder / "other.py").write_text(PENDULUM.replace("t_end=0.2", "t_end=0.2, tip='top'"))
    assert main(["run", "other.py", "--set", "mass=1", "--plot", "a.png"]) == 2
    assert capsys.readouterr().err.startswith(
        "error: the picture shows node 'top', which scene 'mine' does not have: give its Scene "
        "base= and tip=, of base, tip")


def test_a_new_scene_runs_sweeps_and_is_advised_on(tmp_path, monkeypatch, capsys):
    """By the commands that its first lines say, on the shortest of runs."""
    monkeypatch.chdir(tmp_path)
    assert main(["new", "my arm.py"]) == 0
    said = capsys.readouterr().out
    assert said.startswith("scene: my arm.py\nrun it: sebody run 'my arm.py' --output run.npz")
    text = (tmp_path / "my arm.py").read_text()
    assert "FILE.py" not in text
    lines = [line for line in text.splitlines() if line.startswith("    sebody ")]
    shown = [shlex.split(line.replace("my arm.py", "'my arm.py'"))[1:] for line in lines]
    assert [words[0] for words in shown] == ["run", "animate", "sweep", "advise"]
    for words in shown:
        thin = {"sweep": ["--t-end", "0.1"], "advise": ["--t-end", "0.1"]}.get(words[0], [])
        assert main([*words, *thin]) == 0, words
    said = capsys.readouterr()
    assert not said.err, said.err
    assert "5 of 5 runs done, 0 failed" in said.out and "confirmed error" in said.out


def test_a_new_scene_replaces_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.py").write_text("mine")
    for path, message in (("mine.py", "scene mine.py exists: give another name, or remove the"),
                          ("none/mine.py", "folder none of the scene does not exist: make it"),
                          ("mine.txt", "scene mine.txt must end in .py")):
        assert main(["new", path]) == 2
        assert message in capsys.readouterr().err
    assert (tmp_path / "mine.py").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["mine.py"]
