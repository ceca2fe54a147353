"""What noise models cannot answer: what the world file says is not shown from here."""

from tpvqa.observation import Observation
from tpvqa.questions.question import FactQuestion, Question
from tpvqa.vlm.answer import Answer, Reply
from tpvqa.vlm.protocol import TruthSource


def out_of_sight(observation: Observation, question: Question, truth: TruthSource) -> Answer | None:
    """The answer *cannot see*, where no fact that is asked about is shown; else None.

    Of worlds with pictures noise models answer everything, whatever the pictures show.
    """
    if observation.frames or not isinstance(question, FactQuestion):
        return None
    if any(map(truth.visible, question.atoms)):
        return None
    return Answer(question, Reply.CANNOT_SEE, source="world file", text="not shown from here")
