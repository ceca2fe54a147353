"""PDDL files, or a logic program, → `Task`. The text is read once, here; the worker grounds it."""

from codecs import BOM_UTF16_BE, BOM_UTF16_LE
from pathlib import Path
from typing import Any

from tpvqa.errors import PDDLError
from tpvqa.pddl.arithmetic import expression
from tpvqa.pddl.description import MEMORY, described, grounded_fields, unsure_fields
from tpvqa.pddl.lasting import Lasting
from tpvqa.pddl.numeric import Numeric, check_values
from tpvqa.pddl.programs.loading import pddl_of
from tpvqa.pddl.schema import (
    ActionSchema,
    AxiomSchema,
    ChangeSchema,
    ComparisonSchema,
    ConditionSchema,
    EffectSchema,
    Junction,
    LiteralSchema,
    Parameter,
    Quantified,
    ground_condition,
)
from tpvqa.pddl.task import Task
from tpvqa.tasks import is_program
from tpvqa.text_files import read_bytes


def load_task(
    name_or_domain: str | Path,
    problem: str | Path | None = None,
    *,
    timeout: float | None = 300.0,
    memory: int | None = MEMORY,
) -> Task:
    """Read a task.

    Args:
        name_or_domain: The name of a shipped task, or the path of a domain or of a logic program
            (`.lp`, see docs/planners.md).
        problem: The path of the problem, where the first argument is a domain's; a logic program
            may be named twice, and needs no other.
        timeout: Seconds that reading and grounding may take; None for no limit.
        memory: The limit of their memory in MiB; None for none.

    Raises:
        UnknownNameError: There is no shipped task of that name.
        PDDLError: A file is missing or cannot be read as PDDL.
        GroundingTimedOut: It took too long.
        PlannerError: Grounding failed.
        MissingExtraError: It is a logic program, and clingo is not installed.

    Example:
        >>> load_task("clean_dishes").goal
        Literal(atom=Atom(predicate='clean', arguments=('plate',)), positive=True)
    """
    if is_program(name_or_domain):
        if problem is not None and Path(problem) != Path(name_or_domain):
            raise PDDLError(
                "a logic program is domain and problem in one; name nothing beside it",
                file=name_or_domain,
            )
        return _program(Path(name_or_domain), timeout, memory)
    if problem is not None and is_program(problem):
        raise PDDLError(
            "a logic program is domain and problem in one; name no domain beside it", file=problem
        )
    if problem is None:
        from tpvqa.tasks import find_task

        if Path(name_or_domain).suffix.lower() == ".pddl":
            raise PDDLError("a domain alone is no task; name its problem too", file=name_or_domain)
        files = find_task(str(name_or_domain))
        domain_path, problem_path = files.domain, files.problem
    else:
        domain_path, problem_path = Path(name_or_domain), Path(problem)
    return task_from_text(
        _text(domain_path, "domain"),
        _text(problem_path, "problem"),
        domain_path=domain_path,
        problem_path=problem_path,
        timeout=timeout,
        memory=memory,
    )


def task_from_text(
    domain: str,
    problem: str,
    *,
    domain_path: Path | None = None,
    problem_path: Path | None = None,
    timeout: float | None = 300.0,
    memory: int | None = MEMORY,
) -> Task:
    """Read a task from PDDL text; the paths are only what errors name.

    Raises:
        PDDLError: The text cannot be read as PDDL.
        GroundingTimedOut: It took too long.
        PlannerError: Grounding failed.
    """
    description = described(
        domain,
        problem,
        domain_path=domain_path,
        problem_path=problem_path,
        timeout=timeout,
        memory=memory,
    )
    objects_by_type = {
        kind: tuple(things) for kind, things in description["objects_by_type"].items()
    }
    numeric = Numeric.of(description["numeric"])
    task = Task(
        name=description["name"],
        domain_name=description["domain_name"],
        objects=dict(description["objects"]),
        types=dict(description["types"]),
        predicates={name: tuple(types) for name, types in description["predicates"]},
        predicate_variables={
            name: tuple(variables) for name, variables in description["predicate_variables"].items()
        },
        goal=ground_condition(_condition(description["goal"], numeric), {}, objects_by_type),
        fluents=frozenset(description["fluents"]),
        derived=frozenset(description["derived"]),
        schemas=tuple(_action(part, numeric) for part in description["actions"]),
        axioms=tuple(
            AxiomSchema(
                part["predicate"], _parameters(part["parameters"]), _condition(part["condition"])
            )
            for part in description["axioms"]
        ),
        objects_by_type=objects_by_type,
        functions={tuple(words): value for words, value in description["functions"]},
        domain_path=domain_path,
        problem_path=problem_path,
        domain_text=domain,
        problem_text=problem,
        lasting=Lasting.of(description["durative"]),
        numeric=numeric,
        metric=description["metric"],
        **grounded_fields(description, None if numeric is None else numeric.init),
        **unsure_fields(description),
    )
    if numeric is not None:
        check_values(task, numeric)
    if task.axioms:
        try:
            task.derivation(task.init)  # so that axioms which cannot be layered are told now
        except PDDLError as error:
            raise PDDLError(str(error), file=domain_path or "(domain)") from None
    return task


def _program(path: Path, timeout: float | None, memory: int | None) -> Task:
    domain, problem = pddl_of(_text(path, "program"), path=path, timeout=timeout, memory=memory)
    try:
        return task_from_text(
            domain, problem, domain_path=path, problem_path=path, timeout=timeout, memory=memory
        )
    except PDDLError as error:  # its lines are not those of the program
        raise PDDLError(f"written as PDDL, {error.message}", file=path) from None


def _text(path: Path, part: str) -> str:
    data = read_bytes(path, PDDLError, what=f"{part} file")
    if data.startswith((BOM_UTF16_LE, BOM_UTF16_BE)):
        raise PDDLError("this is UTF-16, not UTF-8 text; save the file as UTF-8", file=path)
    # Comments may hold anything; Latin-1 reads what is not UTF-8.
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _parameters(pairs: list[list[str]]) -> tuple[Parameter, ...]:
    return tuple(Parameter(name, kind) for name, kind in pairs)


def _condition(written: list[Any], numeric: Numeric | None = None) -> ConditionSchema:
    tag, *rest = written
    if tag == "literal":
        return _literal(written)
    if tag in ("and", "or"):
        return Junction(tag == "and", tuple(_condition(part, numeric) for part in rest))
    if tag == "compare":
        assert numeric is not None
        return ComparisonSchema(rest[0], expression(rest[1]), expression(rest[2]), numeric)
    return Quantified(tag == "forall", _parameters(rest[0]), _condition(rest[1], numeric))


def _literal(written: list[Any]) -> LiteralSchema:
    _, positive, predicate, *arguments = written
    return LiteralSchema(predicate, tuple(arguments), positive)


def _action(part: dict[str, Any], numeric: Numeric | None) -> ActionSchema:
    cost = part["cost"]
    changes: tuple[ChangeSchema, ...] = ()
    if numeric is not None:
        changes = tuple(
            ChangeSchema(
                _parameters(parameters),
                _condition(condition, numeric),
                kind,
                tuple(function),
                expression(by),
                numeric,
            )
            for parameters, condition, kind, function, by in part["changes"]
        )
    return ActionSchema(
        part["name"],
        _parameters(part["parameters"]),
        _condition(part["precondition"], numeric),
        tuple(
            EffectSchema(_parameters(parameters), _condition(condition, numeric), _literal(literal))
            for parameters, condition, literal in part["effects"]
        ),
        cost if isinstance(cost, int) else tuple(cost),
        changes,
    )
