"""The search: one axis at a time, then all together, cheapest first."""

from collections.abc import Sequence
from functools import partial
from math import inf

from sebody.basics.errors import InputError
from sebody.contract.names import ANY
from sebody.explore.advice.changes import Choice, Step
from sebody.explore.advice.cost import of_form
from sebody.explore.advice.estimates import Estimates, expected, least
from sebody.explore.advice.first_runs import LONGER, MISSED
from sebody.explore.advice.forms import Form, Part, alike
from sebody.explore.advice.indicators.activity import activity
from sebody.explore.advice.labels import in_brief, in_units
from sebody.explore.advice.reference import ORDER_FACTOR
from sebody.explore.advice.runner import FINER, Laboratory, Tried

MOST_ALONE = 12             # forms of a part that are tried alone
APART = 0.5                 # of the budget, that all of them may take
MOST_TOGETHER = 24          # choices that are tried
SHARE = 0.5                 # of the tolerance, that one part may use
EXACT = 0.05                # of the tolerance, that a change may make that should make none
RARE = 0.5                  # steps of variable length relative to fixed ones, that pay
LOCAL = 8.0                 # factor of local tolerances: half as many steps
MOST = 200                  # combinations that are carried from part to part
REPEATS = 2                 # further runs of what is compared in time
QUICK = 0.2                 # seconds of runs that are repeated: longer ones vary less
# share of a run's time by which another one is clearly quicker, or quicker and more exact
QUICKER, SAME = 0.9, 0.95


class Search:
    """A search for the cheapest model.

    Parameters
    ----------
    lab : Laboratory
        With its reference.
    budget : float
        Runs of the reference model that the work may be worth.
    """

    def __init__(self, lab: Laboratory, budget: float):
        self.lab, self.budget, self.tolerance = lab, budget, lab.tolerance
        self.untried: list[str] = []
        self.planar = self.shared = self.dropped = self.variable = False
        self.exact: dict[str, float] = {}       # errors of what should change nothing
        self.groups = [[k] for k in range(len(lab.parts))]      # of parts that get like forms
        self._failed: list[Choice] = []
        self._times: dict[int, float] = {}      # of what was tried

    def go(self) -> Tried:
        """The whole search."""
        self._exact()
        self._variable()
        self._parts()
        return self._together()

    def _parts(self) -> None:
        """Try forms of parts: of those that are alike together, first where most is to gain."""
        groups = {tuple(group): self._gain(group) for group in alike(self.lab.parts)}
        self.groups = []
        left = sum(groups.values())
        for group, gain in sorted(groups.items(), key=lambda pair: -pair[1]):
            share = gain / left if gain > 0.0 else 0.0
            left -= gain
            self.groups += self._group(list(group), share)
        self.untried.sort(key=[part.name for part in self.lab.parts].index)

    def _group(self, group: list[int], share: float) -> list[list[int]]:
        """Try forms of parts that are alike, one by one where together none is enough.

        Returns
        -------
        list of list of int
            The parts that get like forms from here on.
        """
        if share == 0.0:
            return [group]
        if self.spent():
            self.untried += [self.lab.parts[k].name for k in group]
            return [group]
        if self._alone(group, share) or len(group) == 1:
            return [group]
        for n, k in enumerate(group):
            if self.spent():
                self.untried.append(self.lab.parts[k].name)
            else:
                self._alone([k], share / (len(group) - n))
        return [[k] for k in group]

    def _gain(self, group: list[int]) -> float:
        """Operations that the cheapest form which may be enough saves in parts that are alike."""
        part = self.lab.parts[group[0]]
        least_cost = min(self._cost(part, form) for form in part.forms
                         if form == part.detailed or self._may_do(group, form))
        return len(group) * (self._cost(part, part.detailed) - least_cost)

    def _cost(self, part: Part, form: Form) -> float:
        return of_form(part, form, self.planar)

    def _may_do(self, group: list[int], form: Form) -> bool:
        """Tell whether a form of some parts may be good enough, as far as it is known."""
        estimates = [one for k in group for one in self.lab.estimates.of_form(k, form)]
        return least(estimates) <= SHARE * self.tolerance

    def spent(self) -> bool:
        """Tell whether the budget is used up."""
        return self.lab.spent() > self.budget

    @property
    def base(self) -> Choice:
        """The reference model, with the longest step that resolves it and all exact changes."""
        return self.lab.detailed._replace(step=self.lab.trial, planar=self.planar,
                                         shared=self.shared, dropped=self.dropped)

    def _exact(self) -> None:
        """Try what should change nothing: shared and dropped DOF blocks, a planar model."""
        for name in ("shared", "dropped", "planar"):
            changed = self.base._replace(**{name: True})
            if name == "planar" and self.lab.unstable:
                continue
            if self.spent() or not self._applies(changed):
                continue
            tried, run = self.lab.attempt(changed, "alone")
            if run:
                self.exact[name] = self.lab.apart(run, changed.step.h)
            if self.exact.get(name, inf) <= EXACT * self.tolerance:
                setattr(self, name, True)

    def _applies(self, choice: Choice) -> bool:
        """Tell if a choice can be made, differs from that before, and has kernels of its own."""
        before = self.lab.builder.make(self.base)
        try:
            after = self.lab.builder.make(choice)
        except InputError:      # the model is planar, or not symmetric
            return False
        general = [any(f"_{ANY}_" in body.kernel for body in made.model.bodies.values())
                   for made in (before, after)]
        return after.changes != before.changes and general[1] <= general[0]

    def _variable(self) -> None:
        """Try variable steps where the motion is smooth except for short times."""
        finest = self.lab.bases[min(self.lab.bases)]
        if self.spent() or not self.lab.quantities.histories or (
                activity(finest.result) > RARE):
            return
        step = Step(self.lab.runs.h, self.tolerance / LOCAL)
        tried, run = self.lab.attempt(self.base._replace(step=step), "alone")
        if run:
            self.variable = True
            self.lab.estimates.learn_step(step, tried.error)

    def _alone(self, group: list[int], share: float) -> bool:
        """Try forms of a part, or of several alike, the others as rich as they are.

        Parameters
        ----------
        share : float
            Of what is left of the budget for this.

        Returns
        -------
        bool
            Whether one was good enough.
        """
        part, base = self.lab.parts[group[0]], self.base
        failed: list[Form] = []
        best = inf
        cost = partial(self._cost, part)
        forms = sorted((form for form in part.forms if form != part.detailed), key=cost)
        most = self.lab.spent() + share * max(APART * self.budget - self.lab.spent(), 0.0)
        for _ in range(MOST_ALONE):
            form = next((
                f for f in forms if cost(f) < best and not any(f.poorer(one) for one in failed)
                and self._may_do(group, f)), None)
            if form is None or self.lab.spent() > most:
                break
            forms.remove(form)
            choice = base._replace(forms=tuple(
                form if i in group else one for i, one in enumerate(base.forms)))
            _, run = self.lab.attempt(choice, "alone")
            error = self.lab.apart(run, base.step.h) if run else inf
            for k in group:     # errors add up as squares
                self.lab.estimates.learn_form(k, form, error / len(group)**0.5)
            if error <= SHARE * self.tolerance:
                best = cost(form)
            else:
                failed.append(form)
        return best < inf

    def steps(self) -> list[Step]:
        """Steps that are tried; frequencies do not depend on it."""
        h, shortest = self.lab.runs.h, min(self.lab.bases)
        if not self.lab.quantities.histories:
            return [Step(h)]
        count = round(self.lab.runs.t_end / h)
        candidates = [Step(k * h) for k in reversed(LONGER)
                      if count % k == 0 and self.lab.missed(k * h).share <= MISSED]
        candidates += [Step(h / k) for k in sorted(FINER)]
        while candidates[-1].h > shortest or expected(
                self.lab.estimates.of_step(candidates[-1])) > SHARE * self.tolerance:
            candidates.append(candidates[-1].finer())
        if self.variable:
            candidates += [Step(h, self.tolerance * LOCAL**k) for k in (2, 1, 0, -1, -2, -3)]
        return candidates

    def _together(self) -> Tried:
        """Try choices of all forms and steps, cheapest first; the first that is confirmed."""
        for _ in range(MOST_TOGETHER):
            choice = self.next(self.tolerance)
            if choice is None or self.spent():
                break
            tried = self._tried(choice) or self._attempt(choice)
            if tried.error <= self.tolerance and self._confirmed(tried):
                return tried
            self._failed.append(choice)
        return self.best()

    def _tried(self, choice: Choice) -> Tried | None:
        """A choice that ran already, perhaps alone."""
        return next((one for one in self.lab.tried if one.choice == choice), None)

    def _attempt(self, choice: Choice) -> Tried:
        tried, run = self.lab.attempt(choice, "together")
        if run:
            self.lab.estimates.learn(choice, tried.error)
        return tried

    def best(self) -> Tried:
        """The quickest run that was good enough; the most exact one where none was."""
        passing = [one for one in self.lab.tried if one.error <= self.tolerance
                   and one.choice not in self._failed]
        if not passing:
            return min(self.lab.tried, key=lambda one: one.error)
        return min(passing, key=lambda one: one.seconds)

    def better(self, found: Tried) -> Tried:
        """The best of all runs that were good enough, in place of the one that was found.

        Choices are tried in the order of the cost that is predicted. Another run may be quicker, or
        as quick and more exact; why it is not chosen is remarked.
        """
        if found.error > self.tolerance:
            return found
        for one in sorted((one for one in self.lab.tried if one.choice != found.choice
                           and one.error <= self.tolerance), key=lambda one: one.seconds):
            if one.seconds >= self.timed(found):
                break
            if not (self.timed(one) < QUICKER * self.timed(found) or (
                    one.error < found.error and self.timed(one) < SAME * self.timed(found))):
                self._say(one, f"as often as the one chosen a run takes {in_units(self.timed(one))}"
                          f", not clearly less than {in_units(self.timed(found))}")
            elif one.choice in self._failed or not self._confirmed(one):
                self._say(one, "with half its step its error is above the tolerance")
            else:
                return one
        return found

    def _say(self, one: Tried, why: str) -> None:
        local = one.choice.step.local
        step = f"step {one.choice.step.h:.4g}" + f", local tolerance {local or 0:.2g}" * bool(local)
        self.lab.remarks.append(
            f"{in_brief(self.lab.parts, one.choice)}, {step}, was quicker with an error of "
            f"{one.error:.2g}, and is not chosen: {why}")

    def timed(self, found: Tried) -> float:
        """Time of a run, the least of several where it is short."""
        if id(found) not in self._times:
            seconds = [found.seconds]
            if found.seconds <= QUICK and not self.spent():
                seconds += [self.lab.run(found.choice).seconds for _ in range(REPEATS)]
            self._times[id(found)] = min(seconds)
        return self._times[id(found)]

    def next(self, tolerance: float, sure: bool = False) -> Choice | None:
        """The cheapest choice that may be within a tolerance, or that should be."""
        judged = expected if sure else least
        forms = [[part.detailed] if part.name in self.untried else list(part.forms)
                 for part in self.lab.parts]
        candidates = [self.base._replace(forms=one, step=step)
                      for one in combinations(self.lab.parts, forms, self.lab.estimates,
                                              self.planar, self.groups)
                      for step in self.steps()]
        done = [] if sure else [*self._failed, *(
            one.choice for one in self.lab.tried if one.error > self.tolerance)]
        return next((one for one in sorted(candidates, key=self.lab.cost.of)
                     if not any(self._excludes(other, one) for other in done)
                     and judged(self.lab.estimates.contributions(one)) <= tolerance), None)

    def _excludes(self, failed: Choice, one: Choice) -> bool:
        """Tell whether a choice that was not enough says that another one is not, either.

        Vibrations of the reference model need shorter steps than simplified models may need.
        """
        whole = failed.forms == self.lab.detailed.forms
        return one == failed if whole else one.poorer(failed)

    def halved(self, choice: Choice) -> float | None:
        """Error of the step of a choice, from its run with half of it; None without one."""
        coarse, fine = self._tried(choice), self._tried(choice._replace(step=choice.step.finer()))
        if coarse is None or fine is None or inf in (coarse.error, fine.error):
            return None
        return ORDER_FACTOR / (ORDER_FACTOR - 1.0) * abs(coarse.error - fine.error)

    def _confirmed(self, found: Tried) -> bool:
        """Tell whether the error stays within the tolerance with half the step."""
        half = found.choice._replace(step=found.choice.step.finer())
        if half.step.local is None and half.step.h < min(self.lab.bases):
            return True
        again = self._tried(half) or self.lab.attempt(half, "confirmation")[0]
        return again.error <= self.tolerance


def combinations(parts: Sequence[Part], forms: Sequence[Sequence[Form]], estimates: Estimates,
                 flat: bool, groups: Sequence[Sequence[int]]) -> list[tuple[Form, ...]]:
    """Forms of all parts, cheapest first; parts of a group have the same form."""
    combined: list[tuple[float, float, tuple[Form, ...]]] = [(0.0, 0.0, ())]
    for group in groups:
        own = forms[group[0]]
        squares = [sum(expected(estimates.of_form(k, form))**2 for k in group) for form in own]
        front = _front([(sum(of_form(parts[k], form, flat) for k in group), square, (form,))
                        for form, square in zip(own, squares, strict=True)])
        combined = _thinned(_front([(a + b, e + f, (*one, *other)) for a, e, one in combined
                                    for b, f, other in front]))
    return [_spread(one, groups, len(parts)) for _, _, one in combined]


def _spread(forms: Sequence[Form], groups: Sequence[Sequence[int]], count: int) -> tuple:
    """The form of each part, from that of its group."""
    of_part = {k: form for form, group in zip(forms, groups, strict=True) for k in group}
    return tuple(of_part[k] for k in range(count))


def _front(points: list[tuple[float, float, tuple[Form, ...]]]) -> list:
    """Those that no cheaper one equals or beats in error."""
    kept, best = [], float("inf")
    for point in sorted(points):
        if point[1] < best:
            kept.append(point)
            best = point[1]
    return kept


def _thinned(points: list) -> list:
    """At most so many of a front, evenly, with both its ends."""
    if len(points) <= MOST:
        return points
    return [points[round(k * (len(points) - 1) / (MOST - 1))] for k in range(MOST)]
