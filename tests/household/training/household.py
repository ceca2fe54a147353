"""Facts of pictures, written short."""

from tpvqa.pddl import Atom
from tpvqa_household.kitchen.household import Household, atoms_of_interest
from tpvqa_household.training.facts import Facts


def facts(household: Household, *, hidden: tuple[str, ...] = ()) -> Facts:
    """The facts of a household, those in `hidden` ("(on apple fridge)") not to be seen."""
    state = household.state()
    return {
        atom: (atom in state, atom.pddl() not in hidden)
        for atom in atoms_of_interest()
        if atom.predicate != "free"
    }


def shows(*things: str) -> dict[Atom, tuple[bool, bool]]:
    """near(x) as its question means it: which things are in the picture."""
    near = [atom for atom in atoms_of_interest() if atom.predicate == "near"]
    return {atom: (atom.arguments[0] in things, True) for atom in near}
