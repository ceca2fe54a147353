"""In a process of its own: clingo reads a program and says what follows from it."""

import re
from typing import Any

import clingo
from clingo import ast

from tpvqa.pddl.outside.serving import Serving

ATOMS = 200_000
"""More facts than these are not taken."""

_PLACED = re.compile(r"[^:]*:(\d+)[\d:-]*: (?:error|info|warning): (.*)", re.DOTALL)

_TAKEN = {ast.ASTType.Rule, ast.ASTType.ShowSignature, ast.ASTType.Definition, ast.ASTType.Program}
_SHOW = {ast.ASTType.ShowTerm, ast.ASTType.Comment} if hasattr(ast.ASTType, "Comment") else set()


class _Refused(Exception):  # noqa: N818
    def __init__(self, message: str, line: int | None = None):
        super().__init__(message)
        self.line = line


def ground(text: str) -> dict[str, Any]:
    """What follows from a program.

    Returns:
        "atoms", each as `term` writes it; "heads" of rules as `[predicate, name of what it speaks
        of first, that one's variables, line]`. Or what is wrong: "error" and its "line".
    """
    said: list[str] = []

    def hear(_: clingo.MessageCode, message: str) -> None:
        said.append(message)

    try:
        parts: list[Any] = []
        ast.parse_string(text, parts.append, logger=hear)
        heads = [head for part in parts for head in _heads(part)]
        control = clingo.Control(["--warn=no-atom-undefined"], logger=hear)
        control.add(text)
        control.ground()
        if said:  # a term that cannot be worked out
            return {"kind": "error", **_placed(said, "")}
        return {"kind": "model", "heads": heads, "atoms": _model(control)}
    except _Refused as error:
        return {"kind": "error", "error": str(error), "line": error.line}
    except RuntimeError as error:
        return {"kind": "error", **_placed(said, str(error))}


def _heads(part: Any) -> list[list[Any]]:
    line = part.location.begin.line
    if part.ast_type in _SHOW:
        return []
    if part.ast_type not in _TAKEN:
        raise _Refused(
            f"{part.ast_type.name} is not read: the program says what there is and what follows, "
            "the planner chooses",
            line,
        )
    if part.ast_type == ast.ASTType.Program and (part.name != "base" or part.parameters):
        raise _Refused(f"#program {part.name} is not read; leave the parts out", line)
    if part.ast_type != ast.ASTType.Rule:
        return []
    head = part.head
    if head.ast_type == ast.ASTType.Literal and head.atom.ast_type == ast.ASTType.BooleanConstant:
        return []  # a constraint
    if head.ast_type != ast.ASTType.Literal or head.atom.ast_type != ast.ASTType.SymbolicAtom:
        raise _Refused(
            "only one plain atom can be the head of a rule: no choice, no disjunction (the planner "
            "chooses the actions)",
            line,
        )
    function = head.atom.symbol
    if function.ast_type != ast.ASTType.Function:
        return []
    first = function.arguments[0] if function.arguments else None
    name, variables = None, []
    if first is not None and first.ast_type == ast.ASTType.Function:
        name = first.name
        variables = [
            each.name if each.ast_type == ast.ASTType.Variable else "" for each in first.arguments
        ]
    elif first is not None and first.ast_type == ast.ASTType.SymbolicTerm:
        name = str(first)
    return [[function.name, name, variables, line]]


def _model(control: clingo.Control) -> list[Any]:
    control.configuration.solve.models = "2"  # type: ignore[union-attr]
    with control.solve(yield_=True) as handle:
        found = [list(model.symbols(atoms=True)) for model in handle]
    if not found:
        raise _Refused("the program has no answer set: its constraints contradict its rules")
    if len(found) > 1:
        raise _Refused(
            "the program has more than one answer set; write what there is and what follows from "
            "it (no even loop through not), the planner chooses"
        )
    if len(found[0]) > ATOMS:
        raise _Refused(f"{len(found[0])} facts follow from the program, {ATOMS} are taken at most")
    return [_term(symbol) for symbol in found[0]]


def _term(symbol: clingo.Symbol) -> Any:
    """A number; or `[name, arguments, positive]`, the name of a tuple being empty."""
    if symbol.type == clingo.SymbolType.Number:
        return symbol.number
    if symbol.type == clingo.SymbolType.Function:
        return [symbol.name, [_term(each) for each in symbol.arguments], symbol.positive]
    return str(symbol)


def _placed(said: list[str], otherwise: str) -> dict[str, Any]:
    """clingo's first error, with its line."""
    errors = [each for each in said if "error:" in each] or said or [otherwise]
    found = _PLACED.match(errors[0])
    message, line = (found[2], int(found[1])) if found else (errors[0], None)
    return {"error": " ".join(message.split()), "line": line}


def answer(request: dict[str, Any]) -> dict[str, Any]:
    """What a request asks for."""
    return ground(request["text"])


if __name__ == "__main__":
    Serving(answer).run()
