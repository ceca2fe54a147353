"""The answers to the same questions at several looks, as one answer each."""

from collections.abc import Sequence
from dataclasses import replace

from tpvqa.vlm import Answer, Reply


def vote(rounds: Sequence[Sequence[Answer]]) -> list[Answer]:
    """What most looks say, question by question.

    A question whose yeses and noes are equally many stays *unknown*, or *cannot see* where no look
    says either. P(yes) is the mean.

    Args:
        rounds: The answers of each look, in the order of the questions.
    """
    if len(rounds) == 1:
        return list(rounds[0])
    return [_vote(answers) for answers in zip(*rounds, strict=True)]


def _vote(answers: Sequence[Answer]) -> Answer:
    replies = [answer.reply for answer in answers]
    yes, no = replies.count(Reply.YES), replies.count(Reply.NO)
    if yes != no:
        reply = Reply.YES if yes > no else Reply.NO
    else:
        reply = Reply.UNKNOWN if yes else answers[-1].reply
    return together(answers, reply)


def together(answers: Sequence[Answer], reply: Reply) -> Answer:
    """The answers to one question as one; P(yes) is the mean.

    Args:
        answers: Of several looks, at least one.
        reply: What they come to.
    """
    replies = [answer.reply for answer in answers]
    yes, no = replies.count(Reply.YES), replies.count(Reply.NO)
    chances = [answer.p_yes for answer in answers if answer.p_yes is not None]
    return replace(
        answers[-1],
        reply=reply,
        p_yes=sum(chances) / len(chances) if chances else None,
        text=f"{yes} yes, {no} no",
        seconds=sum(answer.seconds for answer in answers),
    )
