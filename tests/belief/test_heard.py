"""What was heard goes along each way, jointly with how the VLM errs: as brute force has it."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tpvqa.belief.answers.heard import Heard
from tpvqa.belief.answers.kinds import KINDS
from tpvqa.belief.answers.lasting import SHARES, STAYS, own_rate
from tpvqa.belief.answers.led import Led
from tpvqa.belief.answers.worth import Cases, Said, Worth

RATES = 0.85, 0.15
RATIO = float(np.log(RATES[0] / RATES[1]))
FAILS = 0.25
WEIGHTS = np.array([0.3 if not kind.share else 0.35 if kind.coin else 0.0 for kind in KINDS])
HELD = [kind for kind in range(len(KINDS)) if WEIGHTS[kind]]
FALSE, TRUE = 0, 1
WAYS = [(FALSE, FALSE, FAILS), (FALSE, TRUE, 1 - FAILS), (TRUE, TRUE, 1.0)]
"""An action makes a fact true, or fails; where it is true already it changes nothing."""


def filtered(answers: list[list[bool]], before: float) -> tuple[float, np.ndarray]:
    """P(the fact holds) and of every kind of error, after answers with an action between each."""
    worth, heard = Worth(None, WEIGHTS.tolist()), Heard()
    mass = np.stack([(1 - before) * worth.weights, before * worth.weights])
    numbers, truth = (FALSE, TRUE), {FALSE: False, TRUE: True}
    for place, said in enumerate(answers):
        if place:
            whole = mass.sum(axis=1)
            led = [(old, new, whole[old] * share) for old, new, share in WAYS]
            after = {n: sum(w for _, new, w in led if new == n) for n in numbers}
            noise = {n: mass[n] / whole[n] for n in numbers}
            went = Led.of(led, after, noise, {FALSE: 0, TRUE: 1})
            heard.acted(went, truth)
            mass = np.array([after[n] for n in went.after])[:, None] * went.mixed
            mass = mass[[went.after.index(n) for n in numbers]]
        for yes in said:
            right = np.array([False, True])
            cases = Cases(mass, right, heard.drawn(numbers, right, len(KINDS)))
            taken = worth.take(Said(yes, RATIO if yes else -RATIO), cases, RATES)
            heard.told(numbers, taken.drawn)
            mass = mass * taken.likely
            mass /= mass.sum()
    return float(mass[TRUE].sum()), mass.sum(axis=0)


def enumerated(answers: list[list[bool]], before: float) -> tuple[float, np.ndarray]:
    """The same by all that can have been true, and all that the scene's own answers can be."""
    rates = [own_rate(np.full(len(KINDS), rate)) for rate in (RATES[1], RATES[0])]
    found = np.zeros((2, len(KINDS)))
    scenes = len(answers)
    for kind in HELD:
        coin, share, stays = KINDS[kind].coin, SHARES[kind], STAYS[kind]
        for true in product((FALSE, TRUE), repeat=scenes):
            for own in product((False, True), repeat=scenes):
                weight = WEIGHTS[kind] * (before if true[0] else 1 - before)
                for place, said in enumerate(answers):
                    rate = rates[true[place]][kind]
                    drawn = rate if own[place] else 1 - rate
                    if place:
                        old, new = true[place - 1], true[place]
                        weight *= sum(w for a, b, w in WAYS if (a, b) == (old, new))
                        if old == new:
                            drawn = float(own[place] == own[place - 1])
                        else:
                            drawn = stays * (own[place] != own[place - 1]) + (1 - stays) * drawn
                    weight *= drawn
                    fresh = 0.5 if coin else RATES[0] if true[place] else RATES[1]
                    for yes in said:
                        p_yes = share * own[place] + (1 - share) * fresh
                        weight *= p_yes if yes else 1 - p_yes
                found[true[-1], kind] += weight
    found /= found.sum()
    return float(found[TRUE].sum()), found.sum(axis=0)


@given(
    st.lists(st.lists(st.booleans(), min_size=1, max_size=4), min_size=1, max_size=3),
    st.floats(0.05, 0.95),
)
def test_what_was_heard_and_the_noise_are_filtered_as_brute_force_has_it(
    answers: list[list[bool]], before: float
) -> None:
    """With errors that are drawn anew, and with questions that are misread."""
    believed, kinds = filtered(answers, before)
    expected, all_kinds = enumerated(answers, before)
    assert believed == pytest.approx(expected, abs=1e-6)
    assert kinds == pytest.approx(all_kinds, abs=1e-6)


def test_a_question_that_is_always_misread_is_outvoted_by_what_is_done() -> None:
    """Four tries that each work in three of four cases; only noes come of it."""
    noes = [[False] * 3] * 4
    assert filtered(noes[:1], 0.75)[0] < 0.5
    assert filtered(noes, 0.75)[0] > 0.7
