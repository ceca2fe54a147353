"""An episode in the terminal: while it runs, and printed again."""

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from tpvqa.cli.belief_bars import BeliefBars
from tpvqa.episodes.events import (
    Acted,
    Acting,
    Answered,
    AnswerRecord,
    Asked,
    Believed,
    Decided,
    Ended,
    Event,
    Observed,
    PlanMade,
    QuestionRecord,
    Resumed,
    Started,
)
from tpvqa.episodes.fact_words import words_of
from tpvqa.monitors import Decision
from tpvqa.questions import FactWords, QuestionBook, Way
from tpvqa.vlm import Reply

_REPLY_STYLE = {
    Reply.YES: "green",
    Reply.NO: "red",
    Reply.UNKNOWN: "dim",
    Reply.CANNOT_SEE: "dim",
}
_COURSE_STYLE = {
    Decision.GO_ON: "green",
    "skip ahead": "cyan",
    "go back": "dark_orange",
    Decision.REPEAT: "yellow",
    Decision.REPLAN: "magenta",
    Decision.DONE: "green",
    Decision.GIVE_UP: "red",
}
_BAR = 10
_MARKS = 40
_MARK = {Reply.YES: "y", Reply.NO: "n"}


class EpisodeView:
    """Prints events as lines; in a terminal also keeps the plan in view below them.

    Args:
        console: Where to print.
        truth: Whether to print what a simulated world knows about an action's outcome.
        live: Whether to keep the plan in view; by default in a terminal only.
        book: The questions in whose words facts are said; by default those that the log keeps.
    """

    def __init__(
        self,
        console: Console,
        *,
        truth: bool = True,
        live: bool | None = None,
        book: QuestionBook | None = None,
    ):
        self._console, self._truth = console, truth
        self._words = None if book is None else FactWords(book)
        self._started: Started | None = None
        self._bars = BeliefBars(bars=console.is_terminal)
        self._plan: PlanMade | None = None
        self._step, self._attempt, self._done = 0, 0, False
        self._headed, self._told = False, False
        self._asked: tuple[QuestionRecord, ...] = ()
        self._pictures = False
        self._gathered: dict[str, list[tuple[QuestionRecord, AnswerRecord]]] = {}
        wanted = console.is_terminal if live is None else live
        self._live = Live(console=console, auto_refresh=False, transient=True) if wanted else None

    def __enter__(self) -> "EpisodeView":
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Take the plan out of view, so that something can be typed."""
        if self._live is not None:
            self._live.stop()
        try:
            yield
        finally:
            if self._live is not None:  # a new one: the old one would clear what was typed
                self._live = Live(console=self._console, auto_refresh=False, transient=True)
                self._live.start()

    def __call__(self, event: Event) -> None:
        """Show an event."""
        thinking = isinstance(event, PlanMade) and event.considered
        if not (thinking or isinstance(event, Observed | Asked | Answered)):
            self._show_gathered()
        match event:
            case Started():
                self._started = event
                noise = " (a noise model, not a VLM)" if event.noise_model else ""
                self._line(
                    f"[bold]{escape(event.task)}[/]  [dim]world[/] {escape(event.world)}  "
                    f"[dim]monitor[/] {escape(event.monitor)}  "
                    f"[dim]VLM[/] {escape(event.vlm)}{noise}  [dim]seed[/] {event.seed}"
                )
            case PlanMade():
                if not event.considered:
                    self._show_plan(event)
            case Observed():
                self._head()
                names = ", ".join(frame.file for frame in event.frames)
                self._pictures = bool(names)
                if names:
                    self._line(f"  [dim]look {event.look}: {escape(names)}[/]")
            case Asked():
                self._head()
                self._asked, self._told = event.questions, True
            case Answered():
                for question, answer in zip(self._asked, event.answers, strict=True):
                    if self._pictures:
                        self._line(_answer_line(question, answer))
                    else:
                        self._gathered.setdefault(question.text, []).append((question, answer))
            case Believed():
                gone = ", ".join(map(self._say, event.removed)) or "nothing"
                new = ", ".join(map(self._say, event.added)) or "nothing"
                self._line(f"  [dim]now believed: {escape(new)}; no longer: {escape(gone)}[/]")
            case Decided():
                self._go_to(event.step)
                self._head()
                self._show_decision(event)
                self._show_belief(event)
            case Acting():
                self._go_to(event.step)
                self._head()
                self._line(f"  [blue]▶ {escape(event.action.said)}[/]")
            case Acted():
                self._show_outcome(event)
            case Resumed():
                self._line("  [yellow]gone on after an interruption: looking anew[/]")
            case Ended():
                self._done = event.believed_goal
                self._show_end(event)
        if self._live is not None:
            self._live.update(self._plan_panel(), refresh=True)

    def _show_gathered(self) -> None:
        """Of looks without pictures, one line for all answers to a question."""
        for told in self._gathered.values():
            if len(told) == 1:
                self._line(_answer_line(*told[0]))
            else:
                self._line(_answers_line(told[0][0], [answer for _, answer in told]))
        self._gathered.clear()

    def _line(self, text: str) -> None:
        self._console.print(text, highlight=False, soft_wrap=True)

    def _go_to(self, step: int) -> None:
        """Follow a monitor that goes on at another step than the next one."""
        if step != self._step:
            self._step, self._attempt, self._headed = step, 0, False

    def _head(self) -> None:
        """Name the step, once, before the first that happens in it."""
        if self._headed or self._plan is None or self._step >= len(self._plan.plan):
            return
        self._headed = True
        again = f" [yellow](attempt {self._attempt + 1})[/]" if self._attempt else ""
        self._line(f"[bold]{self._step + 1}. {escape(self._plan.plan[self._step].said)}[/]{again}")

    def _show_decision(self, event: Decided) -> None:
        explained = bool(event.belief) and event.when == "after"
        if self._told or explained or event.decision is not Decision.GO_ON:
            style = _COURSE_STYLE[event.course]
            self._line(f"  [{style}]→ {event.course}:[/] {escape(event.reason)}")
        self._told = False
        if event.decision is Decision.REPEAT:
            self._attempt, self._headed = self._attempt + 1, False
        elif event.when == "after" and event.decision is Decision.GO_ON:
            self._step, self._attempt, self._headed = event.onward, 0, False

    def _show_belief(self, event: Decided) -> None:
        if not event.belief:
            return
        for line in self._bars.lines(event.belief, self._say):
            self._line(line)

    def _say(self, fact: str) -> str:
        if self._words is None:
            self._words = FactWords() if self._started is None else words_of(self._started)
        return self._words.say(fact)

    def _show_plan(self, event: PlanMade) -> None:
        replanned = self._plan is not None
        if event.result != "plan":
            self._line(f"[red]no plan: {event.result}[/] {escape(event.reason)}")
            return
        self._plan, self._step, self._attempt, self._headed = event, 0, 0, False
        steps = " · ".join(action.said for action in event.plan) or "nothing left to do"
        word = "new plan" if replanned else "plan"
        self._line(
            f"[cyan]{word}[/] {escape(steps)} "
            f"[dim]({event.planner}, {event.seconds * 1e3:.0f} ms)[/]"
        )

    def _show_outcome(self, event: Acted) -> None:
        if event.message:
            self._line(f"  [dim]the robot reports {event.report}: {escape(event.message)}[/]")
        if not self._truth or event.truth is None:
            return
        parts = [] if event.truth["succeeded"] else [f"in truth {event.truth['reason']}"]
        if event.truth["undone"]:
            parts.append(f"{self._say(event.truth['undone'])} ended: {event.truth['undoing']}")
        if parts:
            self._line(f"  [dim italic]{escape('; '.join(parts))}[/]")

    def _show_end(self, event: Ended) -> None:
        counts = (
            f"{event.actions} actions, {event.questions} questions, {event.repeats} repeats, "
            f"{event.replans} replans"
        )
        if event.completed:
            headline = "[bold green]goal reached[/]"
        elif event.completed is None:
            style = "green" if event.believed_goal else "red"
            headline = f"[bold {style}]ended: {event.because}[/]"
        else:
            headline = f"[bold red]goal not reached[/] ({escape(event.ending)})"
        message = f" [dim]{escape(event.message)}[/]" if event.message else ""
        self._line(f"{headline}: {counts}{message}")

    def _plan_panel(self) -> RenderableType:
        if self._plan is None or self._plan.result != "plan":
            return Text("")
        table = Table.grid(padding=(0, 1))
        for number, action in enumerate(self._plan.plan):
            if self._done or number < self._step:
                mark, style = "✓", "green"
            elif number == self._step:
                mark, style = "▶", "bold"
            else:
                mark, style = " ", "dim"
            table.add_row(Text(mark, style), Text(f"{number + 1}. {action.said}", style))
        return Group(Text("─" * min(40, self._console.width), "dim"), table)


def _answers_line(question: QuestionRecord, answers: list[AnswerRecord]) -> str:
    """Many answers to one question, counted, in the order in which they came."""
    replies = [answer.reply for answer in answers]
    counts = ", ".join(
        f"[{_REPLY_STYLE[reply]}]{count} {reply}[/]"
        for reply in Reply
        if (count := replies.count(reply))
    )
    marks = "".join(_MARK.get(reply, "·") for reply in replies[:_MARKS])
    more = "…" if len(replies) > _MARKS else ""
    return f"  · {escape(question.text)} {counts}  [dim]{marks}{more}[/]"


def _answer_line(question: QuestionRecord, answer: AnswerRecord) -> str:
    style = _REPLY_STYLE[answer.reply]
    agrees = {Reply.YES: question.expected, Reply.NO: not question.expected}.get(answer.reply)
    if question.way is Way.ALTERNATIVE:
        agrees = None
    mark = {True: "[green]✓[/]", False: "[red]✗[/]", None: "[dim]·[/]"}[agrees]
    if answer.p_yes is None:
        chance = ""
    else:
        filled = round(answer.p_yes * _BAR)
        chance = f" [{style}]{'▰' * filled}[/][dim]{'▱' * (_BAR - filled)}[/] {answer.p_yes:.2f}"
    why = f" [dim]{escape(answer.text)}[/]" if answer.reply is Reply.UNKNOWN else ""
    if answer.source == "person":
        why = f"{why} [dim](you)[/]"
    return f"  {mark} {escape(question.text)} [{style}]{answer.reply}[/]{chance}{why}"
