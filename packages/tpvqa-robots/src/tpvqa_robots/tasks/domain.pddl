; The paper's appendix: toys are collected in a container that stands in the goal area.
; What has fallen to the floor is out of the arm's reach.
(define (domain toys)
  (:requirements :strips :typing :existential-preconditions)
  (:types thing - object place movable - thing container toy - movable)
  (:constants table goal_area floor - place)
  (:predicates (in_hand ?x - movable) (hand_empty) (found ?x - thing)
               (on ?x - movable ?where - thing))
  (:action find
    :parameters (?x - thing ?from - thing)
    :precondition (found ?from)
    :effect (and (found ?x) (not (found ?from))))
  (:action pick_up
    :parameters (?x - movable)
    :precondition (and (found ?x) (on ?x table) (hand_empty))
    :effect (and (in_hand ?x) (not (on ?x table)) (not (hand_empty))))
  (:action place
    :parameters (?x - movable ?where - thing)
    :precondition (and (in_hand ?x) (found ?where))
    :effect (and (on ?x ?where) (not (in_hand ?x)) (hand_empty))))
