"""What a type checker says of a user's program, and that public functions have types at all."""

import importlib
import inspect
import re
import subprocess
import sys
from pathlib import Path

import pytest
from pages import public_names

import sebody
import sebody.derive
import sebody.generated
import sebody.scenes

ROOT = Path(__file__).parents[1]
# a line of README's example, what a user may get wrong in it, and words of the remark on it
WRONG = (
    ('model = Model()', 'model = Model(planar="yes")', '"planar"'),
    ('model.beam("beam", (base, tip), section,', 'model.beam("beam", (base, tip), 3,', '"Section'),
    ('axis=(0, 0, 1), name="hinge")', 'axes=(0, 0, 1), name="hinge")', '"axes"'),
    ('simulate(model, h=0.01, t_end=30.0)', 'simulate(model, h="0.01", t_end=30.0)', '"h"'),
    ('result.summary()', 'result.summery()', '"summery"'),
)


def example() -> str:
    """The first program of the README that builds a model."""
    programs = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S)
    return next(text for text in programs if "Model()" in text)


@pytest.fixture(scope="module")
def remarks(request, tmp_path_factory):
    """Lines of mypy on the README's example, and on the same with mistakes, by file."""
    pytest.importorskip("mypy", reason='needs mypy: pip install "sebody[types]"')
    folder = tmp_path_factory.mktemp("types")
    package = folder / "sebody"         # as the wheel has it, not as a clone
    package.mkdir()
    for path in Path(sebody.__file__).parent.iterdir():
        if path.name != "__pycache__":
            (package / path.name).symlink_to(path)
    for part in (sebody.derive, sebody.generated, sebody.scenes):
        if not (package / part.__name__.rpartition(".")[2]).exists():
            (package / part.__name__.rpartition(".")[2]).symlink_to(Path(part.__file__).parent)
    right, wrong = example(), example()
    for good, bad, _ in WRONG:
        assert wrong.count(good) == 1, good
        wrong = wrong.replace(good, bad)
    (folder / "right.py").write_text(right)
    (folder / "wrong.py").write_text(wrong)
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--config-file", str(ROOT / "pyproject.toml"),
         "--cache-dir", str(request.config.cache.mkdir("mypy")), "right.py", "wrong.py"],
        cwd=folder, capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stdout + done.stderr
    lines = [line for line in done.stdout.splitlines() if ": error:" in line]
    return {name: [line for line in lines if line.startswith(name)]
            for name in ("right.py", "wrong.py")} | {"all": lines}


def test_the_example_of_the_readme_is_of_right_types(remarks):
    assert remarks["right.py"] == []


@pytest.mark.parametrize("good, bad, words", WRONG)
def test_a_wrong_argument_is_reported_where_it_is(remarks, good, bad, words):
    program = example().splitlines()
    line = 1 + next(k for k, text in enumerate(program) if good in text)
    found = [text for text in remarks["wrong.py"] if text.startswith(f"wrong.py:{line}:")]
    assert found and any(words in text for text in found), remarks["wrong.py"]


def test_nothing_else_is_reported(remarks):
    assert remarks["all"] == remarks["wrong.py"]
    assert len(remarks["wrong.py"]) == len(WRONG)


@pytest.mark.parametrize("door", public_names())
def test_public_functions_have_types(door):
    """Of all arguments and of what they return; methods of public classes, too."""
    module = importlib.import_module(door)
    without = []
    for name in module.__all__:
        offered = getattr(module, name)
        for function in _functions(offered):
            signature = inspect.signature(function)
            own = [one for one in signature.parameters.values() if one.name not in ("self", "cls")]
            if any(one.annotation is one.empty for one in own) or (
                    signature.return_annotation is signature.empty
                    and function.__name__ != "__init__"):
                without.append(f"{name}: {function.__qualname__}")
    assert not without


def _functions(offered: object) -> list:
    """A function, or those that a class of this package defines and that users call."""
    if inspect.isfunction(offered):
        return [offered]
    if not inspect.isclass(offered):
        return []
    return [function for name, function in vars(offered).items() if inspect.isfunction(function)
            and (name == "__init__" or not name.startswith("_"))
            and function.__module__.startswith("sebody.")]
