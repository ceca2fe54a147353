"""A noise model with the accuracies that the paper measured: it knows the truth, sees nothing."""

from collections.abc import Mapping

from tpvqa.errors import PluginError
from tpvqa.pddl import Task
from tpvqa.questions.question import Question, Way
from tpvqa.vlm.oracle import Oracle
from tpvqa.vlm.protocol import TruthSource

PAPER_TABLE: Mapping[Way, Mapping[str, float]] = {
    Way.PRECONDITION: {"clean_dishes": 0.63, "serve_breakfast": 0.53, "eat_apple": 0.70},
    Way.POSSIBLE: {"clean_dishes": 0.58, "serve_breakfast": 0.33, "eat_apple": 0.43},
    Way.EFFECT: {"clean_dishes": 0.79, "serve_breakfast": 0.60, "eat_apple": 0.71},
    Way.SUCCESSFUL: {"clean_dishes": 0.45, "serve_breakfast": 0.30, "eat_apple": 0.47},
}
"""VQA accuracies by way of asking and task (Zhang et al. 2023, table "VQA accuracies on different
querying strategies", ViLBERT)."""
_ROW = {Way.ALTERNATIVE: Way.PRECONDITION, Way.DID: Way.SUCCESSFUL}


class PaperTable(Oracle):
    """Right as often as the paper's table says, for this task and way of asking.

    "Did the robot successfully …?" takes the row of "Was … successful?"; where else a thing is
    takes the row of preconditions. Rates under one half stay as they are.

    Args:
        truth: What is true in the world.
        task: Names the column.
        seed: The user's seed.
        episode: Number of the episode under this seed.

    Raises:
        PluginError: The table has no column for the task.
    """

    def __init__(self, truth: TruthSource, task: Task, *, seed: int = 0, episode: int = 0):
        super().__init__(truth, seed=seed, episode=episode)
        known = PAPER_TABLE[Way.EFFECT]
        if task.name not in known:
            raise PluginError(
                f"The paper's table has no column for the task {task.name!r}, only for "
                f"{', '.join(known)}. Use oracle:ACCURACY instead."
            )
        self._task = task.name

    @classmethod
    def from_spec(  # type: ignore[override]
        cls, arguments: str, *, truth: TruthSource, task: Task, seed: int = 0, episode: int = 0
    ) -> "PaperTable":
        """Make it from `paper-table`.

        Raises:
            PluginError: There are arguments, or no column for the task.
        """
        if arguments:
            raise PluginError(f"'paper-table:{arguments}' is not understood. Write paper-table.")
        return cls(truth, task, seed=seed, episode=episode)

    @property
    def name(self) -> str:
        """What the log calls it."""
        return "paper-table"

    def accuracy_of(self, question: Question) -> float:
        """The table's entry for this task and way of asking."""
        return PAPER_TABLE[_ROW.get(question.way, question.way)][self._task]
