"""`tpvqa train`: teach a VLM with labelled pictures."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tpvqa.cli.saying import tell

if TYPE_CHECKING:
    from tpvqa.cli.progress import CountBar
    from tpvqa.training.example import Example
    from tpvqa.training.running import Report
    from tpvqa.training.scoring import Figure

_EXIT = "Exit codes: 0 written, 2 bad input, 6 could not be written, 130 interrupted."
_NAMED = (
    ("accuracy", "accuracy"),
    ("balanced_accuracy", "balanced accuracy"),
    ("auroc", "AUROC"),
    ("log_loss", "log loss"),
    ("abstained", "abstained"),
)


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command(epilog=_EXIT)(train)


def train(
    vlm: Annotated[
        str, typer.Argument(help="What to train: embedded, or hf:MODEL, a folder or a hub's name.")
    ],
    episodes: Annotated[
        list[Path] | None,
        typer.Argument(
            help="Folders of recorded episodes: labelled ones (`tpvqa label`), or in a simulated "
            "world."
        ),
    ] = None,
    *,
    out: Annotated[
        Path,
        typer.Option(
            help="The folder to write. What is under way lies in a folder beside it; where it was "
            "stopped, the same command goes on."
        ),
    ],
    pictures: Annotated[
        str | None,
        typer.Option(help="Learn from labelled pictures: 'shipped', or the folder of a set."),
    ] = None,
    domain: Annotated[
        Path | None, typer.Option(help="With --pictures: your own domain, or a logic program.")
    ] = None,
    problem: Annotated[Path | None, typer.Option(help="With --domain: your own problem.")] = None,
    questions: Annotated[
        Path | None,
        typer.Option(help="With --domain: your questions. Default: the questions.yaml beside it."),
    ] = None,
    held_back: Annotated[
        float,
        typer.Option(
            help="Share of the pictures that is not learnt from, to see what was learnt.",
            min=0.01,
            max=0.9,
        ),
    ] = 0.25,
    epochs: Annotated[
        int,
        typer.Option(
            help="How often each question is seen; embedded: each picture, at most.", min=1
        ),
    ] = 3,
    rate: Annotated[
        float | None, typer.Option(help="hf: learning rate. Default: 0.0002.", min=1e-9, max=1)
    ] = None,
    rank: Annotated[int, typer.Option(help="hf: rank of the adapter.", min=1, max=1024)] = 8,
    batch: Annotated[int, typer.Option(help="hf: questions a step.", min=1)] = 8,
    seed: Annotated[
        int, typer.Option(help="Decides what is held back, the order, and the first weights.")
    ] = 0,
    device: Annotated[
        str | None, typer.Option(help="hf: auto (the default), cpu, cuda, cuda:N or mps.")
    ] = None,
    dtype: Annotated[
        str | None, typer.Option(help="hf: auto (the default), float32, bfloat16 or float16.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON.")] = False,
) -> None:
    """Teach a VLM with labelled pictures or episodes, and show what it learnt.

    Part of the pictures is held back; the figures before and after are on those alone. The small
    network, embedded, learns the questions of any domain in a minute or so, to be taken as --vlm
    embedded:FOLDER. For hf:MODEL an adapter is written (LoRA), to be taken as --vlm hf:FOLDER.
    """
    from tpvqa.cli.progress import CountBar
    from tpvqa.config.layers import Key, Layer, combined
    from tpvqa.errors import TrainingError
    from tpvqa.tasks import domain_and_problem
    from tpvqa.training.making import make_trainer
    from tpvqa.training.protocol import TrainingSettings
    from tpvqa.training.running import see_free
    from tpvqa.training.running import train as trained

    if bool(episodes) == (pictures is not None):
        raise TrainingError(
            "Give one source of labelled pictures: folders of recorded episodes, or --pictures "
            "shipped (or a folder of such a set)."
        )
    domain, problem = domain_and_problem(domain, problem)
    own = (domain, problem, questions)
    if any(own) and (pictures is None or domain is None or problem is None):
        raise TrainingError("Give --domain and --problem (and --questions) beside --pictures.")
    out = Path(out)
    see_free(out)
    named = {"device": device, "dtype": dtype}
    values: dict[Key, str] = {
        ("vlm", name): value for name, value in named.items() if value is not None
    }
    options = combined([Layer(values, {key: f"--{key[1]}" for key in values})]).plugin_options()
    trainer = make_trainer(vlm, options)
    with CountBar("episodes") as bar:
        if pictures is not None:
            examples = _from_pictures(pictures, own)
        else:
            examples = _from_episodes(episodes or [], bar)
        report = trained(
            vlm,
            trainer,
            examples,
            out,
            settings=TrainingSettings(epochs, rate, batch, rank, seed),
            held_back=held_back,
            context=options,
            progress=bar,
            going_on=lambda part: tell(f"note: going on with {part}", error=True),
        )
    if as_json:
        typer.echo(json.dumps(report.plain(), indent=1))
    else:
        _print(report)


def _from_pictures(
    where: str, own: tuple[Path | None, Path | None, Path | None]
) -> "list[Example]":
    from tpvqa.cli.calibrate import own_book
    from tpvqa.cli.picture_sets import opened_set
    from tpvqa.training.from_pictures import examples_of

    books = own_book(*own)
    return list(examples_of(opened_set(where, books), books))


def _from_episodes(folders: list[Path], bar: "CountBar") -> "list[Example]":
    from tpvqa.training.from_episodes import examples_from

    done = 0

    def one() -> None:
        nonlocal done
        done += 1
        bar(done, len(folders))

    bar(0, len(folders))
    found = examples_from(folders, done=one)
    if found.untold:
        tell(
            f"note: {found.untold} of the episodes have neither labels nor the truth, and teach "
            "nothing; see `tpvqa label`",
            error=True,
        )
    if found.of_several:
        tell(
            f"note: {found.of_several} answers are about several pictures at once, and teach "
            "nothing",
            error=True,
        )
    return found.examples


def _print(report: "Report") -> None:
    learnt, held = report.learnt_from, report.held_back
    tell(f"learnt from {learnt[0]:,} questions about {learnt[1]:,} pictures")
    tell(f"held back    {held[0]:,} questions about {held[1]:,} pictures: figures are on these,")
    tell("             with intervals of 95% (pictures drawn anew)")
    tell(f"{'':20}{'before':>24}{'after':>24}")
    for name, said in _NAMED:
        before, after = getattr(report.before, name), getattr(report.after, name)
        tell(f"{said:20}{_said(before):>24}{_said(after):>24}")
    if len(report.balanced) > 1:
        tell("balanced accuracy after, by predicate:")
        for predicate, value in report.balanced.items():
            tell(f"  {predicate:18}{'–' if value is None else f'{value:.3f}':>24}")
    for notice in report.notices:
        tell(f"note: {notice}", error=True)
    tell(f"wrote {report.out}: take it as --vlm {report.taken_as}")


def _said(figure: "Figure") -> str:
    if figure.value is None:
        return "–"
    if figure.low is None or figure.high is None:
        return f"{figure.value:.3f}"
    return f"{figure.value:.3f} ({figure.low:.3f}–{figure.high:.3f})"
