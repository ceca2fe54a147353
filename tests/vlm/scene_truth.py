"""The truth of a made-up world, for tests of noise models whose errors last."""

from collections.abc import Iterable

from tpvqa.pddl import Action, Atom


class SceneTruth:
    """Some facts are true, in a scene that the test names."""

    def __init__(self, true: Iterable[Atom] = (), scene: str = "first"):
        self.true, self.name = set(true), scene

    def holds(self, atom: Atom) -> bool:
        return atom in self.true

    def visible(self, atom: Atom) -> bool:
        return True

    def possible(self, action: Action) -> bool:
        return True

    def successful(self, action: Action) -> bool:
        return True

    def scene(self) -> str:
        return self.name


class OlderTruth:
    """That of a plug-in which knows nothing of scenes."""

    def holds(self, atom: Atom) -> bool:
        return True

    def visible(self, atom: Atom) -> bool:
        return True

    def possible(self, action: Action) -> bool:
        return True

    def successful(self, action: Action) -> bool:
        return True
