"""Body files and files of results with something in them that the program never writes."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from malformed.read_files import KINDS
from malformed.tampering import (
    Packed,
    arrays,
    bomb,
    claims,
    encrypted,
    entry,
    member,
    method,
    raw,
    text,
    twice,
    without,
)

from sebody.results.saving import VERSION


def _part(kind: str, change: Callable[[list], Any]) -> Callable[[Path], None]:
    """The first part of a class in the description of a model."""
    def spoil(said: dict) -> None:
        change(next(part for part in said["parts"] if part[0] == kind))
    return text("sebody/model", spoil)


def _field(kind: str, name: str, value: Any) -> Callable[[Path], None]:
    return _part(kind, lambda part: part[1].update({name: value}))


def _numbering(said: dict) -> list:
    """Values of the numbering of a described model."""
    return said["heads"][1][2]


BODY = {
    "NaN in the shapes": Packed("holds numbers in recovery.shapes that are not finite (nan at "
                                "[3, 2])", entry("recovery.shapes", (3, 2), np.nan)),
    "infinity in the static response": Packed("in recovery.static that are not finite", entry(
        "recovery.static", (0, 0), np.inf)),
    "a row too few": Packed("has recovery.shapes of shape (17, 12), in place of (18, any)", member(
        "recovery.shapes", lambda old: old[:-1])),
    "a column too few": Packed("recovery.shapes has shape", member(
        "recovery.shapes", lambda old: old[:, :-1])),
    "a row too few of the mass": Packed("has mass of shape", member("mass", lambda old: old[:-1])),
    "a vector for the stiffness": Packed("has stiffness of shape (8,), in place of (8, 8)", member(
        "stiffness", np.ones(8))),
    "another size": Packed("has invariants.Q of shape", arrays(lambda found: found.update(
        {name: found[name][:-1, :-1] for name in ("stiffness", "mass", "damping")}))),
    "texts for the mass": Packed("holds <U", member("mass", np.full((8, 8), "one"))),
    "complex mass": Packed("holds complex128 in mass, in place of real numbers", member(
        "mass", lambda old: old * 1j)),
    "truth values": Packed("holds bool in coordinates", member(
        "coordinates", lambda old: old > 0)),
    "NaN in the coordinates": Packed("in coordinates that are not finite", entry(
        "coordinates", (1, 1), np.nan)),
    "coordinates in space": Packed("has ", member("coordinates", np.ones((3, 3)))),
    "a node too few": Packed("has coordinates of shape (2, 2), in place of (3, 2)", member(
        "coordinates", lambda old: old[:2])),
    "NaN in a constant": Packed("in invariants.K that are not finite", entry(
        "invariants.K", (0, 0, 0), np.nan)),
    "Q times two": Packed("invariants.Q changed since the file was written; import", member(
        "invariants.Q", lambda old: 2 * old)),
    "Ghat times two": Packed("invariants.Ghat changed since the file was written", member(
        "invariants.Ghat", lambda old: 2 * old)),
    "damping times two": Packed("damping changed since the file was written", member(
        "damping", lambda old: 2 * old)),
    "another place inside": Packed("recovery.coordinates changed since", entry(
        "recovery.coordinates", (2, 0), 7.0)),
    "constants one short": Packed("has no member invariants.J2", without("invariants.J2")),
    "no coordinates": Packed("has no member coordinates", without("coordinates")),
    "no stiffness": Packed("has no member stiffness", without("stiffness")),
    "an unknown member": Packed("has a member 'colour', which is unknown", member(
        "colour", np.zeros(3))),
    "an unknown constant": Packed("has a member 'invariants.J3', which is unknown", member(
        "invariants.J3", np.zeros(3))),
    "an unknown part": Packed("unknown part 'Colour'", text("notes", lambda said: said[
        "body"]["recovery.stress"][0].update({"part": "Colour"}))),
    "a part of another class": Packed("is damaged or no body file", text("notes", lambda said: said[
        "body"]["recovery.stress"][0].update({"part": "StressModes"}))),
    "a part that is left out": Packed("has a member 'recovery.stress/0/", text(
        "notes", lambda said: said["body"].update({"recovery.stress": []}))),
    "an unknown reference": Packed("has no member nothing", text("notes", lambda said: said[
        "body"].update({"recovery.cells": [["line", {"array": "nothing"}]]}))),
    "an element of a node there is not": Packed("in recovery.cells/0/1, where the largest is 5",
                                                entry("recovery.cells/0/1", (0, 0), 99)),
    "a negative node": Packed("holds -1 in recovery.cells/0/1, where the least is 0", entry(
        "recovery.cells/0/1", (0, 0), -1)),
    "fractions for nodes": Packed("holds float64 in recovery.cells/0/1, in place of whole", member(
        "recovery.cells/0/1", lambda old: old + 0.5)),
    "a stress of a node there is not": Packed("in recovery.stress/0/nodes, where the largest is 5",
                                              entry("recovery.stress/0/nodes", (0, 0), 99)),
    "forces of an element too few": Packed("recovery.stress[0].forces has shape", member(
        "recovery.stress/0/forces", lambda old: old[:-1])),
    "no notes": Packed("is damaged or no body file", without("notes")),
    "notes of numbers": Packed("is damaged or no body file", member("notes", np.zeros(3))),
    "notes of brackets": Packed("brackets are nested deeper than 100", raw(
        "notes", "[" * 300_000 + "]" * 300_000)),
    "notes of 200 brackets": Packed("brackets are nested deeper than 100", raw(
        "notes", "[" * 200 + "]" * 200)),
    "notes cut": Packed("is damaged or no body file", member(
        "notes", lambda old: str(old)[:-5])),
    "notes that are a list": Packed("is damaged or no body file", raw("notes", "[1, 2]")),
    "names of numbers": Packed("name of a boundary node is 1", text(
        "notes", lambda said: said.update({"names": [1, 2, 3]}))),
    "a name twice": Packed("give 3 different names", text(
        "notes", lambda said: said.update({"names": ["a", "a", "b"]}))),
    "a name too few": Packed("give 3 different names", text(
        "notes", lambda said: said.update({"names": ["a"]}))),
    "units of numbers": Packed("has 3 for its units", text(
        "notes", lambda said: said.update({"units": 3}))),
    "units there are not": Packed("do not belong together", text(
        "notes", lambda said: said.update({"units": "mm kg N s"}))),
    "reasons that are a list": Packed("missing is []: give a dict of texts", text(
        "notes", lambda said: said["body"].update({"missing": []}))),
    "a reason of something else": Packed("missing has 'love': 'none'; give a dict of texts", text(
        "notes", lambda said: said["body"].update({"missing": {"love": "none"}}))),
    "materials of numbers": Packed("materials: one is 3", text(
        "notes", lambda said: said["body"].update({"materials": [3]}))),
    "a material of negative speed": Packed("speed of sound of material 'M' is -1.0", text(
        "notes", lambda said: said["body"].update({"materials": [["M", -1.0, 2.0]]}))),
    "a provenance of numbers": Packed("has a provenance that is not a text", text(
        "notes", lambda said: said.update({"provenance": {"source": 3}}))),
    "a provenance that is a list": Packed("has [] for its provenance", text(
        "notes", lambda said: said.update({"provenance": []}))),
    "another thing kept": Packed("for what its nodes keep", text(
        "notes", lambda said: said["body"].update({"keeps": ["full", "none", "full"]}))),
    "modes in words": Packed("has 'two' for its number of modes", text(
        "notes", lambda said: said["body"].update({"modes": "two"}))),
    "negative modes": Packed("has -1 for its number of modes", text(
        "notes", lambda said: said["body"].update({"modes": -1}))),
    "a million modes": Packed("modes is 1000000: the stiffness has 8 rows", text(
        "notes", lambda said: said["body"].update({"modes": 1_000_000}))),
    "a version in words": Packed("is of version one, this program reads 1", text(
        "notes", lambda said: said.update({"version": "one"}))),
    "another DOF": Packed("recovery.node_dofs is ", text(
        "notes", lambda said: said["body"].update({"recovery.node_dofs": ["x", "y", "t"]}))),
    "DOFs of space": Packed("has recovery.shapes of shape", text(
        "notes", lambda said: said["body"].update({
            "recovery.node_dofs": ["x", "y", "z", "rx", "ry", "rz"]}))),
    "remarks of numbers": Packed("notes is (1,)", text(
        "notes", lambda said: said["body"].update({"notes": [1]}))),
    "a bomb": Packed("it would unpack to 2 GiB, ", bomb("recovery.shapes", (2**14, 2**14))),
    "a bomb that fits": Packed("it would unpack to 2 GiB, ", bomb(
        "recovery.cells/0/1", (2**27, 2), "<i8")),
    "a large member": Packed("has mass of shape (4096, 4096), in place of (8, 8)", member(
        "mass", np.zeros((4096, 4096)))),
    "more than any memory": Packed("member mass has", lambda path: claims(path, "mass", 2**40)),
    "an encrypted member": Packed("member mass is encrypted", encrypted("mass")),
    "another packing": Packed("member mass is packed by method 14", method("mass", 14)),
    "a member twice": Packed("member mass occurs twice", twice("mass")),
    "objects": Packed("member mass has", arrays(lambda found: found.update(
        {"mass": np.array([None, {}], dtype=object)}))),
    "indefinite mass": Packed("mass is indefinite", member("mass", lambda old: -old)),
    "a result": Packed("is damaged or no body file", lambda path: KINDS["result"].make(
        path.parent).replace(path)),
    "a restart file": Packed("is damaged or no body file", lambda path: KINDS["restart"].make(
        path.parent).replace(path)),
}
RESULT = {
    "NaN in a state": Packed("holds numbers in rows that are not finite (nan at [2, 5])", entry(
        "sebody/rows", (2, 5), np.nan)),
    "times that fall": Packed("holds times that do not increase: ", entry(
        "sebody/rows", (2, 0), -1.0)),
    "a time twice": Packed("holds times that do not increase: 0.05 is followed by 0.05", entry(
        "sebody/rows", (2, 0), 0.05)),
    "no state": Packed("holds no state", arrays(lambda found: found.update(
        {f"sebody/{name}": found[f"sebody/{name}"][:0] for name in (
            "rows", "elements", "supports", "energies", "powers", "constraint_residuals")}))),
    "wide states": Packed("has rows of shape (5, ", member(
        "sebody/rows", lambda old: np.hstack([old, old[:, :1]]))),
    "narrow states": Packed("has rows of shape (5, ", member(
        "sebody/rows", lambda old: old[:, :-1])),
    "a state too few of the forces": Packed("has elements of shape (4, ", member(
        "sebody/elements", lambda old: old[:-1])),
    "a state too many of the energies": Packed("has energies of shape (6, ", member(
        "sebody/energies", lambda old: np.vstack([old, old[:1]]))),
    "powers of another model": Packed("has powers of shape", member(
        "sebody/powers", lambda old: old[:, :0])),
    "one column of residuals": Packed("has constraint_residuals of shape (5, 1)", member(
        "sebody/constraint_residuals", lambda old: old[:, :1])),
    "supports of another model": Packed("has supports of shape", member(
        "sebody/supports", lambda old: np.hstack([old, old]))),
    "NaN in the energies": Packed("in energies that are not finite", entry(
        "sebody/energies", (1, 1), np.nan)),
    "negative counters": Packed("holds -5 in counters, where the least is 0", entry(
        "sebody/counters", 3, -5)),
    "fractions for counters": Packed("holds float64 in counters", member(
        "sebody/counters", lambda old: old + 0.5)),
    "texts for states": Packed("in rows, in place of real numbers", member(
        "sebody/rows", lambda old: old.astype(str))),
    "states of complex numbers": Packed("holds complex128 in rows", member(
        "sebody/rows", lambda old: old + 0j)),
    "a changed place": Packed("differs from what was saved in rows", entry(
        "sebody/rows", (3, 6), 7.0)),
    "a changed number of the model": Packed("differs from what was saved in numbers", entry(
        "sebody/numbers", 0, 123.0)),
    "numbers cut": Packed("is damaged or no results file", member(
        "sebody/numbers", lambda old: old[:-3])),
    "no numbers": Packed("has no member numbers", without("sebody/numbers")),
    "no states": Packed("has no member rows", without("sebody/rows")),
    "no model": Packed("no text model", without("sebody/model")),
    "no notes": Packed("no text notes", without("sebody/notes")),
    "an unknown member": Packed("has a member 'colour', which is unknown", member(
        "sebody/colour", np.zeros(2))),
    "a version in words": Packed(f"is of version two, this program reads {VERSION}", text(
        "sebody/notes", lambda said: said.update({"version": "two"}))),
    "notes without a failure": Packed("is damaged or no results file", text(
        "sebody/notes", lambda said: said.pop("failure") and None)),
    "seconds in words": Packed("has 'long' for its seconds", text(
        "sebody/notes", lambda said: said.update({"seconds": "long"}))),
    "warnings that are a number": Packed("has 3 for its warnings", text(
        "sebody/notes", lambda said: said.update({"warnings": 3}))),
    "a start in words": Packed("has 'soon' for its start", text(
        "sebody/notes", lambda said: said.update({"start": "soon"}))),
    "advice in words": Packed("has 'none' for its advice", text(
        "sebody/notes", lambda said: said.update({"advice": "none"}))),
    "a model of brackets": Packed("brackets are nested deeper than 100", raw(
        "sebody/model", "[" * 300_000 + "]" * 300_000)),
    "a model that is a list": Packed("is damaged or no results file", raw("sebody/model", "[]")),
    "a model in words": Packed("is damaged or no results file", raw("sebody/model", '"model"')),
    "an unknown class": Packed("is damaged or no results file", _part(
        "Node", lambda part: part.__setitem__(0, "Colour"))),
    "a part of another class": Packed("of class DofBlock for its node", _part(
        "Node", lambda part: part.__setitem__(0, "DofBlock"))),
    "a part with a field too few": Packed("a Node lacks point", _part(
        "Node", lambda part: part[1].pop("point"))),
    "a part with a field too many": Packed("a Node has colour", _field("Node", "colour", 3)),
    "a name of a number": Packed("a Node has 3 for its name", _field("Node", "name", 3)),
    "a place in words": Packed("a Node has 'here' for its point", _field("Node", "point", "here")),
    "a part that is none": Packed("is damaged or no results file", _field(
        "Node", "position", ["part", 999])),
    "a node for a position": Packed("for its position", text("sebody/model", lambda said: next(
        part for part in said["parts"] if part[0] == "Node")[1].update({"position": [
            "part", [p[0] for p in said["parts"]].index("Node")]}))),
    "an array beyond the numbers": Packed("is damaged or no results file", _field(
        "Node", "point", ["array", 10**9, [2], "<f8"])),
    "an array from before": Packed("an array begins at -3", _field(
        "Node", "point", ["array", -3, [2], "<f8"])),
    "an array of objects": Packed("is damaged or no results file", _field(
        "Node", "point", ["array", 0, [2], "|O"])),
    "a huge array": Packed("is damaged or no results file", _field(
        "Node", "point", ["array", 0, [10**12], "<f8"])),
    "a kind there is not": Packed("is damaged or no results file", _field(
        "Node", "point", ["cloud", []])),
    "stiffening in words": Packed("a Superelement has 'yes' for its stiffening", _field(
        "Superelement", "stiffening", "yes")),
    "a body of a name": Packed("a Superelement has 'rod' for its reduced", _field(
        "Superelement", "reduced", "rod")),
    "modes of a fraction": Packed("a ReducedBody has 1.5 for its modes", _field(
        "ReducedBody", "modes", 1.5)),
    "modes too many": Packed("a body of ", _field("ReducedBody", "modes", 7)),
    "another thing kept": Packed("keeps[0] is 'none'", _field(
        "ReducedBody", "keeps", ["tuple", ["none", "full"]])),
    "a model for the numbering": Packed("it describes no model", text(
        "sebody/model", lambda said: said["heads"].__setitem__(1, said["heads"][0]))),
    "one head": Packed("is damaged or no results file", text(
        "sebody/model", lambda said: said["heads"].pop() and None)),
    "a coordinate there is not": Packed("is damaged or no results file", text(
        "sebody/model", lambda said: _numbering(said).__setitem__(1, 10**6))),
    "unknowns of a fraction": Packed("a Numbering has 2.5 for its free", text(
        "sebody/model", lambda said: _numbering(said).__setitem__(0, 2.5))),
    "negative unknowns": Packed("-1 unknowns of", text(
        "sebody/model", lambda said: _numbering(said).__setitem__(0, -1))),
    "a bomb": Packed("it would unpack to 2 GiB, ", bomb("sebody/rows", (2**25, 8))),
    "an encrypted member": Packed("member rows is encrypted", encrypted("sebody/rows")),
    "a body": Packed("is damaged or no results file", lambda path: KINDS["body"].make(
        path.parent).replace(path)),
}
