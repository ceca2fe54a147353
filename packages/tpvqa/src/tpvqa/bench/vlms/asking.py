"""Asking every VLM the same about the same looks."""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from tpvqa.assembly.answering import vlm_with_answers
from tpvqa.bench.vlms.looks import Labelled, LabelledLook
from tpvqa.config import TrialConfig
from tpvqa.observation import Observation
from tpvqa.pddl import Action, Atom, Task
from tpvqa.plugins import Closing, Kind, load_spec, see_taken, takes
from tpvqa.questions import Way
from tpvqa.vlm import VLM, Answer, Reply
from tpvqa.vlm.capabilities import is_deterministic, is_noise_model
from tpvqa.vlm.checking import ask_checked
from tpvqa.vlm.making import in_full, make_vlm
from tpvqa.vlm.sight import ask_seeing

OF_COMPARISONS = b"vlm compare"
"""The trial of answers that are recorded here."""
PICTURES = 512
"""That a VLM may keep."""


@dataclass(frozen=True, slots=True)
class Row:
    """One answer beside the truth.

    Attributes:
        vlm: Whose.
        look: The look's name.
        cluster: What hangs together.
        scene: Tells true states apart.
        way: The way of asking.
        predicate: The predicate asked about, or the action.
        fact: What is asked about, the same in all words.
        wording: Which words.
        question: The words.
        repeat: The number of the asking.
        truth: Whether yes is right.
        reply: What it said.
        p_yes: Its P(yes), where it gave one.
        source: How that was obtained.
        seconds: How long it took when it was asked.
        text: The VLM's raw words.
    """

    vlm: str
    look: str
    cluster: str
    scene: str
    way: Way
    predicate: str
    fact: str
    wording: str
    question: str
    repeat: int
    truth: bool
    reply: Reply
    p_yes: float | None
    source: str
    seconds: float
    text: str

    def plain(self) -> dict[str, Any]:
        """For CSV."""
        return {**asdict(self), "way": str(self.way), "reply": str(self.reply)}


class KnownTruth:
    """What is true of the one thing that is asked about: for noise models."""

    def __init__(self) -> None:
        self.now: Labelled | None = None

    def holds(self, atom: Atom) -> bool:
        """Whether yes is right."""
        return self._truth()

    def visible(self, atom: Atom) -> bool:
        """Always: what is not shown is not asked."""
        return True

    def possible(self, action: Action) -> bool:
        """Whether yes is right."""
        return self._truth()

    def successful(self, action: Action) -> bool:
        """Whether yes is right."""
        return self._truth()

    def scene(self) -> str:
        """That of the look."""
        return "" if self.now is None else self.now.scene

    def _truth(self) -> bool:
        return self.now is not None and self.now.truth


def ask_all(
    specs: Sequence[str],
    looks: Sequence[LabelledLook],
    *,
    config: TrialConfig,
    task: Task | None = None,
    repeats: int = 1,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[Row]:
    """Ask every VLM every question about every look.

    Args:
        specs: The VLMs' specifications.
        looks: What is asked about.
        config: Seed, options, and the file of recorded answers.
        task: For noise models, which want to know one.
        repeats: How often everything is asked; once of those that never answer otherwise.
        progress: Told how many looks were asked about, and how many there are.

    Raises:
        TpvqaError: A VLM cannot be made or asked.
    """
    specs = list(dict.fromkeys(map(in_full, specs)))
    _see_options(specs, config)
    times = {spec: _times(spec, repeats) for spec in specs}
    rows: list[Row] = []
    done, total = 0, len(looks) * sum(times.values())
    progress(done, total)
    for spec in specs:
        truth = KnownTruth()
        vlm = _made(spec, config, truth, task)
        try:
            for repeat in range(times[spec]):
                for number, look in enumerate(looks):
                    seen = look.read(repeat * len(looks) + number)
                    for each, answer in _asked(vlm, truth, seen, look.asked):
                        rows.append(_row(spec, look, each, answer, repeat))
                    done += 1
                    progress(done, total)
        finally:
            if isinstance(vlm, Closing):
                vlm.close()
    return rows


def _see_options(specs: Sequence[str], config: TrialConfig) -> None:
    """See that every option is one that some VLM takes."""
    taken = set().union(*(takes(load_spec(Kind.VLM, spec)) for spec in specs))
    if "*" not in taken:
        see_taken(config.options, taken, config.options, whose="these VLMs")


def _times(spec: str, repeats: int) -> int:
    return 1 if is_deterministic(load_spec(Kind.VLM, spec)) else repeats


def _made(spec: str, config: TrialConfig, truth: KnownTruth, task: Task | None) -> VLM:
    if not is_noise_model(load_spec(Kind.VLM, spec)):
        return vlm_with_answers(
            spec, config, trial=OF_COMPARISONS, remember=PICTURES, every_option=False
        )
    context = {"truth": truth, "seed": config.seed, "episode": config.episode, "task": task}
    return make_vlm(spec, config.plugin_options() | context)[0]


def _asked(
    vlm: VLM, truth: KnownTruth, seen: Observation, asked: Sequence[Labelled]
) -> list[tuple[Labelled, Answer]]:
    if not is_noise_model(vlm):
        answers = ask_seeing(vlm, seen, [each.question for each in asked])
        return list(zip(asked, answers, strict=True))
    found = []
    for each in asked:
        truth.now = each
        found.append((each, ask_checked(vlm, seen, [each.question])[0]))
    return found


def _row(spec: str, look: LabelledLook, asked: Labelled, answer: Answer, repeat: int) -> Row:
    question = asked.question
    return Row(
        vlm=spec,
        look=look.name,
        cluster=look.cluster,
        scene=asked.scene,
        way=question.way,
        predicate=question.subject,
        fact=asked.fact,
        wording=asked.wording,
        question=question.text,
        repeat=repeat,
        truth=asked.truth,
        reply=answer.reply,
        p_yes=answer.p_yes,
        source=answer.source,
        seconds=answer.seconds,
        text=answer.text,
    )
