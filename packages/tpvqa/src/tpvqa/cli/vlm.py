"""`tpvqa vlm compare`: VLMs side by side on one labelled set."""

import json
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tpvqa.cli.options import ANSWERING, trial_options
from tpvqa.cli.outputs import named_by, see_free, see_unread
from tpvqa.cli.saying import tell
from tpvqa.config.layers import Layer, combined, settings
from tpvqa.spelling import plain_row

if TYPE_CHECKING:
    from tpvqa.bench.vlms.asking import Row
    from tpvqa.bench.vlms.comparing import Comparison
    from tpvqa.bench.vlms.looks import LabelledLook
    from tpvqa.pddl import Task

_EXIT = "Exit codes: 0 compared, 2 bad input, 6 could not be written, 130 interrupted."
_OFFERED = (*ANSWERING, ("seed",))
OUT = Path("vlm-compare")
_WRITTEN = ("answers.csv", "figures.csv", "compare.png", "compare.svg")

vlm_app = typer.Typer(help="VLMs by themselves, without a trial.", no_args_is_help=True)


def register(app: typer.Typer) -> None:
    """Add the commands."""
    vlm_app.command(epilog=_EXIT)(compare)
    app.add_typer(vlm_app, name="vlm")


@vlm_app.callback()
def _vlm() -> None:
    """VLMs by themselves, without a trial."""


@trial_options(*(each.key for each in settings() if each.key not in _OFFERED), file=False)
def compare(
    vlms: Annotated[
        list[str],
        typer.Argument(
            help="VLMs, e.g. embedded openai:MODEL oracle:0.9; the first is compared "
            "with the others."
        ),
    ],
    *,
    layers: Sequence[Layer],
    pictures: Annotated[
        str | None,
        typer.Option(help="Ask about labelled pictures: 'shipped', or the folder of a set."),
    ] = None,
    episodes: Annotated[
        list[Path] | None,
        typer.Option(
            help="Ask again what was asked in a recorded episode, of a simulated world or labelled "
            "(`tpvqa label`); may be given several times."
        ),
    ] = None,
    domain: Annotated[
        Path | None, typer.Option(help="With --pictures: your own domain, or a logic program.")
    ] = None,
    problem: Annotated[Path | None, typer.Option(help="With --domain: your own problem.")] = None,
    questions: Annotated[
        list[Path] | None,
        typer.Option(
            help="A questions file. Given several times each is a wording of its own, and all are "
            "compared with the first."
        ),
    ] = None,
    hidden: Annotated[
        bool,
        typer.Option("--hidden", help="With --pictures: ask about what is hidden in them, too."),
    ] = False,
    repeats: Annotated[
        int, typer.Option(help="Ask everything so often: do errors repeat on one picture?", min=1)
    ] = 1,
    price: Annotated[
        list[str] | None,
        typer.Option(help="VLM=AMOUNT, the price of one question; may be given several times."),
    ] = None,
    out: Annotated[
        Path, typer.Option(help="Folder for answers.csv, figures.csv, compare.png and .svg.")
    ] = OUT,
    force: Annotated[
        bool, typer.Option("--force", help="Write over what was found before.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON.")] = False,
) -> None:
    """Ask several VLMs the same about one labelled set, and compare them.

    With --cache FILE nothing is asked twice: what was interrupted goes on where it was.
    """
    from tpvqa.bench.checking import need_extras
    from tpvqa.bench.vlms.asking import ask_all
    from tpvqa.bench.vlms.comparing import compare as compared
    from tpvqa.bench.vlms.looks import OF_PICTURES
    from tpvqa.bench.vlms.recorded_looks import OF_EPISODES
    from tpvqa.cli.progress import CountBar
    from tpvqa.cli.vlm_tables import print_comparison
    from tpvqa.errors import TpvqaError
    from tpvqa.tasks import domain_and_problem

    if (pictures is None) == (not episodes):
        raise TpvqaError("Give one labelled set: --pictures shipped (or a folder), or --episodes")
    config = combined(layers)
    prices = _prices(price or [], vlms)
    need_extras()
    own = (*domain_and_problem(domain, problem), questions or [])
    if pictures is not None:
        of, looks, task = _of_pictures(pictures, *own, hidden=hidden)
    else:
        of, looks, task = _of_episodes(episodes or [], *own, hidden=hidden)
    cluster = OF_EPISODES if pictures is None else OF_PICTURES
    _tell_doubled(vlms)
    read = (*(episodes or ()), *own[:2], *own[2], *map(named_by, vlms))
    for name in _WRITTEN:
        see_unread(out / name, "--out", read)
    made = _check_out(out, force=force)
    with CountBar("looks") as bar:
        try:
            rows = ask_all(vlms, looks, config=config, task=task, repeats=repeats, progress=bar)
        except (TpvqaError, KeyboardInterrupt) as end:
            if made:
                with suppress(OSError):  # what keeps the answers may lie in it
                    out.rmdir()
            if isinstance(end, TpvqaError):
                raise
            kept = config.vlm.cache is not None
            said = "the same command goes on" if kept else "with --cache FILE it could go on"
            print(f"interrupted; {said}", file=sys.stderr)
            raise typer.Exit(130) from None
    found = compared(rows, of, cluster=cluster, prices=prices, seed=config.seed)
    _write(out, rows, found)
    if as_json:
        print(json.dumps(found.plain(), indent=1))
    else:
        print_comparison(found)
        tell(f"wrote {out}/answers.csv, figures.csv, compare.png and compare.svg")


def _prices(texts: Sequence[str], vlms: Sequence[str]) -> dict[str, float]:
    """Prices of a question by the VLMs' specifications in full."""
    from math import isfinite

    from tpvqa.errors import TpvqaError
    from tpvqa.vlm.making import in_full

    known, found = {vlm: in_full(vlm) for vlm in vlms}, {}
    known |= {full: full for full in known.values()}
    for text in texts:
        vlm, equals, amount = text.rpartition("=")
        try:
            value = float(amount)
        except ValueError:
            value = -1.0
        if not equals or not vlm or value < 0 or not isfinite(value):
            raise TpvqaError(f"--price {text!r:.60}: write VLM=AMOUNT, e.g. openai:MODEL=0.0004")
        if vlm not in known:
            raise TpvqaError(f"--price {text!r:.60} is of none of these VLMs")
        found[known[vlm]] = value
    return found


Looks = tuple[str, "list[LabelledLook]", "Task | None"]


def _of_pictures(
    where: str,
    domain: Path | None,
    problem: Path | None,
    questions: Sequence[Path],
    *,
    hidden: bool,
) -> Looks:
    """The looks at the pictures of a set, and a task of its domain."""
    from tpvqa.bench.labelled_pictures import shipped_books
    from tpvqa.bench.vlms.looks import looks_at_pictures
    from tpvqa.cli.picture_sets import SHIPPED, opened_set
    from tpvqa.errors import TpvqaError
    from tpvqa.pddl import load_task
    from tpvqa.questions import QuestionBook
    from tpvqa.tasks import QUESTIONS, beside

    if (domain is None) != (problem is None):
        raise TpvqaError("Give --domain and --problem together.")
    named: dict[str, Path | None] = dict(_wordings(questions))
    books: dict[str, list[QuestionBook]] = {}
    if domain is not None and problem is not None:
        task = load_task(domain, problem)
        for name, file in (named or {"usual": beside(QUESTIONS, problem, domain)}).items():
            books[name] = [QuestionBook.load(file, task)]
        opened = opened_set(where, next(iter(books.values())))
    else:
        opened = opened_set(where, None)
        for name, file in (named or {"usual": None}).items():
            books[name] = shipped_books(opened.manifest.domain, file)
    looks = looks_at_pictures(opened, books, hidden=hidden)
    if not looks:
        raise TpvqaError(f"{where}: no picture of this set shows what there are questions about")
    first = next(iter(books.values()))
    of = "the shipped pictures" if where == SHIPPED else f"pictures of {where}"
    return of, looks, first[0].task if first else None


def _of_episodes(
    folders: Sequence[Path],
    domain: Path | None,
    problem: Path | None,
    questions: Sequence[Path],
    *,
    hidden: bool,
) -> Looks:
    """The looks of recorded episodes, and the task of the first."""
    from tpvqa.bench.vlms.recorded_looks import looks_of_episodes, task_of
    from tpvqa.errors import TpvqaError

    if domain is not None or problem is not None or hidden:
        raise TpvqaError("--domain, --problem and --hidden are for --pictures; leave them out")
    looks = looks_of_episodes(folders, _wordings(questions))
    count = "1 episode" if len(folders) == 1 else f"{len(folders)} episodes"
    return count, looks, task_of(folders[0])


def _wordings(files: Sequence[Path]) -> dict[str, Path]:
    """Questions files by the names of their wordings."""
    from tpvqa.errors import TpvqaError

    found = {file.stem: file for file in files}
    if len(found) < len(files):
        found = {str(file): file for file in files}
    if len(found) < len(files):
        raise TpvqaError("A questions file was given twice; each is a wording of its own.")
    return found


def _tell_doubled(vlms: Sequence[str]) -> None:
    from tpvqa.vlm.making import in_full

    specs = [in_full(vlm) for vlm in vlms]
    for spec in dict.fromkeys(spec for spec in specs if specs.count(spec) > 1):
        tell(f"note: {spec} is named {specs.count(spec)} times, and asked once", error=True)


def _check_out(out: Path, *, force: bool) -> bool:
    """What would end the work at its end is told before it; gives whether the folder is new."""
    from tpvqa.errors import TpvqaError, WriteError

    for name in _WRITTEN:
        path = out / name
        if path.is_symlink() or (path.exists() and not path.is_file()):
            what = "a link, and would be lost" if path.is_symlink() else "no file"
            raise TpvqaError(f"{path} is {what}; name another folder with --out")
        see_free(path, "--out", force=force)
    there = out.exists()
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise WriteError.of(out, error, "Name another folder with --out") from error
    return not there


def _write(out: Path, rows: "Sequence[Row]", found: "Comparison") -> None:
    from tpvqa.bench.figures import close, saved
    from tpvqa.bench.vlms.drawing import comparison_figure
    from tpvqa.cli.vlm_tables import figure_rows
    from tpvqa.files import write_whole

    remedy = "Name another folder with --out"
    answers = [row.plain() for row in rows]
    write_whole(out / "answers.csv", _csv(answers), remedy=remedy)
    write_whole(out / "figures.csv", _csv(figure_rows(found)), remedy=remedy)
    figure = comparison_figure(found)
    try:
        for kind in ("png", "svg"):
            write_whole(out / f"compare.{kind}", saved(figure, kind), remedy=remedy)
    finally:
        close(figure)


def _csv(rows: "Sequence[dict[str, Any]]") -> bytes:
    import csv
    from io import StringIO

    text = StringIO(newline="")
    writer = csv.DictWriter(text, list(rows[0]))
    writer.writeheader()
    writer.writerows(map(plain_row, rows))
    return text.getvalue().encode()
