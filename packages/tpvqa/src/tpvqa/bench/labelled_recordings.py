"""The recorded answers of a VLM beside the truth, each once in a group."""

from collections.abc import Collection

from tpvqa.belief import LabelledAnswer
from tpvqa.questions.question import Way
from tpvqa.vlm.answer import Reply
from tpvqa.vlm.recorded.answers import Recordings
from tpvqa.vlm.recorded.vlm import drawn_from


def label_recordings(told: Recordings, groups: Collection[tuple[Way, str]]) -> list[LabelledAnswer]:
    """What a noise model of recorded answers draws from.

    Trials draw the same few dozen answers again and again. A calibration that counts the draws
    takes chance for habit: 31 answers to what was false became 1,920.

    Args:
        told: The recorded answers.
        groups: Ways of asking and predicates.
    """
    rows: list[LabelledAnswer] = []
    for way, predicate in sorted(groups):
        for truth in (True, False):
            for recording in drawn_from(told, way, predicate, truth=truth):
                for _ in range(recording.count):
                    rows.append(
                        LabelledAnswer(
                            way=way,
                            predicate=predicate,
                            text=f"{way} {predicate}",
                            truth=truth,
                            reply=Reply.YES if recording.yes else Reply.NO,
                            p_yes=recording.p_yes,
                            trial=f"recording {len(rows)}",
                            look=0,
                        )
                    )
    return rows
