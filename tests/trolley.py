"""A task whose effects are conditional: what is on the trolley goes where the trolley goes."""

from tpvqa.pddl import Task, task_from_text

DOMAIN = """(define (domain errands) (:requirements :typing :conditional-effects)
(:types box room)
(:predicates (at ?b - box ?r - room) (parked ?r - room) (aboard ?b - box) (beside ?b - box))
(:action drive :parameters (?to - room)
  :precondition (not (parked ?to))
  :effect (and (parked ?to)
    (forall (?from - room) (when (parked ?from) (not (parked ?from))))
    (forall (?b - box) (when (aboard ?b) (at ?b ?to)))
    (forall (?b - box ?from - room)
      (when (and (aboard ?b) LEFT (at ?b ?from)) (not (at ?b ?from))))))
(:action lift :parameters (?b - box ?r - room)
  :precondition (and (parked ?r) (at ?b ?r))
  :effect (and (when (beside ?b) (and (aboard ?b) (not (beside ?b))))
               (when (aboard ?b) (and (beside ?b) (not (aboard ?b)))))))"""

INIT = "(at crate hall) (at chest hall) (beside crate) (aboard chest) (parked hall)"


def trolley(init: str = INIT, left: str = "") -> Task:
    """The task.

    Args:
        init: Its initial state.
        left: On what else it depends that a box on the trolley is gone from where it was.
    """
    problem = f"""(define (problem bring) (:domain errands)
    (:objects crate chest - box hall attic cellar - room)
    (:init {init}) (:goal (and (at crate attic) (at chest cellar))))"""
    return task_from_text(DOMAIN.replace("LEFT", left), problem)
