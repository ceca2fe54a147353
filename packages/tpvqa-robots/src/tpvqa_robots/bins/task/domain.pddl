; Robosuite's pick-and-place: things go from one bin into others.
(define (domain groceries)
  (:requirements :strips :typing)
  (:types thing bin)
  (:predicates (in ?x - thing ?b - bin) (in_hand ?x - thing) (hand_empty))
  (:action pick_up
    :parameters (?x - thing ?from - bin)
    :precondition (and (in ?x ?from) (hand_empty))
    :effect (and (in_hand ?x) (not (in ?x ?from)) (not (hand_empty))))
  (:action place
    :parameters (?x - thing ?to - bin)
    :precondition (in_hand ?x)
    :effect (and (in ?x ?to) (not (in_hand ?x)) (hand_empty))))
