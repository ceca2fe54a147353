"""An episode in the terminal: while it runs, and printed again."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import NamedTuple

from rich.console import Console, Group, RenderableType
from rich.live import Live
from rich.table import Table
from rich.text import Text

from tpvqa.cli.belief_bars import BeliefBars
from tpvqa.cli.brief import brief
from tpvqa.cli.saying import marked, rendered
from tpvqa.episodes.agreement import Agreement
from tpvqa.episodes.answers_worth import AnswersWorth, calibration_used
from tpvqa.episodes.fact_words import words_of
from tpvqa.episodes.sensed_news import SensedNews
from tpvqa.episodes.true_start import true_start_said
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
    OutcomeRecord,
    PlanMade,
    Resumed,
    Started,
    Waited,
)
from tpvqa.questions import FactWords, QuestionBook
from tpvqa.spelling import plain
from tpvqa.vlm import Reply
from tpvqa.vlm.answer import CAMERA
from tpvqa.worlds import Report

_AGREEMENT_STYLE = {True: "green", False: "red", None: "dim"}
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
_HANGING = 4
_MARKS = 40
_ROOM = 100
"""Columns of a decision's line, at most."""
_MARK = {Reply.YES: "y", Reply.NO: "n"}


class EpisodeView:
    """Prints events as lines; in a terminal also keeps the plan in view below them.

    Args:
        console: Where to print.
        truth: Whether to print what a simulated world knows: how it began, and about an action's
            outcome.
        live: Whether to keep the plan in view; by default in a terminal only.
        verbose: Whether to give the reasons of decisions in full.
        book: The questions in whose words facts are said; by default those that the log keeps.
    """

    def __init__(
        self,
        console: Console,
        *,
        truth: bool = True,
        live: bool | None = None,
        verbose: bool = False,
        book: QuestionBook | None = None,
    ):
        self._console, self._truth, self._verbose = console, truth, verbose
        self._words = None if book is None else FactWords(book)
        self._agreement: Agreement | None = None
        self._sensed = SensedNews(self._say)
        self._bars = BeliefBars(bars=console.is_terminal)
        self._state, self._worth = TrialState(), AnswersWorth()
        self._headed: tuple[PlanMade | None, int, int] | None = None
        self._told = False
        self._gathered: dict[str, list[_Told]] = {}
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
        self._worth.take(event)
        thinking = isinstance(event, PlanMade) and event.considered
        if not (thinking or isinstance(event, Observed | Asked | Answered)):
            self._show_gathered()
        match event:
            case Started():
                noise = " (a noise model, not a VLM)" if event.noise_model else ""
                self._line(
                    f"[bold]{marked(event.task)}[/]  [dim]world[/] {marked(event.world)}  "
                    f"[dim]monitor[/] {marked(event.monitor)}  "
                    f"[dim]VLM[/] {marked(event.vlm)}{noise}  [dim]seed[/] {event.config.seed}"
                )
                if used := calibration_used(event):
                    self._line(f"[dim]calibration[/] {marked(used)}")
                if self._truth and (differs := true_start_said(event, self._say)):
                    self._line(f"[dim italic]in truth: {marked(differs)}[/]")
            case PlanMade():
                if not event.considered:
                    self._show_plan(event, again=before.plan is not None)
            case Observed():
                self._head(before)
                names = ", ".join(frame.file for frame in event.frames)
                if names:
                    self._line(f"  [dim]look {event.look}: {marked(names)}[/]")
                self._show_sensed(event)
            case Asked():
                self._head(before)
                self._told = True
            case Answered():
                self._show_answers()
            case Believed():
                self._show_believed(event)
            case Decided():
                self._head(before, event.step)
                self._show_decision(event)
                self._show_belief(event)
            case Acting():
                self._head(before, event.step)
                self._line(f"  [blue]▶ {marked(event.action.said)}[/]")
            case Acted():
                self._show_outcome(event)
            case Waited():
                self._show_waited(event)
            case Resumed():
                self._line("  [yellow]gone on after an interruption: looking anew[/]")
            case ListenerDropped():
                self._line(f"  [yellow]{marked(event.listener)} broke: {marked(event.error)}[/]")
            case Ended():
                self._show_end(event)
        if self._live is not None:
            self._live.update(self._plan_panel(), refresh=True)

    def _show_believed(self, event: Believed) -> None:
        """The state that is gone by: what is believed, and what is only the likeliest way on."""
        decided = self._state.decided
        likely = {} if decided is None else decided.belief
        new = [each for each in event.added if likely.get(each, 1.0) >= 0.5]
        gone = [each for each in event.removed if likely.get(each, 0.0) < 0.5]
        supposed = [self._say(each) for each in event.added if each not in new]
        supposed += [f"not {self._say(each)}" for each in event.removed if each not in gone]
        said = [
            f"{name}: {', '.join(map(self._say, facts)) or 'nothing'}"
            for name, facts in (("now believed", new), ("no longer", gone))
            if facts or not supposed
        ]
        said += [f"acts as if: {', '.join(supposed)}"] if supposed else []
        self._line(f"  [dim]{marked('; '.join(said))}[/]")

    def _show_answers(self) -> None:
        if self._agreement is None:
            self._agreement = Agreement(self._fact_words())
        observed = self._state.observed
        for each in self._state.latest:
            told = _Told(each, self._agreement.of(each, self._state))
            if observed is not None and observed.frames:
                self._line(_answer_line(told))
            else:
                self._gathered.setdefault(each.question.text, []).append(told)

    def _show_gathered(self) -> None:
        """Of looks without pictures, one line for all answers to a question."""
        for told in self._gathered.values():
            self._line(_answer_line(told[0]) if len(told) == 1 else _answers_line(told))
        self._gathered.clear()

    def _line(self, text: str) -> None:
        if not self._console.is_terminal:
            self._console.print(rendered(text), highlight=False, soft_wrap=True)
            return
        lines = rendered(text).wrap(self._console, self._console.width - _HANGING)
        for line in lines:
            line.rstrip()
        self._console.print(Text("\n" + " " * _HANGING).join(lines), highlight=False)

    def _head(self, state: TrialState, step: int | None = None) -> None:
        """Name the step, once, before the first that happens in it."""
        step = state.index if step is None else step
        attempt = state.attempt if step == state.index else 0
        here = (state.plan, step, attempt)
        if state.plan is None or step >= len(state.plan.plan) or self._headed == here:
            return
        self._headed = here
        again = f" [yellow](attempt {attempt + 1})[/]" if attempt else ""
        self._line(f"[bold]{step + 1}. {marked(state.plan.plan[step].said)}[/]{again}")

    def _show_decision(self, event: Decided) -> None:
        explained = bool(event.belief) and (event.when == "after" or not event.action)
        if self._told or explained or event.decision is not Decision.GO_ON:
            style, reason = _COURSE_STYLE[event.course], event.reason
            if not self._verbose:
                reason = brief(reason, _ROOM - len(f"  → {event.course}: "))
            self._line(f"  [{style}]→ {event.course}:[/] {marked(reason)}")
        self._told = False

    def _show_belief(self, event: Decided) -> None:
        if not event.belief:
            return
        for line in self._bars.lines(event.belief, self._say):
            self._line(line)

    def _say(self, fact: str) -> str:
        return self._fact_words().say(fact)

    def _fact_words(self) -> FactWords:
        if self._words is None:
            started = self._state.started
            self._words = FactWords() if started is None else words_of(started)
        return self._words

    def _show_plan(self, event: PlanMade, *, again: bool) -> None:
        if event.result != "plan":
            return  # the trial ends by it, and its last line says why
        self._headed = None
        steps = " · ".join(action.said for action in event.plan) or "nothing left to do"
        word = "new plan" if again else "plan"
        self._line(
            f"[cyan]{word}[/] {marked(steps)} "
            f"[dim]({marked(event.planner)}, {event.seconds * 1e3:.0f} ms)[/]"
        )

    def _show_outcome(self, event: Acted) -> None:
        if event.message or event.report is not Report.DONE:
            why = f": {marked(event.message)}" if event.message else ""
            self._line(f"  [dim]the robot reports {event.report}{why}[/]")
        self._show_sensed(event)
        self._show_truth(event.truth)

    def _show_waited(self, event: Waited) -> None:
        self._line(f"[dim]at {event.clock:g}[/]")
        self._show_truth(event.truth)

    def _show_truth(self, truth: OutcomeRecord | None) -> None:
        if not self._truth or truth is None:
            return
        parts = [] if truth.failure is None else [truth.failure.said]
        if truth.undone is not None:
            parts.append(f"{self._say(truth.undone)} ended: {truth.undoing}")
        if parts:
            self._line(f"  [dim italic]in truth: {marked('; '.join(parts))}[/]")

    def _show_sensed(self, event: Observed | Acted) -> None:
        told = self._sensed.of(event.facts, acted=isinstance(event, Acted))
        if told:
            self._line(f"  [dim]the robot senses: {marked(told)}[/]")

    def _show_end(self, event: Ended) -> None:
        if event.completed:
            headline = "[bold green]goal reached[/]"
        elif event.completed is None and event.believed_goal:
            headline = "[bold green]goal reached[/], as is believed"
        elif event.because == "goal":
            headline = "[bold red]goal not reached[/], though it was believed to be"
            if event.unmet:
                headline += f". Not so: {marked('; '.join(map(self._say, event.unmet)))}"
        elif event.goal_holds:
            why = marked(self._why(event))
            headline = f"[bold yellow]goal reached[/], though it was not believed to be: {why}"
        else:
            headline = f"[bold red]goal not reached[/]: {marked(self._why(event))}"
        counts = ", ".join(
            f"{count} {what}" + "s" * (count != 1)
            for count, what in (
                (event.actions, "action"),
                (event.questions, "question"),
                (event.repeats, "repeat"),
                (event.replans, "replan"),
            )
        )
        self._line(f"{headline} [dim]({counts})[/]")
        if event.usage is not None:
            cost = "" if event.cost is None else f", costs {event.cost:.4g}"
            self._line(f"[dim]the trial's questions took {marked(event.usage.said)}{cost}[/]")
        if saves := self._worth.more_would_save():
            self._line(f"[dim]{marked(saves)}[/]")

    def _why(self, event: Ended) -> str:
        """Why a trial ended short of its goal, and where."""
        decided, plan, step = self._state.decided, self._state.plan, self._state.index
        why: str = event.because
        if event.message and (decided is None or event.message != decided.reason):
            why = f"{why}: {event.message}"
        if plan is None or step >= len(plan.plan):
            return why
        return f"{why}, at step {step + 1} of {len(plan.plan)}, {plan.plan[step].said}"

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
            table.add_row(Text(mark, style), Text(f"{number + 1}. {plain(action.said)}", style))
        return Group(Text("─" * min(40, self._console.width), "dim"), table)


class _Told(NamedTuple):
    """An answer, and whether it agrees with what is expected."""

    exchange: Exchange
    agrees: bool | None


def _answers_line(told: Sequence[_Told]) -> str:
    """Many answers to one question, counted, in the order in which they came."""
    question = told[0].exchange.question
    replies = [each.exchange.answer.reply for each in told]
    styles = {each.exchange.answer.reply: _AGREEMENT_STYLE[each.agrees] for each in told}
    counts = ", ".join(
        f"[{styles[reply]}]{count} {reply}[/]" for reply in Reply if (count := replies.count(reply))
    )
    marks = "".join(_MARK.get(reply, "·") for reply in replies[:_MARKS])
    more = "…" if len(replies) > _MARKS else ""
    ahead = sum(1 if each.agrees else -1 for each in told if each.agrees is not None)
    mark = _mark(told[0] if not ahead else told[0]._replace(agrees=ahead > 0))
    return f"  {mark} {marked(question.text)} {counts}  [dim]{marks}{more}[/]{_unseen(told[0])}"


def _answer_line(told: _Told) -> str:
    question, answer = told.exchange.question, told.exchange.answer
    style = _AGREEMENT_STYLE[told.agrees]
    if answer.p_yes is None:
        chance = ""
    else:
        filled = round(answer.p_yes * _BAR)
        chance = f" [{style}]{'▰' * filled}[/][dim]{'▱' * (_BAR - filled)}[/] {answer.p_yes:.2f}"
    why = f" [dim]{marked(answer.text)}[/]" if answer.reply is Reply.UNKNOWN else _unseen(told)
    if answer.source == "person":
        why = f"{why} [dim](you)[/]"
    return f"  {_mark(told)} {marked(question.text)} [{style}]{answer.reply}[/]{chance}{why}"


def _unseen(told: _Told) -> str:
    """Why nobody was asked, where the look shows nothing."""
    answer = told.exchange.answer
    return f" [dim]{marked(answer.text)}[/]" if answer.source == CAMERA else ""


def _mark(told: _Told) -> str:
    """✓ agrees, ✗ contradicts, ? is no answer, · answers what nobody had an expectation of."""
    if told.agrees is None:
        no_answer = told.exchange.answer.reply not in (Reply.YES, Reply.NO)
        return "[yellow]?[/]" if no_answer else "[dim]·[/]"
    return "[green]✓[/]" if told.agrees else "[red]✗[/]"
