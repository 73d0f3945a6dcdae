"""Commands refuse what they cannot use: one line on standard error, exit code 2, no file."""

import os

import pytest

from sebody.cli.entry import main

BEAM, BODY = ("run", "hinged-beam"), ("run", "torque-free-body")
LONG = "x" * 300
FAILS = """from sebody.scenes.planar_hinged_beam import build as right


def build(n=1):
    if n > 1:
        raise ValueError("too many")
    return right(modes=0, elements=1)
"""

REFUSED = [
    (("reduce",), "required: SCENE, --interfaces, --output"),
    (("reduce", "hinged-beam", "--output", "b.npz", "--interfaces", "nowhere"), "node 'nowhere'"),
    (("reduce", "hinged-beam", "--output", "b.npz", "--interfaces", "tip", "tip"), "tip twice"),
    (("reduce", "hinged-beam", "--output", "b.txt", "--interfaces", "tip"), "b.txt"),
    (("reduce", "hinged-beam", "--output", "b.npz", "--interfaces", "tip", "--accuracy", "1e-3"),
     "--accuracy and --up-to belong together"),
    (("reduce", "hinged-beam", "--output", "b.npz", "--interfaces", "tip", "--modes", "2",
      "--accuracy", "1e-3", "--up-to", "10"), "leave out --modes"),
    ((), "COMMAND"), (("fly",), "command 'fly' is unknown: there are run, sweep"),
    (("--fast",), "COMMAND"),
    (("run",), "required: SCENE"), (("run", ""), "scene '' is unknown"),
    (("run", "beam"), "scene 'beam' is unknown: there are"),
    (("run", "../hinged_beam"), "is unknown: did you mean 'hinged-beam'"),
    (("run", "1"), "scene '1' is unknown"),
    (("run", "none.py"), "none.py does not exist"), (("run", "folder.py"), "folder.py"),
    (("run", "broken.py"), "broken.py"), (("run", "empty.py"), "empty.py"),
    (("run", "four-bar", "chain"), "unrecognized arguments: chain"),
    ((*BODY, "--fast"), "unrecognized arguments: --fast"),
    *(((*BODY, option, value), f"argument {option}: {value!r} is no number") for option in (
        "--t-end", "--step", "--accuracy", "--rho") for value in ("soon", "", "1,0", "1e", "0x1")),
    *(((*BODY, option, value), f"argument {option}: {value!r} is no whole number: give one such as")
      for option in ("--index", "--every", "--threads") for value in ("two", "2.5", "")),
    *(((*BODY, "--threads", value), f"threads is {value}: give a whole number from 1 to 64")
      for value in ("0", "-2", "65")),
    ((*BODY, "--t_end", "1"), "unrecognized arguments: --t_end 1; did you mean --t-end?"),
    ((*BODY, "--modes", "3"), "parameters of a scene are given by --set NAME=VALUE"),
    *(((*BODY, option), f"argument {option}: expected one argument") for option in (
        "--t-end", "--step", "--accuracy", "--rho", "--index", "--every", "--output", "--plot",
        "--save", "--resume", "--set")),
    ((*BODY, "--t-end", "nan"), "the end time is nan: give a number >= 0"),
    ((*BODY, "--t-end", "inf"), "the end time is inf: give a number >= 0"),
    ((*BODY, "--t-end", "-1"), "the end time is -1.0: give a number >= 0"),
    ((*BODY, "--t-end", "1e12"), "that is 1e+14 steps of 0.01, give an earlier time"),
    ((*BODY, "--t-end", "1e300"), "steps of 0.01, give an earlier time"),
    ((*BODY, "--t-end", "0.1", "--step", "1000"), "cannot run to t_end = 0.1 from t = 0: the step"),
    *(((*BODY, "--step", value), f"the time step is {float(value)}: give a positive number")
      for value in ("0", "-0.01", "nan", "inf")),
    ((*BODY, "--step", "1e-300"), "steps of 1e-300, give an earlier time or a longer step"),
    ((*BODY, "--step", "1e-12"), "steps of 1e-12, give an earlier time or a longer step"),
    ((*BODY, "--accuracy", "1e-30"), "give at least 1e-09, below which shorter steps"),
    *(((*BODY, "--accuracy", value), f"tolerance relative is {float(value)}: give a number >= 0")
      for value in ("-1", "nan", "inf")),
    ((*BODY, "--accuracy", "0"), "the tolerance allows no error"),
    *(((*BODY, "--rho", value), f"rho is {float(value)}: use a spectral radius")
      for value in ("2", "-0.1", "nan", "inf")),
    *(((*BODY, "--index", value), f"index is {value}: use 3, or 2") for value in ("0", "1", "4")),
    *(((*BODY, "--every", value), f"output_every is {value}: give a whole number of steps")
      for value in ("0", "-3")),
    ((*BODY, "--accuracy", "1e-3", "--save", "a.npz"), "leave out --save and --resume"),
    ((*BODY, "--accuracy", "1e-3", "--every", "2"), "in place of --every"),
    ((*BODY, "--resume", "a.npz", "--step", "0.1"), "leave out --step"),
    ((*BODY, "--resume", "none.npz"), "restart file none.npz does not exist"),
    ((*BODY, "--resume", "folder.npz"), "folder.npz is a folder"),
    ((*BODY, "--resume", "broken.npz"), "is damaged or no restart file"),
    ((*BODY, "--resume", "broken.txt"), "must end in .npz"),
    ((*BODY, "--output", "a.npz", "--save", "a.npz"), "are the same file, a.npz"),
    *(((*BODY, option, path), said) for option, end in (
        ("--output", ".npz"), ("--save", ".npz"), ("--plot", ".png")) for path, said in (
            (f"a{end}.txt", f"must end in {end}"), (f"none/a{end}", "folder none of the"),
            (f"folder{end}", f"folder{end} is a folder"), (LONG + end, "cannot be a file"),
            (f"broken.npz/a{end}", "does not exist"))),
    *(((*BEAM, "--set", change), f"cannot read --set {change}") for change in ("modes", "")),
    ((*BEAM, "--set", "colour=red"), "has no parameter 'colour': there are frame="),
    ((*BEAM, "--set", "=3"), "has no parameter ''"),
    *(((*BEAM, "--set", f"modes={value}"), f"parameter modes is {value!r}: give a value of type")
      for value in ("2.5", "two", "", "[1]", "None", "True")),
    ((*BEAM, "--set", "modes=-1"), "modes is -1"), ((*BEAM, "--set", "modes=999"), "modes is 999"),
    ((*BEAM, "--set", "elements=0"), "elements is 0"),
    ((*BEAM, "--set", "bodies=0"), "bodies is 0"),
    ((*BEAM, "--set", "bodies=3"), "20 elements cannot be divided among 3 bodies"),
    ((*BEAM, "--set", "frame=middle"), "frame 'middle' is unknown"),
    ((*BEAM, "--set", "frame="), "frame '' is unknown"),
    ((*BEAM, "--set", "inertia=z"), "inertia 'z' is unknown"),
    ((*BEAM, "--set", "frame=node", "--set", "frame_node=7"), "cannot carry the frame"),
    *((("run", scene, "--set", "layout=tiny"), "layout 'tiny' is unknown: use 'small' or 'full'")
      for scene in ("box", "right-angle-frame", "shaft")),
    (("run", "shaft", "--set", "elements=5"), "half the number of elements is 2.5"),
    (("run", "spin-up", "--set", "case=fast"), "case is 'fast': use kane or simo"),
    (("run", "chain", "--set", "links=0"), "links is 0: give a whole number >= 1"),
    (("run", "four-bar", "--set", "loops=-1"), "loops is -1: give a whole number >= 1"),
    (("run", "torque-free-body", "--set", "inertia=(1, 1, 9)"), "has the principal moments"),
    (("run", "torque-free-body", "--set", "inertia=(1, 1)"), "inertia of 'body'"),
    (("run", "torque-free-body", "--set", "spin=(1, 'a', 0)"), "initial rate of centre.rotation"),
    (("run", "spherical-beam-strong", "--set", "F0=nan"), "parameter F0 is 'nan'"),
    (("run", "spherical-beam-strong", "--set", "F0=1e999"), "force on tip.position is"),
    (("list", "beam"), "scene 'beam' is unknown"), (("list", "none.py"), "none.py does not exist"),
    (("list", "box", "chain"), "unrecognized arguments: chain"),
    (("list", "--all"), "unrecognized arguments: --all"),
    (("list", "broken.npz"), "broken.npz is damaged or no results file"),
    *(((command, "a.npz"), "results file a.npz does not exist: give one that was saved")
      for command in ("plot", "animate", "report")),
    *(((command, given, "--output", f"a{end}"), said)
      for command, end in (("plot", ".svg"), ("animate", ".html"), ("report", ".html"))
      for given, said in (("none.npz", "results file none.npz does not exist"),
                          ("broken.npz", "broken.npz is damaged or no results file"),
                          ("folder.npz", "folder.npz is a folder"), ("", "give the path"))),
    *(((command, "broken.npz", "--output", path), said)
      for command, end in (("plot", ".png"), ("animate", ".gif"), ("report", ".html"))
      for path, said in ((f"a{end}x", "must end in ."), (f"none/a{end}", "folder none of the"),
                         (LONG + end, "cannot be a file"), ("broken.npz", "must end in ."))),
    (("animate", "a.npz", "--output", "a.html", "--speed", "fast"), "--speed: 'fast' is no number"),
    (("advise", "hinged-beam"), "required: --quantity"),
    (("advise", "beam", "--quantity", "tip.position"), "scene 'beam' is unknown"),
    *((("advise", "hinged-beam", "--t-end", "0.1", "--quantity", *given), said) for given, said in (
        (("top.position",), "'top.position' is unknown: did you mean 'tip.position'"),
        (("base.position",), "'base.position' does not change"),
        (("tip.position", "--tolerance", "0"), "tolerance is 0.0"),
        (("tip.position", "--budget", "-1"), "budget is -1.0"),
        (("tip.position", "--step", "0.03"), "t_end is 0.1, 3.33333 steps of 0.03"))),
    *((("sweep", "hinged-beam", "--t-end", "0.1", *given), said) for given, said in (
        (("--vary", "modes=0:1e18"), "modes=0:1e18 are 1e+18 values: give at most 100000"),
        (("--vary", "modes=0:1e300:1e-300"), "are inf values: give at most"),
        (("--sample", "beam.mass=normal(1,0.1)", "--runs", "1000000000000"),
         "these are 1e+12 runs: a sweep has at most 10000000"),
        (("--vary", "modes=0:99999", "--vary", "elements=1:99999"), "these are 1e+10 runs"),
        (("--sobol", "1099511627776", "--sample", "beam.mass=uniform(1,2)", "--sample",
          "beam.stiffness=uniform(1,2)"), "these are 4.4e+12 runs"),
        (("--vary", "step=0.01,0.01"), "step has the value 0.01 twice: give it once"),
        (("--vary", "step=0.01", "--vary", "step=0.02"), "--vary step is given twice"),
        (("--sample", "beam.mass=uniform(1,2)", "--sample", "beam.mass=uniform(1,3)", "--runs",
          "2"), "--sample beam.mass is given twice"),
        (("--vary", "modes=0,999"), "build(modes=999): modes is 999, but the clamped body has"),
        (("--vary", "modes=0,two"), "build(modes='two'): modes is 'two'"),
        (("--vary", "modes=[]"), "a value of modes is []: give a number or a text"),
        (("--vary", "modes={[]:1}"), "a range is LOW:HIGH"),
        (("--vary", "modes=0,1", "--workers", "0"), "workers is 0: give a whole number >= 1"),
        (("--vary", "modes=0,1", "--workers", "-2"), "workers is -2: give a whole number >= 1"),
        (("--vary", "modes=0,1", "--workers", "99999"), "workers is 99999: give a whole number"),
        (("--vary", "modes=0,1", "--threads", "0"), "threads is 0: give a whole number >= 1"),
        (("--vary", "modes=0,1", "--cluster", "a:1", "--workers", "2"), "leave out --workers"),
        (("--vary", "modes=1:0"), "with HIGH above LOW"),
        (("--vary", "modes=0:nan"), "with HIGH above LOW"),
        (("--vary", "colour=1,2"), "parameter 'colour' is unknown"),
        (("--vary", "rho=0.5,7"), "rho is 7.0: use a spectral radius"),
        (("--vary", "modes=0,1", "--seed", "-1"), "seed is -1"),
        (("--vary", "modes=0,1", "--keep", "final(t"), "cannot read --keep final(t"),
        (("--vary", "modes=0,1", "--keep", "at_time(tip.position,9)"), "and the runs end at 0.1"),
        (("--sample", "gravity=cauchy(1,1)", "--runs", "2"), "distribution 'cauchy' is unknown"),
        (("--sample", "beam.mass=uniform(1,[])", "--runs", "2"), "high is []"),
        (("--vary", "modes=0,1", "--output", "pipe"), "pipe.npz is a device"))),
    (("sweep", "hinged-beam", "--t-end", "1e300", "--vary", "modes=0,1"),
     "t_end is 1e+300: that is 1e+302 steps of 0.01"),
    (("sweep", "hinged-beam", "--t-end", "1e308", "--step", "1e-9", "--vary", "modes=0,1"),
     "that is inf steps of 1e-09"),
    *((("sweep", file, "--vary", "n=1,2"), said) for file, said in (
        ("fails.py", "build(n=2) raised ValueError: too many; correct the scene"),
        ("nothing.py", "return Scene(name"), ("loops.py", "RecursionError: maximum recursion"),
        ("exits.py", "SystemExit: 3"), ("pipe.py", "is a pipe or a device"))),
    *((("run", file), said) for file, said in (
        ("nothing.py", "return Scene(name"), ("loops.py", "RecursionError: maximum recursion"),
        ("exits.py", "SystemExit: 3"), ("pipe.py", "is a pipe or a device"))),
    *(((*BEAM, *given), said) for given, said in (
        (("--step", "1e6"), "cannot run to t_end = 30 from t = 0: the step is 1e+06"),
        (("--step", "1e9"), "cannot run to t_end = 30 from t = 0: the step is 1e+09"),
        (("--every", "1000000000000000000000"), "output_every is 1000000000000000000000"),
        (("--t-end", "1e9"), "a record of 100000000000 states does not fit into memory: keep"),
        (("--resume", "pipe.npz"), "pipe.npz is a pipe or a device: give the path of a file"),
        (("--set", "modes={[]:1}"), "parameter modes is '{[]:1}': give a value of type int"),
        (("--set", "modes=" + "[" * 5000), "give a value of type int"),
        (("--set", "modes=1000000000000000000"), "modes is 1000000000000000000, but the clamped"),
        (("--set", "elements=1000000000000"), "does not fit into memory: give fewer elements"),
        (("--set", "elements=100000000000", "--set", "bodies=100000000000"),
         "of 100000000000 bodies does not fit into memory: give fewer bodies"))),
    (("run", "chain", "--set", "links=1000000000"), "links is 1000000000: give a whole number"),
    (("run", "four-bar", "--set", "loops=1000000000"), "loops is 1000000000: give a whole"),
    *(((command, "pipe.npz", *given), "pipe.npz is a pipe or a device: give the path of a file")
      for command, given in (("inspect", ()), ("list", ()), ("plot", ("--output", "a.png")),
                             ("report", ("--output", "a.html")), ("animate", ("--output", "a.gif")),
                             ("import", ("--interface", "a=1", "--output", "b.npz")))),
    *((("import", "fails.py", "--interface", "a=1", "--output", "b.npz", "--format", kind), "fails")
      for kind in ("calculix", "sid", "matrix-market", "abaqus-matrices", "abaqus-substructure")),
    (("advise", "hinged-beam", "--t-end", "0.1", "--quantity", "t"), "quantity 't' is the time"),
    (("advise", "hinged-beam", "--t-end", "1e300", "--quantity", "tip.position"),
     "steps of 0.01, give an earlier time or a longer step"),
    (("check", "nothing"), "kernel 'nothing' is unknown: there are"),
    (("check", ""), "kernel '' is unknown"), (("check", "--all"), "unrecognized arguments"),
    (("bench", "beam"), "scene 'beam' is unknown"),
    (("bench", ""), "scene '' is unknown"),
    (("bench", "--csv"), "unrecognized arguments"),
    (("chart",), "required: SCENE"), (("chart", "beam"), "scene 'beam' is unknown"),
    (("chart", "hinged-beam", "--output", "a.txt"), "picture a.txt must end in .png"),
    (("chart", "hinged-beam", "--output", "none/a.png"), "folder none of the picture"),
    (("chart", "hinged-beam", "--output", "folder.png"), "folder.png is a folder"),
    (("chart", "hinged-beam", "--csv", "none/a.csv"), "folder none of the table does not exist"),
    (("chart", "hinged-beam", "--csv", "folder.npz"), "folder.npz is a folder"),
    (("verify", "four-bar"), "case 'four-bar' is unknown: did you mean 'n-four-bar'"),
    (("verify", "squeezer", "moon"), "case 'moon' is unknown: there are simple-pendulum"),
    (("verify", ""), "case '' is unknown: there are"),
    (("verify", "--jsn"), "unrecognized arguments: --jsn; did you mean --json?"),
    (("atlas", "nowhere"), "the atlas has no case 'nowhere': there are"),
    (("atlas", ""), "the atlas has no case ''"),
    (("atlas", "--output", "a.gif"), "picture a.gif must end in .png"),
    (("atlas", "--output", LONG + ".png"), "cannot be a file"),
    (("warm", "now"), "unrecognized arguments: now"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Folders with the names of files, and files that are none."""
    found = tmp_path_factory.mktemp("commands")
    for name in ("folder.npz", "folder.png", "folder.py"):
        (found / name).mkdir()
    for name in ("broken.npz", "broken.txt"):
        (found / name).write_text("not zip")
    (found / "broken.py").write_text("def build(:\n")
    (found / "empty.py").write_text("build = 3\n")
    (found / "nothing.py").write_text("def build(n=1):\n    return None\n")
    (found / "loops.py").write_text("def build(n=1):\n    return build(n)\n")
    (found / "exits.py").write_text("import sys\ndef build(n=1):\n    sys.exit(3)\n")
    (found / "fails.py").write_text(FAILS)
    for name in ("pipe.npz", "pipe.py"):
        os.mkfifo(found / name)
    return found


@pytest.mark.parametrize("arguments, said", REFUSED, ids=lambda value: " ".join(value)[:60]
                         if isinstance(value, tuple) else "")
def test_refused(arguments, said, folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    before = sorted(folder.rglob("*"))
    try:
        code = main(arguments)
    except SystemExit as refused:       # by argparse
        code = refused.code
    printed = capsys.readouterr()
    assert code == 2
    assert said in printed.err
    *usage, last = printed.err.strip().splitlines()
    assert last.startswith("error: ") or usage and ": error: " in last
    assert "Traceback" not in printed.err
    assert sorted(folder.rglob("*")) == before
