"""Put what the belief bench has measured into the documentation.

`python experiments/tools/belief_docs.py FOLDER`, with the folder that `tpvqa bench belief` has
written. Between `<!-- NAME -->` and `<!-- end -->`, the tables of `docs/belief-measured.md` are
made again; `docs/belief-results.md` and the figures are copied.
"""

import argparse
import csv
import json
import re
import shutil
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parents[2] / "docs"
TASKS = ("clean_dishes", "serve_breakfast", "eat_apple")
VOTES = ("tpvqa", "tpvqa:3", "tpvqa:5", "tpvqa:strict", "tpvqa:3:strict", "tpvqa:5:strict")
CONDITIONS = (
    ("p = .6, ρ = 0", "oracle:0.6"),
    ("p = .8, ρ = 0", "oracle:0.8"),
    ("p = .95, ρ = 0", "oracle:0.95"),
    ("p = .8, ρ = .5", "oracle:0.8:0.5"),
    ("the paper's table", "paper-table"),
    ("embedded network, shipped pictures", "embedded"),
)
PARTS = ("consistency", "relevance", "calibration", "model", "learning")
FIGURES = {
    "curves_rho_0.png": "belief-curves.png",
    "embedded.png": "belief-embedded.png",
    "learning.png": "belief-learning.png",
    "ablations.png": "belief-ablations.png",
}
Row = dict[str, Any]


class Measured:
    """The summary of a bench, cell by cell."""

    def __init__(self, folder: Path):
        with (folder / "summary.csv").open(encoding="utf-8") as file:
            self.rows: list[Row] = list(csv.DictReader(file))
        self.checks: list[Row] = json.loads((folder / "targets.json").read_text(encoding="utf-8"))

    def find(self, vlm: str, task: str, monitor: str) -> Row | None:
        """The cell of a VLM, a task and a monitor, under the usual conditions."""
        return next(
            (
                row
                for row in self.rows
                if (row["vlm"], row["task"], row["monitor"]) == (vlm, task, monitor)
                and not row["condition"]
            ),
            None,
        )

    def episodes(self, rows: Iterable[Row | None]) -> str:
        """How many episodes the cells have: "1,000", or "200 to 1,000"."""
        counts = [int(row["episodes"]) for row in rows if row]
        if not counts:
            return "no"
        least, most = min(counts), max(counts)
        return f"{least:,}" if least == most else f"{least:,} to {most:,}"

    def answers(self) -> Iterator[Sequence[str]]:
        """The belief beside TP, the paper's monitor and votes."""
        yield ("answers", "task", "TP", "TPVQA", "tpvqa:5", "best vote", "belief")
        for name, vlm in CONDITIONS:
            for task in TASKS:
                found = {each: self.find(vlm, task, each) for each in ("tp", *VOTES, "belief")}
                votes = [found[each] for each in VOTES if found[each]]
                if found["belief"] is None or not votes:
                    continue
                best = max(votes, key=lambda row: float(row["completion_rate"]))
                yield (
                    name if task == TASKS[0] else "",
                    task,
                    _rate(found["tp"]),
                    _full(found["tpvqa"]),
                    _full(found["tpvqa:5"]),
                    f"{_rate(best)} ({best['monitor']})",
                    _full(found["belief"]),
                )

    def targets(self) -> Iterator[Sequence[str]]:
        """Each condition with what it had to reach; figures of three tasks on one line."""
        yield ("condition", "what", "target", "measured", "reached")
        lines: dict[tuple[str, str], list[Row]] = {}
        for check in self.checks:
            what = check["what"]
            if what.endswith(TASKS):
                what = what.rpartition(", ")[0]
            condition = check["condition"]
            if condition.startswith("recorded:"):
                what = "not worse than TP" if "tp's" in check["what"] else "not worse than a vote"
                condition = "recorded VLMs, each on its own domain"
            elif condition.startswith("the embedded") and what.startswith("completion less"):
                what = "not worse than any of ten rivals"
            lines.setdefault((condition, what), []).append(check)
        last = ""
        for (condition, what), checks in lines.items():
            found = [each for each in checks if each["measured"] is not None]
            if not found:
                continue
            targets = [each["target"] for each in checks]
            if len(set(targets)) == 1:
                targets = targets[:1]
            if len(checks) > 3:
                least = min(found, key=lambda each: each["measured"])
                where = re.sub(r"completion less (\S+)'s", r"over \1", least["what"])
                named = re.sub(r":\d.*", "", least["condition"].removeprefix("recorded:"))
                if least["condition"].startswith("recorded:"):
                    where = f"{named}, {where}"
                told = f"least: {_signed(least)} ({where})"
            elif any(each["target"].startswith(("≥ +", "≥ -")) for each in checks):
                told = ", ".join(map(_signed, found))
            else:
                told = ", ".join(f"{each['measured']:.3g}" for each in found)
            notes = "; ".join(dict.fromkeys(each["note"] for each in found if each["note"]))
            reached = sum(bool(each["reached"]) for each in found)
            yes = "yes" if reached == len(found) else f"**{reached} of {len(found)}**"
            yield (
                condition if condition != last else "",
                what,
                ", ".join(targets),
                told + (f"; {notes}" if notes else ""),
                yes if len(found) == len(checks) else f"{yes}; {len(found)} measured",
            )
            last = condition

    def recorded(self) -> Iterator[Sequence[str]]:
        """Each recorded VLM and task: the belief, the best vote, TP."""
        tasks = ("build_tower", *TASKS)
        yield ("recorded VLM", *tasks)
        vlms = sorted({row["vlm"] for row in self.rows if row["vlm"].startswith("recorded:")})
        for vlm in vlms:
            told = []
            for task in tasks:
                own, tp = self.find(vlm, task, "belief"), self.find(vlm, task, "tp")
                votes = [found for each in VOTES if (found := self.find(vlm, task, each))]
                best = max((float(row["completion_rate"]) for row in votes), default=0.0)
                told.append(
                    f"**{_rate(own)}** ({float(own['questions']):.0f}q), {best:.3f}, {_rate(tp)}"
                    if own
                    else "–"
                )
            yield (vlm.split(":")[1], *told)

    def ablations(self) -> Iterator[Sequence[str]]:
        """What leaving a part out does, the mean over the three tasks."""
        yield ("answers", "belief", *(f"without {part}" for part in PARTS))
        for name, vlm in CONDITIONS[:4]:
            cells = []
            for monitor in ("belief", *(f"belief:without={part}" for part in PARTS)):
                rows = [found for task in TASKS if (found := self.find(vlm, task, monitor))]
                cells.append(_mean(rows) if len(rows) == len(TASKS) else "–")
            if any(cell != "–" for cell in cells[1:]):
                yield (name, *cells)

    def counts(self) -> str:
        """How many trials a cell has, and which parts have another number."""
        grid = [row for row in self.rows if row["vlm"].startswith("oracle")]
        plain = [row for row in grid if not row["condition"]]
        priced = [row for row in plain if "question=" in row["monitor"]]
        ablated = [row for row in plain if "without=" in row["monitor"]]
        rest = [
            row
            for row in self.rows
            if not row["condition"]
            and row["monitor"] in (*VOTES, "belief", "tp")
            and not row["vlm"].startswith("recorded:")
        ]
        recorded = [row for row in self.rows if row["vlm"].startswith("recorded:")]
        wrong = [row for row in self.rows if row["condition"] and "carried" not in row["condition"]]
        learning = [row for row in self.rows if "carried" in row["condition"]]
        each = (
            ("of the recorded VLMs", recorded),
            ("with a wrong action model", wrong),
            ("of learning", learning),
            ("of the ablations", ablated),
            ("at each further point of a curve", priced),
        )
        usual = self.episodes(rest)
        found = [(self.episodes(rows), what) for what, rows in each]
        others = ", ".join(f"{count} {what}" for count, what in found if count != usual)
        return f"**{usual} trials a cell**{'; ' if others else ''}{others}."


def _rate(row: Row | None) -> str:
    return "–" if row is None else f"{float(row['completion_rate']):.3f}"


def _full(row: Row | None) -> str:
    if row is None:
        return "–"
    return f"{_rate(row)} ({float(row['questions']):.0f}q {float(row['actions']):.1f}a)"


def _mean(rows: Sequence[Row]) -> str:
    rate, questions, actions = (
        sum(float(row[name]) for row in rows) / len(rows)
        for name in ("completion_rate", "questions", "actions")
    )
    return f"{rate:.3f} ({questions:.0f}q {actions:.1f}a)"


def _signed(check: Row) -> str:
    return f"{check['measured']:+.3f} ({check['low']:+.3f} to {check['high']:+.3f})"


def _table(lines: Iterable[Sequence[str]]) -> str:
    names, *rest = lines
    told = [names, ["---"] * len(names), *rest]
    return "".join(f"| {' | '.join(line)} |\n" for line in told)


def main() -> None:
    """Make the tables again and copy the rest."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    folder = parser.parse_args().folder
    measured, page = Measured(folder), DOCS / "belief-measured.md"
    text = page.read_text(encoding="utf-8")
    for name, made in (
        ("counts", measured.counts() + "\n"),
        ("answers", _table(measured.answers())),
        ("targets", _table(measured.targets())),
        ("recorded", _table(measured.recorded())),
        ("ablations", _table(measured.ablations())),
    ):
        between = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
        if not between.search(text):
            raise SystemExit(f"{page}: there is no <!-- {name} --> … <!-- end -->")
        text = between.sub(lambda match, made=made: f"{match[1]}\n{made}\n{match[2]}", text)
    page.write_text(text, encoding="utf-8")
    shutil.copy(folder / "belief.md", DOCS / "belief-results.md")
    for name, copy in FIGURES.items():
        if (folder / "figures" / name).exists():
            shutil.copy(folder / "figures" / name, DOCS / "images" / copy)


if __name__ == "__main__":
    main()
