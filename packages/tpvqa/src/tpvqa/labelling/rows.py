"""From labels, and from what a person answered in a trial, to labelled answers."""

from collections.abc import Iterator, Sequence

from tpvqa.belief import LabelledAnswer
from tpvqa.labelling.labels import Said, read_labels
from tpvqa.labelling.order import Order
from tpvqa.labelling.recorded import Asking, RecordedEpisode, said_in_trial


def labelled_rows(episodes: Sequence[RecordedEpisode]) -> tuple[list[LabelledAnswer], int]:
    """The answers that a person has told the truth about, and how many labels told it.

    A label holds for every answer to the same words in one stretch. Where there is none, what
    a person answered in the trial itself counts as one.

    Raises:
        CalibrationError: A file of labels is damaged.
    """
    known: dict[int, Said] = {}
    for episode in episodes:
        told = labels_for(episode)
        for asking in episode.askings:
            said = told.get(asking.key) or said_in_trial(asking)
            if said is not None:
                known[id(asking)] = said
    order = Order([asking for episode in episodes for asking in episode.askings])
    weights = order.weights(lambda asking: known.get(id(asking)))
    rows: list[LabelledAnswer] = []
    labels = 0
    for asking in order.askings:
        said = known.get(id(asking))
        if said in ("yes", "no"):
            labels += 1
            rows += rows_of(asking, truth=said == "yes", weight=weights[id(asking)])
    return rows, labels


def labels_for(episode: RecordedEpisode) -> dict[tuple[int, str], Said]:
    """What the labels beside an episode say of all that was asked in it: one of one wording holds
    for all that have none of their own.

    Raises:
        CalibrationError: The file of labels is damaged.
    """
    told = read_labels(episode)
    of_fact = {_fact(each): told[each.key] for each in episode.askings if each.key in told}
    said = {each.key: told.get(each.key) or of_fact.get(_fact(each)) for each in episode.askings}
    return {key: each for key, each in said.items() if each is not None}


def answers_some(episode: RecordedEpisode) -> bool:
    """Whether the labels beside an episode say of any answer of its VLM what was right.

    Raises:
        CalibrationError: The file of labels is damaged.
    """
    told = read_labels(episode)
    return any(told.get(each.key) in ("yes", "no") and each.of_vlm for each in episode.askings)


def stray_labels(episode: RecordedEpisode) -> tuple[tuple[int, str], ...]:
    """The labels beside an episode that are of no question which was asked in it, by when and what.

    Raises:
        CalibrationError: The file of labels is damaged.
    """
    asked = {each.key for each in episode.askings}
    return tuple(key for key in read_labels(episode) if key not in asked)


def _fact(asking: Asking) -> tuple[int, object]:
    """The same for all wordings in which a fact is asked about, as one label holds for all."""
    return asking.stretch, asking.atoms or asking.text


def rows_of(
    asking: Asking, *, truth: bool, weight: float, part: str = ""
) -> Iterator[LabelledAnswer]:
    """The VLM's answers to a question beside the truth.

    Args:
        asking: The question.
        truth: Whether yes is right.
        weight: How many answers each counts for.
        part: See `LabelledAnswer`.
    """
    for answer in asking.of_vlm:
        yield LabelledAnswer(
            way=answer.way,
            predicate=asking.subject,
            text=asking.text,
            truth=truth,
            reply=answer.reply,
            p_yes=answer.p_yes,
            trial=str(asking.episode),
            look=answer.look,
            view=answer.view,
            part=part,
            weight=weight,
        )
