"""Restart files, tables of sweeps and references likewise."""

import numpy as np
from malformed.read_files import KINDS
from malformed.tampering import Packed, bomb, entry, member, raw, text, without

from sebody.engine.clock import CONTROL

RESTART = {
    "negative control": Packed("holds -1 in control for grid", entry("control", 0, -1)),
    "text control": Packed("in control, in place of whole numbers", member(
        "control", lambda old: old.astype(str))),
    "control of fractions": Packed("holds float64 in control", member(
        "control", lambda old: old + 0.25)),
    **{f"control {k} too large": Packed(f"in control for {CONTROL.names[k]}, outside 0 to", entry(
        "control", k, 10**15)) for k in (0, 1, 2, 5, 6, 13, 16, 17, 20, 21)},
    "another time": Packed("holds the time 77 after 4 steps of 0.05", entry("clock", 0, 77.0)),
    "NaN time": Packed("holds nan in clock for time", entry("clock", 0, np.nan)),
    "another step": Packed("steps of 1", entry("clock", 1, 1.0)),
    "no step": Packed("holds a step of 0 with", entry("clock", 2, 0.0)),
    "a negative step": Packed("holds a step of -1 with", entry("clock", 2, -1.0)),
    "NaN in a state": Packed("holds numbers in rows that are not finite", entry(
        "rows", (1, 4), np.nan)),
    "times that fall": Packed("holds states that are not in the order of their times", entry(
        "rows", (1, 0), 0.15)),
    "times after the end": Packed("holds states that are not in the order of their times", entry(
        "rows", (-1, 0), 9.0)),
    "a time soon after the end": Packed("not in the order of their times up to 0.2", entry(
        "rows", (-1, 0), 0.21)),
    "no states": Packed("holds states that are not in the order", member(
        "rows", lambda old: old[:0])),
    "wide states": Packed("is of another model", member(
        "rows", lambda old: np.hstack([old, old]))),
    "NaN in a velocity": Packed("holds numbers in v_old that are not finite", entry(
        "v_old", 2, np.nan)),
    "infinite acceleration": Packed("holds numbers in aux that are not finite", entry(
        "aux", 0, np.inf)),
    **{f"NaN in {name}": Packed(f"holds numbers in {name} that are not finite", entry(
        name, 1, np.nan)) for name in ("changes", "fitted", "fit")},
    "a velocity too few": Packed("is of another model", member("v_old", lambda old: old[:-1])),
    "texts for velocities": Packed("in v_old, in place of real numbers", member(
        "v_old", lambda old: old.astype(str))),
    "another velocity": Packed("differs from what was saved in v_old", entry("v_old", 1, 5.0)),
    "regularized in words": Packed("in regularized, in place of whole numbers", member(
        "regularized", np.array(["no"]))),
    "negative regularized": Packed("holds -1 in regularized", member(
        "regularized", np.array([-1]))),
    "no settings": Packed("no text settings", without("settings")),
    "settings of brackets": Packed("brackets are nested deeper than 100", raw(
        "settings", "[" * 300_000)),
    "settings that are a list": Packed("is damaged or no restart file", raw("settings", "[]")),
    "another version": Packed("is of version 9, this program reads 8", text(
        "settings", lambda said: said.update({"version": 9}))),
    "a negative step at the start": Packed("the time step is -0.05", text(
        "settings", lambda said: said.update({"h": -0.05}))),
    "a step in words": Packed("the time step is 'short'", text(
        "settings", lambda said: said.update({"h": "short"}))),
    "every so many": Packed("output_every is 0", text(
        "settings", lambda said: said.update({"every": 0}))),
    "seconds in words": Packed("seconds is 'long'", text(
        "settings", lambda said: said.update({"seconds": "long"}))),
    "negative seconds": Packed("seconds is -1", text(
        "settings", lambda said: said.update({"seconds": -1}))),
    "a scheme of texts": Packed("scheme: alpha_m is 'a'", text(
        "settings", lambda said: said.update({"scheme": list("abcdefg")}))),
    "a scheme with a number too few": Packed("has an unknown scheme", text(
        "settings", lambda said: said["scheme"].clear())),
    "a scheme that diverges": Packed("scheme: beta is -1", text(
        "settings", lambda said: said["scheme"].__setitem__(2, -1))),
    "a scheme that is a number": Packed("has 3 for its scheme", text(
        "settings", lambda said: said.update({"scheme": 3}))),
    "a tolerance in words": Packed("has 'fine' for its tolerance", text(
        "settings", lambda said: said.update({"tolerance": "fine"}))),
    "a tolerance that is negative": Packed("tolerance relative is -1", text(
        "settings", lambda said: said.update({"tolerance": [-1, 0, 0]}))),
    "a plan in words": Packed("has 'none' for its plan", text(
        "settings", lambda said: said.update({"plan": "none"}))),
    "a plan of steps without length": Packed("has a plan of steps that no run has", text(
        "settings", lambda said: said["plan"].__setitem__(0, [[1.0, 0.0]]))),
    "a plan with a number too few": Packed("has a plan of steps that no run has", text(
        "settings", lambda said: said["plan"].__delitem__(-1))),
    "another model": Packed("is of another model", text(
        "settings", lambda said: said.update({"model": "x"}))),
    "a model that is a number": Packed("has 3 for its model", text(
        "settings", lambda said: said.update({"model": 3}))),
    "a member too few": Packed("it differs in aux_old", without("aux_old")),
    "a member too many": Packed("it differs in colour", member("colour", np.zeros(2))),
    "a bomb": Packed("it would unpack to 2 GiB", bomb("rows", (2**25, 8))),
}
TABLE = {
    "runs that differ": Packed("has ", member("done", lambda old: old[:-1])),
    "done in words": Packed("in done, in place of truth values", member(
        "done", np.array(["yes"] * 3))),
    "failures of numbers": Packed("in failure, in place of a text", member("failure", np.zeros(3))),
    "outputs of a run too few": Packed("has output/end of shape (2, 2), in place of (3", member(
        "output/end", lambda old: old[:-1])),
    "outputs in words": Packed("in output/end, in place of real numbers", member(
        "output/end", lambda old: old.astype(str))),
    "parameters of a run too many": Packed("has parameter/push of shape (4,), in place of (3)",
                                           member("parameter/push", np.ones(4))),
    "NaN for a parameter": Packed("in parameter/push that are not finite", entry(
        "parameter/push", 1, np.nan)),
    "another output": Packed("differs from what was saved in output/end", entry(
        "output/end", (1, 0), 77.0)),
    "another parameter": Packed("differs from what was saved in parameter/push", entry(
        "parameter/push", 0, 77.0)),
    "no design": Packed("has no member design", without("design")),
    "no version": Packed("is damaged or no table of a sweep", without("version")),
    "another version": Packed("is of version 9, this program reads 1", member("version", 9)),
    "versions": Packed("is of version [1 2], this program reads 1", member("version", [1, 2])),
    "a version in words": Packed("is of version one", member("version", "one")),
    "an unknown member": Packed("has a member 'colour', which is unknown", member("colour", 3.0)),
    "checksums in words": Packed("is damaged or no table", raw("checksums", "all right")),
    "a result": Packed("is damaged or no table of a sweep", lambda path: KINDS["result"].make(
        path.parent).replace(path)),
}
REFERENCE = {
    "NaN": Packed("in values that are not finite", entry("values", (1, 1), np.nan)),
    "no error": Packed("has no member error", without("error")),
    "a negative error": Packed("holds -1.0 in error", member("error", -1.0)),
    "errors": Packed("has error of shape (2,), in place of ()", member("error", np.ones(2))),
    "texts": Packed("in values, in place of real numbers", member(
        "values", lambda old: old.astype(str))),
}
