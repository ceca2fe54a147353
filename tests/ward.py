"""A hospital at night, of which not all is known: where the tools lie, and which one is needed."""

from tpvqa.pddl import Task, task_from_text

DOMAIN = """(define (domain ward)
  (:requirements :typing :negative-preconditions)
  (:types room tool patient)
  (:predicates (at ?r - room) (in ?t - tool ?r - room) (held ?t - tool) (free)
    (treated ?p - patient) (lies ?p - patient ?r - room) (needs ?p - patient ?t - tool))
  (:action go
    :parameters (?a ?b - room)
    :precondition (at ?a)
    :effect (and (at ?b) (not (at ?a))))
  (:action take
    :parameters (?t - tool ?r - room)
    :precondition (and (at ?r) (in ?t ?r) (free))
    :effect (and (held ?t) (not (in ?t ?r)) (not (free))))
  (:action put
    :parameters (?t - tool ?r - room)
    :precondition (and (at ?r) (held ?t))
    :effect (and (not (held ?t)) (in ?t ?r) (free)))
  (:action treat
    :parameters (?p - patient ?t - tool ?r - room)
    :precondition (and (at ?r) (lies ?p ?r) (held ?t) (needs ?p ?t))
    :effect (treated ?p)))
"""
OPEN = """(oneof (in pump store) (in pump theatre) (in pump hall))
    (unknown (in lamp hall)) (unknown (in lamp store))
    (oneof (needs anna pump) (needs anna lamp))"""
PROBLEM = f"""(define (problem night)
  (:domain ward)
  (:objects hall store theatre - room lamp pump - tool anna - patient)
  (:init (at hall) (free) (lies anna theatre)
    {OPEN})
  (:goal (treated anna)))
"""


def ward(opened: str = OPEN) -> Task:
    """The task, with what its problem leaves open."""
    return task_from_text(DOMAIN, PROBLEM.replace(OPEN, opened))
