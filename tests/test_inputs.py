"""The checks at the boundary: what they let pass, in which form, and what they say otherwise."""

import math
from fractions import Fraction

import numpy as np
import pytest

from sebody import InputError
from sebody.basics import inputs

TURN = np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])


class Silent:
    """An object that cannot even be shown."""

    def __repr__(self):
        raise RuntimeError("no text")


@pytest.mark.parametrize("given, expected", [
    (lambda: inputs.number(3, "n"), 3.0), (lambda: inputs.number(np.float32(0.5), "n"), 0.5),
    (lambda: inputs.number(np.array(2), "n"), 2.0),
    (lambda: inputs.number(Fraction(1, 4), "n"), 0.25),
    (lambda: inputs.number(0, "n", least=0), 0.0), (lambda: inputs.number(1, "n", most=1), 1.0),
    (lambda: inputs.integer(np.int8(4), "n", least=1), 4), (lambda: inputs.integer(4.0, "n"), 4),
    (lambda: inputs.integer(2**70, "n"), 2**70), (lambda: inputs.flag(np.True_, "f"), True),
    (lambda: inputs.name("two words", "n"), "two words"),
    (lambda: inputs.choice("b", "c", ("a", "b")), "b"),
    (lambda: inputs.choice(2.0, "c", (3, 2)), 2),
    (lambda: inputs.items(range(3), "i", "give some"), [0, 1, 2])])
def test_what_is_let_pass(given, expected):
    found = given()
    assert found == expected and type(found) is type(expected)


def test_arrays_are_copies_of_floats():
    own = np.array([1.0, 2.0])
    found = inputs.vector(own, "v", 2)
    found[0] = 9.0
    assert own[0] == 1.0
    assert inputs.vector([1, Fraction(1, 2)], "v").tolist() == [1.0, 0.5]
    assert inputs.array([[1, 2]], "A", (None, 2)).dtype == float
    assert inputs.vector([], "v").shape == (0,)
    assert (inputs.rotation(TURN, "R") == TURN).all()
    assert (inputs.rotation(TURN[:2, :2], "R", 2) == TURN[:2, :2]).all()


NOT_NUMBERS = ("1", None, True, 1j, math.nan, math.inf, 10**400, [1.0], np.array([1.0]), {},
               Silent(), np.array("1"), object, b"1")


@pytest.mark.parametrize("value", NOT_NUMBERS, ids=lambda value: type(value).__name__)
def test_what_is_no_number(value):
    for check in (inputs.number, inputs.integer):
        with pytest.raises(InputError, match=r"^step is .*: give a (finite|whole) number$"):
            check(value, "step")
    with pytest.raises(InputError, match=r"^point is .*: give 3 finite numbers$"):
        inputs.vector((0.0, value, 1.0), "point", 3)


@pytest.mark.parametrize("refused, message", [
    (lambda: inputs.number(0, "mass", above=0), "^mass is 0: give a positive number$"),
    (lambda: inputs.number(-1, "k", least=0), "^k is -1: give a finite number >= 0$"),
    (lambda: inputs.number(0.5, "nu", above=-1, below=0.5), "nu is 0.5: give a finite number > -1 "
                                                            "and < 0.5$"),
    (lambda: inputs.number(2, "rho", least=0, most=1, remedy="use less"), "^rho is 2: use less$"),
    (lambda: inputs.integer(2.5, "n", least=1), "^n is 2.5: give a whole number >= 1$"),
    (lambda: inputs.integer(5, "n", least=0, most=4), "n is 5: give a whole number >= 0 and <= 4$"),
    (lambda: inputs.vector("123", "v", 3), "^v is '123': give 3 finite numbers$"),
    (lambda: inputs.vector(("1", "2"), "v", 2), "v is .'1', '2'.: give 2 finite numbers"),
    (lambda: inputs.vector((True, False), "v", 2), "give 2 finite numbers"),
    (lambda: inputs.vector((1, 2, 3), "v", 2), r"v is \(1, 2, 3\): give 2 finite numbers"),
    (lambda: inputs.vector(5.0, "v"), "v is 5.0: give a list of finite numbers"),
    (lambda: inputs.array([[1, 2], [3]], "A", (2, 2)), "A is .*: give 2 x 2 finite numbers"),
    (lambda: inputs.array([[1, 2, 3]], "A", (None, 2)), r"A has shape \(1, 3\): give rows of 2"),
    (lambda: inputs.array([[1, np.nan]], "A", (1, 2)),
     r"A has the entry nan at \[0, 1\]: give 1 x 2 finite numbers"),
    (lambda: inputs.array([[1j]], "A", (1, 1)), "A is .*: give 1 x 1 finite"),
    (lambda: inputs.rotation(2 * TURN, "R"), "R must be a proper rotation .*orthonormalise"),
    (lambda: inputs.rotation(-np.eye(3), "R"), "R must be a proper rotation"),
    (lambda: inputs.rotation(np.eye(2), "R"), r"R has shape \(2, 2\): it must be a proper"),
    (lambda: inputs.flag(1, "planar"), "^planar is 1: give True or False$"),
    (lambda: inputs.flag("no", "planar"), "^planar is 'no': give True or False$"),
    (lambda: inputs.name(3, "name of a node"), "^name of a node is 3: give a text that is not"),
    (lambda: inputs.name(" ", "name"), "name is ' ': give a text"),
    (lambda: inputs.name("a\nb", "name"), "name is 'a.*b': give a text"),
    (lambda: inputs.name("n" * 201, "name"), "name is 'n*[.]{3}: it has 201 characters, give"),
    (lambda: inputs.choice("c", "what", ("a", "b")), "^what 'c' is unknown: use 'a' or 'b'$"),
    (lambda: inputs.choice([], "what", ("a", "b", "c")), r"^what \[\] is unknown: use 'a', 'b' or"),
    (lambda: inputs.choice(True, "index", (1, 2)), "^index True is unknown: use 1 or 2$"),
    (lambda: inputs.function(3, "load", "give a function"), "^load is 3: give a function$"),
    (lambda: inputs.instance(int, "n", int, "give one"), "^n is <class 'int'>: give one$"),
    (lambda: inputs.items("ab", "nodes", "give a list"), "^nodes is 'ab': give a list$"),
    (lambda: inputs.items(3, "nodes", "give a list"), "^nodes is 3: give a list$"),
    (lambda: inputs.items(np.array(3), "nodes", "give a list"), "^nodes is 3: give a list$"),
    (lambda: inputs.number(Silent(), "n"), "^n is of class Silent: give"),
    (lambda: inputs.number("x" * 500, "n"), "^n is 'x{56}[.]{3}: give"),
])
def test_what_is_said(refused, message):
    with pytest.raises(InputError, match=message):
        refused()


@pytest.mark.parametrize("value, message", [
    (None, "output file is None: give the path of a file"), (3, "output file is 3: give the path"),
    ("", "output file is '': give the path"), (b"a.npz", "is b'a.npz': give the path"),
    ("a.txt", "output file a.txt must end in .npz"), ("x" * 300 + ".npz", "cannot be a file .*too"),
    ("a\0.npz", "cannot be a file"), ("folder.npz", "folder.npz is a folder: give the path")])
def test_paths(value, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.npz").mkdir()
    with pytest.raises(InputError, match=message):
        inputs.path(value, "output file", (".npz",))
    assert inputs.path("new.npz", "output file", (".npz",)).name == "new.npz"
