"""A report of a run as one page: audit, warnings, animation, plots, unknowns, model."""

import base64
import io
from collections import Counter
from html import escape
from pathlib import Path

from sebody.basics import inputs
from sebody.basics.files import check_target, replacing
from sebody.model.summary import model_tables, summary, table
from sebody.pictures.curves import Curve, Panel, panels
from sebody.pictures.drawing import draw, overview
from sebody.pictures.page_data import page
from sebody.pictures.plots import check_matplotlib
from sebody.pictures.templates import filled
from sebody.results.audit import Finding, audit
from sebody.results.result import Result
from sebody.results.units import with_unit

SUFFIXES = (".html",)


def report(result: Result, output: str | Path, *quantities: str, title: str = "") -> Path:
    """Write a report of a run: one page that needs no network and no other file.

    It holds an audit (completion, energy, momenta, constraints, each judged), the warnings of the
    run with their remedies, an animation, plots, the unknowns and why they are, and the model.

    Parameters
    ----------
    result : Result
    output : str or Path
        File to write: html.
    *quantities : str
        What is plotted, by names as for `sebody.results.plot`; an overview by default.
    title : str
        Heading of the page; the name of the file by default.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    InputError
        matplotlib is missing, a quantity there is not, a result of one state, or a file that
        cannot be written.
    WriteError
        Writing fails; an older file is unchanged.
    """
    inputs.instance(result, "result", Result, "give the Result of a run")
    path = check_report(output)
    title = inputs.text(title, "title") or path.stem
    words = quantities or overview(result)
    drawn = panels({"the result": result}, words)
    text = filled("report.html", {
        "title": escape(title), "style": filled("report.css", {}),
        "about": escape(f"{summary(result.model)}; {result.numbering.free} unknowns, "
                        f"t = {result.t[0]:.6g} to {result.t[-1]:.6g}"),
        "audit": audit_table(audit(result)), "warnings": _warnings(result),
        "animation": escape(page(result, [panel.title for panel in drawn
                                          if panel.kind == "history"], title)),
        "plots": _picture([*drawn, _drift(result)]), "unknowns": _unknowns(result),
        "model": "".join(f"<h3>{escape(heading)}</h3>{rows}"
                         for heading, rows in model_tables(result.model)),
        "run": escape(result.summary())})
    with replacing(path, "report") as file:
        file.write(text.encode())
    return path


def check_report(output: str | Path) -> Path:
    """The path of a report, refused before anything is computed for it.

    Raises
    ------
    InputError
        A file that cannot be written, or matplotlib is missing.
    """
    path = check_target(output, "report", SUFFIXES)
    check_matplotlib()
    return path


def audit_table(findings: list[Finding]) -> str:
    """Findings with their verdicts."""
    rows = "".join(
        f"<tr><td>{escape(one.what)}</td><td>{escape(one.value)}</td>"
        f"<td><span class=\"verdict {one.verdict.replace(' ', '-')}\">{one.verdict}</span></td>"
        f"<td>{escape(one.reason)}</td></tr>" for one in findings)
    return ("<table><thead><tr><th>what</th><th>value</th><th>verdict</th><th>compared with</th>"
            f"</tr></thead><tbody>{rows}</tbody></table>")


def _warnings(result: Result) -> str:
    """Warnings of the run; each names its remedy."""
    said = [*([result.failure] if result.failure else []), *result.warnings,
            *result.cautions]
    said += [f"bodies {', '.join(bodies)} use a general kernel: for a faster, specific kernel run "
             f"{command}" for command, bodies in result.advice.items()]
    if not said:
        return "<p>None.</p>"
    return "<ul>" + "".join(f"<li>{escape(one)}</li>" for one in said) + "</ul>"


def _drift(result: Result) -> Panel:
    """Energy that the run has gained or lost."""
    total = sum(result[f"energy.{name}"] for name in ("kinetic", "strain", "potential"))
    balance = total - result["energy.external_work"]
    labels = (with_unit(label, name, result.units) for label, name in (("time", "t"),
                                                                       ("energy", "energy")))
    return Panel("energy drift: total energy - work of loads", *labels, [
        Curve("", result.t, balance - balance[0])])


def _picture(drawn: list[Panel]) -> str:
    """Plots as a picture in the page."""
    content = io.BytesIO()
    draw(drawn).savefig(content, format="svg")
    data = base64.b64encode(content.getvalue()).decode()
    titles = escape(", ".join(panel.title for panel in drawn))
    return f'<img alt="plots of {titles}" src="data:image/svg+xml;base64,{data}">'


def _unknowns(result: Result) -> str:
    """The unknowns of each part of the model, and the reason for them."""
    numbering, model = result.numbering, result.model
    free = [name for k, name in enumerate(numbering.names) if k < numbering.free]
    counts = Counter(_part(name) for name in free)
    owners: dict[str, list[str]] = {}
    for node in model.nodes.values():
        for dof_block in (node.position, node.rotation):
            if dof_block is not None:
                owners.setdefault(dof_block.name, []).append(node.name)
    rows = [(part, count, _why(part, owners)) for part, count in counts.items()]
    fixed = numbering.total - numbering.free
    text = (f"<p>{numbering.free} unknowns; {fixed} coordinates are fixed, prescribed or at the "
            "end of rigid links, so they are not unknowns.</p>" if fixed else
            f"<p>{numbering.free} unknowns.</p>")
    return text + table(("of", "unknowns", "because"), rows)


def _part(name: str) -> str:
    """The part of a model that an unknown belongs to, by its name."""
    if name.startswith(("mode ", "multiplier ")):
        kind, _, owner = name.partition(" of ")
        return f"{kind.split()[0]}s of {owner}"
    return name.partition("[")[0]


def _why(part: str, owners: dict[str, list[str]]) -> str:
    if part.startswith("modes of "):
        return "amplitudes of the internal modes that the reduction has kept"
    if part.startswith("multipliers of "):
        return "one per equation of the joint, whose nodes cannot share these coordinates"
    nodes = owners.get(part, [])
    shared = f"; shared by {', '.join(nodes)} without an equation" * (len(nodes) > 1)
    return f"the {part.rpartition('.')[2]} is neither fixed nor prescribed{shared}"

