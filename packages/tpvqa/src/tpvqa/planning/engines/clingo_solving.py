"""Answer set programming: shortest plans with clingo (Gebser et al. 2019), horizon by horizon."""

import time
from collections.abc import Iterator
from typing import Any

import clingo

from tpvqa.pddl.outside.serving import Serving

# What both added and deleted is, holds. A derived atom follows anew from every state.
_ENCODING = """
#program base.
holds(F,0) :- init(F).

#program state(t).
true(C,t) :- literal(C,F,1), holds(F,t).
true(C,t) :- literal(C,F,0), not holds(F,t).
true(C,t) :- all(C), true(D,t) : part(C,D).
true(C,t) :- any(C), part(C,D), true(D,t).
holds(F,t) :- rule(F,C), true(C,t).

#program step(t).
1 { occurs(A,t) : action(A) } 1.
:- occurs(A,t), needs(A,C), not true(C,t-1).
added(F,t) :- occurs(A,t), effect(A,C,F,1), true(C,t-1).
deleted(F,t) :- occurs(A,t), effect(A,C,F,0), true(C,t-1).
holds(F,t) :- added(F,t).
holds(F,t) :- holds(F,t-1), not deleted(F,t), not derived(F).

#program apart(s,t).
differ(s,t) :- varies(F), holds(F,s), not holds(F,t).
differ(s,t) :- varies(F), holds(F,t), not holds(F,s).
:- not differ(s,t).

#program check(t).
#external query(t).
:- query(t), goal(C), not true(C,t).
"""

_CHEAPEST = """
#program cheapest(t).
#minimize { N,s : occurs(A,s), cost(A,N), s = 1..t }.
"""


def solve(request: dict[str, Any]) -> dict[str, Any]:
    """The shortest plan of a numbered task; among the shortest, one of least cost.

    No two states of a plan are alike. So where no sequence of some length is left at all, there is
    no longer one either, and if the goal was never met there is no plan.
    """
    task, seconds = request["task"], request["seconds"]
    end = None if seconds is None else time.monotonic() + seconds
    control = clingo.Control(["--warn=none"])
    control.add("base", [], "".join(_facts(task)))
    control.add(_ENCODING)
    control.ground([("base", []), ("state", [clingo.Number(0)]), ("check", [clingo.Number(0)])])
    horizon = 0
    while True:
        number = clingo.Number(horizon)
        query = clingo.Function("query", [number])
        control.assign_external(query, True)
        found = _search(control, end)
        if found is not None and found["kind"] == "plan":
            return _cheapest(task, found, horizon, end)
        if found is not None:
            return found
        control.release_external(query)
        possible = _search(control, end)
        if possible is None:
            return {"kind": "unsolvable", "horizon": horizon}
        if possible["kind"] != "plan":
            return possible
        horizon += 1
        number = clingo.Number(horizon)
        control.ground([("step", [number]), ("state", [number]), ("check", [number])])
        control.ground([("apart", [clingo.Number(s), number]) for s in range(horizon)])


def _search(control: clingo.Control, end: float | None) -> dict[str, Any] | None:
    """An answer set's actions; None where there is none."""
    with control.solve(yield_=True, async_=True) as handle:
        handle.resume()
        left = None if end is None else max(0.0, end - time.monotonic())
        if not handle.wait(left):
            handle.cancel()
            return {"kind": "timeout"}
        model = handle.model()
        return None if model is None else {"kind": "plan", "steps": _steps(model)}


def _cheapest(
    task: dict[str, Any], found: dict[str, Any], horizon: int, end: float | None
) -> dict[str, Any]:
    """Of the plans of a length one of least cost, or the best until the time was over."""
    if len({cost for _, _, cost in task["actions"]}) <= 1 or not horizon:
        return found
    control = clingo.Control(["--warn=none"])
    control.add("base", [], "".join(_facts(task)))
    control.add(_ENCODING + _CHEAPEST)
    numbers = [clingo.Number(n) for n in range(horizon + 1)]
    control.ground([("base", []), ("state", [numbers[0]])])
    for number in numbers[1:]:
        control.ground([("step", [number]), ("state", [number])])
    control.ground([("check", [numbers[-1]]), ("cheapest", [numbers[-1]])])
    control.assign_external(clingo.Function("query", [numbers[-1]]), True)
    with control.solve(yield_=True, async_=True) as handle:
        while True:
            handle.resume()
            left = None if end is None else max(0.0, end - time.monotonic())
            if not handle.wait(left):
                handle.cancel()
                return found
            model = handle.model()
            if model is None:
                return found
            found = {"kind": "plan", "steps": _steps(model)}


def _steps(model: clingo.Model) -> list[int]:
    """The numbers of the actions of a plan."""
    steps = {
        symbol.arguments[1].number: symbol.arguments[0].number
        for symbol in model.symbols(atoms=True)
        if symbol.name == "occurs"
    }
    return [steps[number] for number in sorted(steps)]


def _facts(task: dict[str, Any]) -> Iterator[str]:
    """A numbered task as facts."""
    conditions: dict[str, int] = {}
    written: list[str] = []

    def number(condition: list[Any]) -> int:
        key = repr(condition)
        if key in conditions:
            return conditions[key]
        own = conditions[key] = len(conditions)
        if condition[0] in ("and", "or"):
            written.append(f"{'all' if condition[0] == 'and' else 'any'}({own}).\n")
            written.extend(f"part({own},{number(part)}).\n" for part in condition[1:])
        else:
            written.append(f"literal({own},{condition[0]},{int(condition[1])}).\n")
        return own

    derived = {head for head, _ in task["rules"]}
    yield "".join(f"init({atom}).\n" for atom in task["init"])
    yield "".join(f"varies({a}).\n" for a in range(task["atoms"]) if a not in derived)
    yield "".join(f"derived({atom}).\n" for atom in derived)
    for own, (needs, effects, cost) in enumerate(task["actions"]):
        yield f"action({own}).\ncost({own},{cost}).\nneeds({own},{number(needs)}).\n"
        for condition, atom, holds in effects:
            yield f"effect({own},{number(condition)},{atom},{int(holds)}).\n"
    for head, condition in task["rules"]:
        yield f"rule({head},{number(condition)}).\n"
    yield f"goal({number(task['goal'])}).\n"
    yield "".join(written)


def answer(request: dict[str, Any]) -> dict[str, Any]:
    """What a request asks for."""
    return solve(request)


if __name__ == "__main__":
    Serving(answer).run()
