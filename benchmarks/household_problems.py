"""Household problems of any size, for benchmarks."""

from random import Random

_KINDS = {"dish": "plate", "bread": "bread", "fruit": "apple", "knife": "knife"}
_FURNITURE = {
    "table": ["table", "desk"],
    "counter": ["counter", "sideboard"],
    "ground": ["floor"],
    "sink": ["sink"],
    "fridge": ["fridge"],
    "tv": ["tv"],
}


def household_problem(items: int, *, seed: int = 0) -> str:
    """A problem in the shipped household domain.

    Args:
        items: How many things lie about, in equal parts plates, breads, apples and knives.
        seed: Where they lie.
    """
    random = Random(seed)
    names = {kind: [f"{stem}{n}" for n in range(items)] for kind, stem in _KINDS.items()}
    kinds = list(_KINDS)
    things = {kind: names[kind][: (items + 3 - at) // 4] for at, kind in enumerate(kinds)}
    objects = "\n".join(
        f"    {' '.join(group)} - {kind}" for kind, group in (things | _FURNITURE).items() if group
    )
    places = [place for kind in ("table", "counter", "ground") for place in _FURNITURE[kind]]
    facts = []
    for kind, group in things.items():
        for name in group:
            in_fridge = kind == "fruit" and random.random() < 0.5
            facts.append(f"(on {name} {'fridge' if in_fridge else random.choice(places)})")
    goals = [f"(halved {things['fruit'][0]})", "(turned_on tv)"]
    goals += [f"(clean {name})" for name in things["dish"][:2]]
    goals += [f"(on {things['bread'][0]} {things['dish'][0]})"]
    return f"""(define (problem household_{items})
  (:domain household)
  (:objects
    left right - hand
{objects})
  (:init (near tv) (free left) (free right)
    {" ".join(facts)}
    (= (total-cost) 0))
  (:goal (and {" ".join(goals)}))
  (:metric minimize (total-cost)))
"""
