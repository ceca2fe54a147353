"""A VLM, or a camera, that has stopped answering."""

QUESTIONS, ACTIONS = 20, 5
"""So many questions in a row without an answer, over so many actions, are taken for no accident:
what is merely out of sight is expected to come into sight as the robot goes on. A choice."""


class Silence:
    """Counts the questions since anything was last found out, by whatever means."""

    def __init__(self) -> None:
        self._questions = self._actions = 0

    def acted(self) -> None:
        """Note an action; those before the first question without an answer do not count."""
        self._actions += self._questions > 0

    def asked(self, *, answered: bool) -> None:
        """Note a question to the VLM."""
        if answered:
            self.broken()
        else:
            self._questions += 1

    def broken(self) -> None:
        """Note that something was found out: an answer, a reading, a person's word."""
        self._questions = self._actions = 0

    @property
    def told(self) -> str:
        """What is to be said of it; nothing while it may be an accident."""
        return "" if self._actions < ACTIONS else nothing_answered(self._questions)


def nothing_answered(questions: int) -> str:
    """What is said where so many questions in a row found no answer; nothing of a few."""
    if questions < QUESTIONS:
        return ""
    return (
        f"no answer to the last {questions} questions: see whether the camera and the "
        "VLM work; stopped safely"
    )
