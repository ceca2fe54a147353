"""A comparison of VLMs as tables, and as the rows of a file."""

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from tpvqa.cli.saying import cell, tell

if TYPE_CHECKING:
    from rich.table import Table

    from tpvqa.bench.vlms.comparing import Comparison, OfVLM
    from tpvqa.bench.vlms.scoring import Estimate, Score

_HEADS = {
    "accuracy": "accuracy",
    "when_answered": "if answered",
    "balanced_accuracy": "balanced",
    "auroc": "AUROC",
    "calibration_error": "ECE",
    "log_loss": "log loss",
    "abstained": "abstained",
}


def print_comparison(found: "Comparison") -> None:
    """Print all VLMs, then their parts, differences and wordings."""
    from tpvqa.bench.vlms.comparing import NOT_KNOWN
    from tpvqa.bench.vlms.lasting import LEAST
    from tpvqa.cli.consoles import ResultConsole

    console = ResultConsole()
    console = console if console.is_terminal else ResultConsole(width=150)
    intervals = "95% intervals over" if found.clusters >= LEAST else "too few for intervals:"
    tell(
        f"{found.of}: {found.looks:,} looks; {intervals} {found.clusters} groups of looks that "
        f"hang together ({found.cluster})"
    )
    console.print(_whole(found))
    for by in dict.fromkeys(part.by for vlm in found.vlms for part in vlm.parts):
        console.print(_parts(found.vlms, by))
    for each in found.differences:
        tell(
            f"{each.first} less {each.second}, on the same {each.pairs:,} questions: accuracy "
            f"{_signed(each.accuracy)}, balanced {_signed(each.balanced_accuracy)}"
        )
    if found.wordings:
        console.print(_wordings(found))
        if any(each.verdict == NOT_KNOWN for each in found.wordings):
            tell(
                f"which wording is best is not known where there are fewer than {LEAST} groups of "
                "looks: no interval can be given"
            )
    for vlm in found.vlms:
        tell(_about_lasting(vlm))


def _whole(found: "Comparison") -> "Table":
    table = _table("VLM", "answers", *_HEADS.values(), "lasting", "s each", "price each")
    for vlm in found.vlms:
        lasting = vlm.lasting
        table.add_row(
            cell(vlm.vlm),
            f"{vlm.score.answers:,}",
            *(_said(getattr(vlm.score, name)) for name in _HEADS),
            _interval(lasting.share, lasting.low, lasting.high),
            "–" if vlm.score.seconds.value is None else f"{vlm.score.seconds.value:.3f}",
            "–" if vlm.price is None else f"{vlm.price:g}",
        )
    return table


def _parts(vlms: "Sequence[OfVLM]", by: str) -> "Table":
    table = _table(f"accuracy by {by}", "answers", *(vlm.vlm for vlm in vlms))
    scores = {(part.name, vlm.vlm): part.score for vlm in vlms for part in _of(vlm, by)}
    for name in sorted({name for name, _ in scores}):
        told = [scores.get((name, vlm.vlm)) for vlm in vlms]
        count = max(score.answers for score in told if score is not None)
        figures = ["–" if score is None else _said(score.accuracy) for score in told]
        table.add_row(cell(name), f"{count:,}", *figures)
    return table


def _of(vlm: "OfVLM", by: str) -> "Iterator[Any]":
    return (part for part in vlm.parts if part.by == by)


def _wordings(found: "Comparison") -> "Table":
    table = _table(
        "VLM", "about", "wording", "for example", "balanced", "less the first", "verdict"
    )
    for each in found.wordings:
        other = each.difference
        table.add_row(
            cell(each.vlm),
            cell(each.predicate or "all"),
            cell(each.wording),
            cell(each.example if each.predicate else ""),
            _said(each.score.balanced_accuracy),
            "" if other is None else _signed(other.balanced_accuracy),
            each.verdict,
        )
    return table


def _table(first: str, *others: str) -> "Table":
    from rich.table import Table

    table = Table(box=None, pad_edge=False)
    table.add_column(cell(first), overflow="fold")
    for name in others:
        words = name in ("about", "wording", "for example")
        table.add_column(cell(name), justify="left" if words else "right")
    return table


def _about_lasting(vlm: "OfVLM") -> str:
    found = vlm.lasting
    if found.share is None:
        other = f"whether errors last is not known: {_why_not_known(vlm)}"
    else:
        other = (
            f"errors that last {_interval(found.share, found.low, found.high)}, by {found.pairs:,} "
            "pairs of answers about other pictures of one scene"
        )
    if found.same_picture is None:
        return f"{vlm.vlm}: {other}"
    return (
        f"{vlm.vlm}: {other}; on one picture asked again {_plain(found.same_picture)} "
        f"({found.same_picture_pairs:,} pairs)"
    )


def _why_not_known(vlm: "OfVLM") -> str:
    pairs = vlm.lasting.pairs
    if not pairs:
        return "no question was answered of two pictures of one scene"
    of = f"in {pairs:,} pairs of answers about other pictures of one scene"
    if vlm.score.when_answered.value == 1:
        return f"{of} there is no error"
    return f"{of} a predicate's errors are all or none, and so tell scenes not apart"


def figure_rows(found: "Comparison") -> list[dict[str, Any]]:
    """Every figure with its interval: one row each."""
    rows: list[dict[str, Any]] = []
    for vlm in found.vlms:
        rows += _rows(vlm.vlm, "all", "", vlm.score)
        last = vlm.lasting
        told = {"value": last.share, "low": last.low, "high": last.high}
        rows.append(_row(vlm.vlm, "all", "", "lasting", last.pairs) | told)
        rows.append(
            _row(vlm.vlm, "all", "", "lasting on one picture", last.same_picture_pairs)
            | {"value": last.same_picture}
        )
        rows.append(_row(vlm.vlm, "all", "", "price", vlm.score.answers) | {"value": vlm.price})
        for part in vlm.parts:
            rows += _rows(vlm.vlm, part.by, part.name, part.score)
    for each in found.differences:
        for name in ("accuracy", "balanced_accuracy"):
            named = _row(each.first, "less", each.second, f"difference of {name}", each.pairs)
            rows.append(named | _estimate(getattr(each, name)))
    for line in found.wordings:
        if line.difference is not None:
            what = f"{line.predicate or 'all'}: {line.wording} less {line.difference.second}"
            named = _row(
                line.vlm, "wording", what, "difference of balanced_accuracy", line.difference.pairs
            )
            rows.append(named | _estimate(line.difference.balanced_accuracy))
    return rows


def _rows(vlm: str, by: str, name: str, score: "Score") -> "Iterator[dict[str, Any]]":
    for figure in (*_HEADS, "seconds"):
        yield _row(vlm, by, name, figure, score.answers) | _estimate(getattr(score, figure))


def _row(vlm: str, by: str, name: str, figure: str, count: int) -> dict[str, Any]:
    told = {"vlm": vlm, "by": by, "name": name, "figure": figure, "count": count}
    return told | dict.fromkeys(("value", "low", "high"))


def _estimate(found: "Estimate") -> dict[str, Any]:
    return {"value": found.value, "low": found.low, "high": found.high}


def _said(found: "Estimate") -> str:
    return _interval(found.value, found.low, found.high)


def _interval(value: float | None, low: float | None, high: float | None) -> str:
    if value is None:
        return "–"
    return (
        _plain(value)
        if low is None or high is None
        else (f"{_plain(value)} ({_plain(low)}–{_plain(high)})")
    )


def _signed(found: "Estimate") -> str:
    if found.value is None:
        return "–"
    if found.low is None or found.high is None:
        return f"{found.value:+.3f}"
    return f"{found.value:+.3f} ({found.low:+.3f} to {found.high:+.3f})"


def _plain(value: float) -> str:
    said = f"{value:.{3 if value < 1 else 2}f}"
    return said[1:] if said.startswith("0.") else said
