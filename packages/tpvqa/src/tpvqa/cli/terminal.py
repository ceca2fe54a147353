"""An episode in the terminal: while it runs, and printed again."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from tpvqa.cli.belief_bars import BeliefBars
from tpvqa.episodes.fact_words import words_of
from tpvqa.events import Decision, Ended, Event, Exchange, TrialState
from tpvqa.events.events import (
    Acted,
    Acting,
    Answered,
    Asked,
    Believed,
    Decided,
    ListenerDropped,
    Observed,
    PlanMade,
    Resumed,
    Started,
)
from tpvqa.questions import FactWords, QuestionBook
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
        self._bars = BeliefBars(bars=console.is_terminal)
        self._state = TrialState()
        self._headed: tuple[PlanMade | None, int, int] | None = None
        self._told = False
        self._gathered: dict[str, list[Exchange]] = {}
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
        before, self._state = self._state, self._state.after(event)
        thinking = isinstance(event, PlanMade) and event.considered
        if not (thinking or isinstance(event, Observed | Asked | Answered)):
            self._show_gathered()
        match event:
            case Started():
                noise = " (a noise model, not a VLM)" if event.noise_model else ""
                self._line(
                    f"[bold]{escape(event.task)}[/]  [dim]world[/] {escape(event.world)}  "
                    f"[dim]monitor[/] {escape(event.monitor)}  "
                    f"[dim]VLM[/] {escape(event.vlm)}{noise}  [dim]seed[/] {event.config.seed}"
                )
            case PlanMade():
                if not event.considered:
                    self._show_plan(event, again=before.plan is not None)
            case Observed():
                self._head(before)
                names = ", ".join(frame.file for frame in event.frames)
                if names:
                    self._line(f"  [dim]look {event.look}: {escape(names)}[/]")
            case Asked():
                self._head(before)
                self._told = True
            case Answered():
                self._show_answers()
            case Believed():
                gone = ", ".join(map(self._say, event.removed)) or "nothing"
                new = ", ".join(map(self._say, event.added)) or "nothing"
                self._line(f"  [dim]now believed: {escape(new)}; no longer: {escape(gone)}[/]")
            case Decided():
                self._head(before, event.step)
                self._show_decision(event)
                self._show_belief(event)
            case Acting():
                self._head(before, event.step)
                self._line(f"  [blue]▶ {escape(event.action.said)}[/]")
            case Acted():
                self._show_outcome(event)
            case Resumed():
                self._line("  [yellow]gone on after an interruption: looking anew[/]")
            case ListenerDropped():
                self._line(f"  [yellow]{escape(event.listener)} broke: {escape(event.error)}[/]")
            case Ended():
                self._show_end(event)
        if self._live is not None:
            self._live.update(self._plan_panel(), refresh=True)

    def _show_answers(self) -> None:
        observed = self._state.observed
        for each in self._state.latest:
            if observed is not None and observed.frames:
                self._line(_answer_line(each))
            else:
                self._gathered.setdefault(each.question.text, []).append(each)

    def _show_gathered(self) -> None:
        """Of looks without pictures, one line for all answers to a question."""
        for told in self._gathered.values():
            self._line(_answer_line(told[0]) if len(told) == 1 else _answers_line(told))
        self._gathered.clear()

    def _line(self, text: str) -> None:
        self._console.print(text, highlight=False, soft_wrap=True)

    def _head(self, state: TrialState, step: int | None = None) -> None:
        """Name the step, once, before the first that happens in it."""
        step = state.index if step is None else step
        attempt = state.attempt if step == state.index else 0
        here = (state.plan, step, attempt)
        if state.plan is None or step >= len(state.plan.plan) or self._headed == here:
            return
        self._headed = here
        again = f" [yellow](attempt {attempt + 1})[/]" if attempt else ""
        self._line(f"[bold]{step + 1}. {escape(state.plan.plan[step].said)}[/]{again}")

    def _show_decision(self, event: Decided) -> None:
        explained = bool(event.belief) and event.when == "after"
        if self._told or explained or event.decision is not Decision.GO_ON:
            style = _COURSE_STYLE[event.course]
            self._line(f"  [{style}]→ {event.course}:[/] {escape(event.reason)}")
        self._told = False

    def _show_belief(self, event: Decided) -> None:
        if not event.belief:
            return
        for line in self._bars.lines(event.belief, self._say):
            self._line(line)

    def _say(self, fact: str) -> str:
        if self._words is None:
            started = self._state.started
            self._words = FactWords() if started is None else words_of(started)
        return self._words.say(fact)

    def _show_plan(self, event: PlanMade, *, again: bool) -> None:
        if event.result != "plan":
            self._line(f"[red]no plan: {event.result}[/] {escape(event.reason)}")
            return
        self._headed = None
        steps = " · ".join(action.said for action in event.plan) or "nothing left to do"
        word = "new plan" if again else "plan"
        self._line(
            f"[cyan]{word}[/] {escape(steps)} "
            f"[dim]({event.planner}, {event.seconds * 1e3:.0f} ms)[/]"
        )

    def _show_outcome(self, event: Acted) -> None:
        if event.message:
            self._line(f"  [dim]the robot reports {event.report}: {escape(event.message)}[/]")
        if not self._truth or event.truth is None:
            return
        failure, undone = event.truth.failure, event.truth.undone
        parts = [] if failure is None else [f"in truth {failure.said}"]
        if undone is not None:
            parts.append(f"{self._say(undone)} ended: {event.truth.undoing}")
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
        message = f"; [dim]{escape(event.message)}[/]" if event.message else ""
        self._line(f"{headline}: {counts}{message}")

    def _plan_panel(self) -> RenderableType:
        state = self._state
        if state.plan is None:
            return Text("")
        done = state.ended is not None and state.ended.believed_goal
        table = Table.grid(padding=(0, 1))
        for number, action in enumerate(state.plan.plan):
            if done or number < state.index:
                mark, style = "✓", "green"
            elif number == state.index:
                mark, style = "▶", "bold"
            else:
                mark, style = " ", "dim"
            table.add_row(Text(mark, style), Text(f"{number + 1}. {action.said}", style))
        return Group(Text("─" * min(40, self._console.width), "dim"), table)


def _answers_line(told: Sequence[Exchange]) -> str:
    """Many answers to one question, counted, in the order in which they came."""
    question, replies = told[0].question, [each.answer.reply for each in told]
    counts = ", ".join(
        f"[{_REPLY_STYLE[reply]}]{count} {reply}[/]"
        for reply in Reply
        if (count := replies.count(reply))
    )
    marks = "".join(_MARK.get(reply, "·") for reply in replies[:_MARKS])
    more = "…" if len(replies) > _MARKS else ""
    return f"  · {escape(question.text)} {counts}  [dim]{marks}{more}[/]"


def _answer_line(told: Exchange) -> str:
    question, answer = told.question, told.answer
    style = _REPLY_STYLE[answer.reply]
    mark = {True: "[green]✓[/]", False: "[red]✗[/]", None: "[dim]·[/]"}[told.agrees]
    if answer.p_yes is None:
        chance = ""
    else:
        filled = round(answer.p_yes * _BAR)
        chance = f" [{style}]{'▰' * filled}[/][dim]{'▱' * (_BAR - filled)}[/] {answer.p_yes:.2f}"
    why = f" [dim]{escape(answer.text)}[/]" if answer.reply is Reply.UNKNOWN else ""
    if answer.source == "person":
        why = f"{why} [dim](you)[/]"
    return f"  {mark} {escape(question.text)} [{style}]{answer.reply}[/]{chance}{why}"
