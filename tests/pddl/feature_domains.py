"""Small domains, one for each feature of PDDL that has to be read and planned with."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Sample:
    """A task.

    Attributes:
        name: The feature.
        domain: The domain's text.
        problem: The problem's text.
        cost: Cost of the cheapest plan, worked out by hand; None where there is no plan.
        val: Whether VAL can read it; Fast Downward reads more.
    """

    name: str
    domain: str
    problem: str
    cost: int | None
    val: bool = True


EITHER = Sample(
    "either",
    """(define (domain freight) (:requirements :typing)
    (:types truck parcel place - object)
    (:predicates (at ?x - (either truck parcel) ?p - place) (inside ?x - parcel ?t - truck))
    (:action drive :parameters (?t - truck ?a ?b - place)
      :precondition (at ?t ?a) :effect (and (at ?t ?b) (not (at ?t ?a))))
    (:action load :parameters (?x - parcel ?t - truck ?p - place)
      :precondition (and (at ?x ?p) (at ?t ?p)) :effect (and (inside ?x ?t) (not (at ?x ?p))))
    (:action unload :parameters (?x - parcel ?t - truck ?p - place)
      :precondition (and (inside ?x ?t) (at ?t ?p))
      :effect (and (at ?x ?p) (not (inside ?x ?t)))))""",
    """(define (problem deliver) (:domain freight)
    (:objects van - truck box crate - parcel home shop - place)
    (:init (at van home) (at box shop) (at crate home))
    (:goal (and (at box home) (at crate shop))))""",
    6,
)

NEGATIVE = Sample(
    "negative preconditions and goal",
    """(define (domain lamps) (:requirements :strips :negative-preconditions)
    (:predicates (lit ?l) (broken ?l) (lamp ?l))
    (:action switch_on :parameters (?l)
      :precondition (and (lamp ?l) (not (lit ?l)) (not (broken ?l))) :effect (lit ?l))
    (:action switch_off :parameters (?l) :precondition (lit ?l) :effect (not (lit ?l)))
    (:action mend :parameters (?l)
      :precondition (and (broken ?l) (not (lit ?l))) :effect (not (broken ?l))))""",
    """(define (problem night) (:domain lamps) (:objects a b c)
    (:init (lamp a) (lamp b) (lamp c) (lit a) (broken b))
    (:goal (and (not (lit a)) (lit b) (not (broken c)))))""",
    3,
)

DISJUNCTION = Sample(
    "disjunction and imply",
    """(define (domain doors) (:requirements :adl :typing)
    (:types door - object) (:predicates (ajar ?d - door) (key) (crowbar) (alarm ?d - door))
    (:action take_key :parameters () :precondition (not (crowbar)) :effect (key))
    (:action take_crowbar :parameters () :precondition (not (key)) :effect (crowbar))
    (:action enter :parameters (?d - door)
      :precondition (and (or (key) (crowbar)) (imply (alarm ?d) (key)))
      :effect (ajar ?d)))""",
    """(define (problem house) (:domain doors) (:objects front back - door)
    (:init (alarm front)) (:goal (or (and (ajar front) (ajar back)) (and (key) (crowbar)))))""",
    3,
)

QUANTIFIERS = Sample(
    "quantifiers",
    """(define (domain shelves) (:requirements :adl :typing)
    (:types box shelf - object)
    (:predicates (on ?b - box ?s - shelf) (sealed ?b - box) (checked ?s - shelf) (closed))
    (:action put :parameters (?b - box ?s - shelf)
      :precondition (and (not (exists (?o - shelf) (on ?b ?o))) (not (closed)))
      :effect (on ?b ?s))
    (:action seal :parameters (?b - box)
      :precondition (exists (?s - shelf) (on ?b ?s)) :effect (sealed ?b))
    (:action check :parameters (?s - shelf)
      :precondition (forall (?b - box) (imply (on ?b ?s) (sealed ?b))) :effect (checked ?s))
    (:action close :parameters () :precondition (forall (?s - shelf) (checked ?s))
      :effect (closed)))""",
    """(define (problem stock) (:domain shelves) (:objects b1 b2 - box s1 s2 - shelf)
    (:init (on b1 s1))
    (:goal (and (closed) (forall (?b - box) (exists (?s - shelf) (on ?b ?s))))))""",
    5,
)

CONDITIONAL = Sample(
    "conditional effects",
    """(define (domain briefcase) (:requirements :adl :typing)
    (:types place thing - object)
    (:predicates (here ?p - place) (at ?x - thing ?p - place) (inside ?x - thing) (wet ?x - thing)
      (rainy ?p - place))
    (:action move :parameters (?from ?to - place)
      :precondition (and (here ?from) (not (= ?from ?to)))
      :effect (and (here ?to) (not (here ?from))
        (forall (?x - thing) (when (inside ?x)
          (and (at ?x ?to) (not (at ?x ?from)))))
        (forall (?x - thing) (when (and (inside ?x) (rainy ?to)) (wet ?x)))))
    (:action pack :parameters (?x - thing ?p - place)
      :precondition (and (here ?p) (at ?x ?p)) :effect (inside ?x))
    (:action unpack :parameters (?x - thing) :precondition (inside ?x)
      :effect (not (inside ?x))))""",
    """(define (problem commute) (:domain briefcase)
    (:objects home work garden - place pen pad - thing)
    (:init (here home) (at pen home) (at pad garden) (rainy garden))
    (:goal (and (at pen work) (at pad work) (wet pen) (not (inside pen)))))""",
    5,
)

NESTED = Sample(
    "nested conditional effects",
    CONDITIONAL.domain.replace("(not (at ?x ?from)))", "(not (at ?x ?from)) NESTED)")
    .replace("(forall (?x - thing) (when (and (inside ?x) (rainy ?to)) (wet ?x)))", "")
    .replace("NESTED", "(when (rainy ?to) (wet ?x))"),
    CONDITIONAL.problem,
    5,
    val=False,
)

DERIVED = Sample(
    "derived predicates",
    """(define (domain towers) (:requirements :adl :derived-predicates)
    (:predicates (on ?x ?y) (table ?x) (above ?x ?y) (clear ?x) (block ?x) (tidy))
    (:derived (above ?x ?y) (or (on ?x ?y) (exists (?z) (and (on ?x ?z) (above ?z ?y)))))
    (:derived (clear ?x) (and (block ?x) (not (exists (?y) (on ?y ?x)))))
    (:derived (tidy) (forall (?x) (imply (block ?x) (clear ?x))))
    (:action stack :parameters (?x ?y)
      :precondition (and (clear ?x) (clear ?y) (table ?x) (not (above ?y ?x)) (not (= ?x ?y)))
      :effect (and (on ?x ?y) (not (table ?x))))
    (:action unstack :parameters (?x ?y) :precondition (and (clear ?x) (on ?x ?y))
      :effect (and (table ?x) (not (on ?x ?y)))))""",
    """(define (problem invert) (:domain towers) (:objects a b c)
    (:init (block a) (block b) (block c) (on a b) (on b c) (table c))
    (:goal (above c a)))""",
    3,
)

DERIVED_GOAL = Sample(
    "negated derived goal",
    DERIVED.domain,
    """(define (problem spread) (:domain towers) (:objects a b c)
    (:init (block a) (block b) (block c) (on a b) (on b c) (table c))
    (:goal (and (tidy) (not (above a c)))))""",
    2,
)

COSTS = Sample(
    "action costs",
    """(define (domain routes) (:requirements :typing :action-costs)
    (:types place - object) (:predicates (at ?p - place) (road ?a ?b - place) (rested))
    (:functions (distance ?a ?b - place) - number (total-cost) - number)
    (:action go :parameters (?a ?b - place) :precondition (and (at ?a) (road ?a ?b))
      :effect (and (at ?b) (not (at ?a)) (increase (total-cost) (distance ?a ?b))))
    (:action jump :parameters (?a ?b - place) :precondition (at ?a)
      :effect (and (at ?b) (not (at ?a)) (increase (total-cost) 9)))
    (:action rest :parameters (?a - place) :precondition (at ?a) :effect (rested)))""",
    """(define (problem trip) (:domain routes) (:objects p q r - place)
    (:init (at p) (road p q) (road q r) (= (distance p q) 3) (= (distance q r) 4)
      (= (total-cost) 0))
    (:goal (and (at r) (rested))) (:metric minimize (total-cost)))""",
    7,
)

CONSTANTS = Sample(
    "constants and shared names",
    """(define (domain valve) (:requirements :typing :negative-preconditions)
    (:types valve tool) (:constants main - valve wrench - tool)
    (:predicates (open ?v - valve) (valve ?v - valve) (held ?t - tool))
    (:action open :parameters (?v - valve) :precondition (and (valve ?v) (held wrench))
      :effect (open ?v))
    (:action held :parameters (?t - tool) :precondition (not (open main))
      :effect (held ?t)))""",
    """(define (problem flow) (:domain valve) (:objects side - valve)
    (:init (valve side) (valve main)) (:goal (and (open main) (open side))))""",
    3,
)

EMPTY = Sample(
    "empty sections",
    """(define (domain bare) (:requirements) (:types) (:constants)
    (:predicates (done) (ready))
    (:functions)
    (:action prepare :parameters () :precondition () :effect (ready))
    (:action finish :precondition (and (ready) (and)) :effect (and (done)))
    (:action start :effect (ready)))""",
    """(define (problem small) (:domain bare) (:objects) (:init) (:goal (and (done))))""",
    2,
    val=False,
)

CASE = Sample(
    "letter case",
    """(DEFINE (DOMAIN Loud) (:Requirements :STRIPS :Typing)
    (:TYPES Room) (:Predicates (At ?R - Room) (Linked ?A ?B - ROOM))
    (:ACTION Go :PARAMETERS (?From ?TO - Room)
      :Precondition (AND (at ?from) (LINKED ?From ?to))
      :Effect (And (AT ?To) (NOT (At ?from)))))""",
    """(Define (Problem Walk) (:Domain LOUD) (:Objects Hall ATTIC - room)
    (:INIT (at HALL) (Linked hall attic)) (:Goal (AT Attic)))""",
    1,
)

ADD_AFTER_DELETE = Sample(
    "added and deleted at once",
    """(define (domain spin) (:requirements :strips :conditional-effects :negative-preconditions)
    (:predicates (at ?p) (place ?p) (used ?p))
    (:action move :parameters (?a ?b) :precondition (and (at ?a) (place ?b))
      :effect (and (not (at ?a)) (at ?b) (used ?b)))
    (:action flip :parameters (?a) :precondition (at ?a)
      :effect (and (when (used ?a) (not (used ?a))) (when (place ?a) (used ?a)))))""",
    """(define (problem turn) (:domain spin) (:objects n s)
    (:init (at n) (place n) (place s)) (:goal (and (used n) (used s) (at s))))""",
    2,
)

HOLDS_ALREADY = Sample(
    "a goal that holds", NEGATIVE.domain, NEGATIVE.problem.replace("(not (lit a)) (lit b)", ""), 0
)
STATIC_GOAL = Sample(
    "a goal on what never changes",
    NEGATIVE.domain,
    """(define (problem fixed) (:domain lamps) (:objects a) (:init (lamp a)) (:goal (lamp a)))""",
    0,
)
FALSE_STATIC_GOAL = Sample(
    "an impossible goal on what never changes",
    NEGATIVE.domain,
    """(define (problem never) (:domain lamps) (:objects a) (:init) (:goal (lamp a)))""",
    None,
)
UNREACHABLE = Sample(
    "a goal out of reach",
    NEGATIVE.domain,
    """(define (problem dark) (:domain lamps) (:objects a) (:init (broken a)) (:goal (lit a)))""",
    None,
)
EXHAUSTED = Sample(
    "a goal that only search rules out",
    """(define (domain match) (:requirements :strips :negative-preconditions)
    (:predicates (fresh ?m) (lit ?c) (candle ?c) (match ?m))
    (:action light :parameters (?m ?c) :precondition (and (fresh ?m) (candle ?c))
      :effect (and (lit ?c) (not (fresh ?m)))))""",
    """(define (problem two) (:domain match) (:objects m c d)
    (:init (fresh m) (match m) (candle c) (candle d)) (:goal (and (lit c) (lit d))))""",
    None,
)

SAMPLES = (
    EITHER,
    NEGATIVE,
    DISJUNCTION,
    QUANTIFIERS,
    CONDITIONAL,
    NESTED,
    DERIVED,
    DERIVED_GOAL,
    COSTS,
    CONSTANTS,
    EMPTY,
    CASE,
    ADD_AFTER_DELETE,
    HOLDS_ALREADY,
    STATIC_GOAL,
    FALSE_STATIC_GOAL,
    UNREACHABLE,
    EXHAUSTED,
)
