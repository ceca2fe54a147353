"""Choosing with OR-Tools' CP-SAT: for what is large and entangled."""

from collections.abc import Sequence

from tpvqa.errors import BeliefError, MissingExtraError

STEPS = 1_000_000
"""CP-SAT weighs in whole numbers: so many to one unit of log odds."""

_LARGEST_SUM = 2**52


def cp_sat_choice(
    weights: Sequence[float],
    groups: Sequence[tuple[Sequence[int], bool]],
    *,
    seconds: float,
) -> tuple[list[int], bool] | None:
    """The members whose weights have the greatest sum, at most one of each group.

    Weights are rounded to a millionth (more coarsely where they sum up to billions).

    Args:
        weights: What choosing each member is worth.
        groups: The members of each group, and whether one must be chosen.
        seconds: How long it may take.

    Returns:
        The chosen members, ascending, and whether no better choice exists; None where no choice
        satisfies all groups.

    Raises:
        BeliefError: No choice at all was found in the time allowed.
        MissingExtraError: OR-Tools is not installed.
    """
    try:
        from ortools.sat.python import cp_model
    except ImportError as error:
        raise MissingExtraError(
            "ortools", "belief", "Making many entangled facts consistent"
        ) from error
    model = cp_model.CpModel()
    chosen = [model.new_bool_var("") for _ in weights]
    for members, exactly in groups:
        add = model.add_exactly_one if exactly else model.add_at_most_one
        add([chosen[member] for member in members])
    steps = min(STEPS, _LARGEST_SUM / max(1.0, sum(map(abs, weights))))
    worth = [round(weight * steps) for weight in weights]
    model.maximize(cp_model.LinearExpr.weighted_sum(chosen, worth))
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 0
    # The linear relaxation of such groups is nearly whole: without it, equal weights take for ever.
    solver.parameters.linearization_level = 2
    solver.parameters.symmetry_level = 0
    solver.parameters.cp_model_probing_level = 0
    solver.parameters.max_time_in_seconds = seconds
    status = solver.solve(model)
    if status == cp_model.INFEASIBLE:
        return None
    if status not in (cp_model.OPTIMAL, cp_model.FEASIBLE):
        raise BeliefError(
            f"no consistent state of {len(weights):,} entangled facts was found in {seconds:g} s; "
            "allow more time"
        )
    values = [number for number, flag in enumerate(chosen) if solver.boolean_value(flag)]
    return values, status == cp_model.OPTIMAL
