"""What is raised of PDDL that cannot be read."""


class ReadingError(Exception):
    """PDDL that cannot be read.

    Args:
        message: What is wrong and what was expected.
        part: "domain" or "problem".
        line: The line, where known.
    """

    def __init__(self, message: str, part: str, line: int | None):
        super().__init__(message)
        self.message, self.part, self.line = message, part, line
