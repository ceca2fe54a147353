; A household with a two-handed robot: one domain for the three tasks of the paper.
;
; `find` names where the robot comes from, so that leaving is an explicit delete and the
; planner sees that the robot is near exactly one thing. What lies in a container can be
; found once the container is open; the floor is where dropped things end up.
(define (domain household)
  (:requirements :strips :typing :negative-preconditions :equality
                 :disjunctive-preconditions :universal-preconditions :action-costs)
  (:types
    thing hand - object
    surface container appliance tool food - thing
    table counter sink ground dish - surface
    fridge - container
    tv - appliance
    fruit bread - food
    knife - tool)
  (:predicates
    (near ?x - thing)
    (in_hand ?x - thing ?h - hand)
    (free ?h - hand)
    (on ?x - thing ?where - thing)
    (opened ?c - container)
    (turned_on ?a - appliance)
    (clean ?x - dish)
    (halved ?x - fruit))
  (:functions (total-cost) - number)

  (:action find
    :parameters (?x - thing ?from - thing)
    :precondition (and (near ?from) (not (= ?x ?from))
                       (forall (?c - container) (or (opened ?c) (not (on ?x ?c)))))
    :effect (and (near ?x) (not (near ?from)) (increase (total-cost) 1)))

  (:action pick_up
    :parameters (?x - thing ?where - thing ?h - hand)
    :precondition (and (near ?x) (on ?x ?where) (free ?h))
    :effect (and (in_hand ?x ?h) (not (on ?x ?where)) (not (free ?h))
                 (increase (total-cost) 1)))

  (:action place
    :parameters (?x - thing ?where - surface ?h - hand)
    :precondition (and (in_hand ?x ?h) (near ?where) (not (= ?x ?where)))
    :effect (and (on ?x ?where) (not (in_hand ?x ?h)) (free ?h) (increase (total-cost) 1)))

  (:action open
    :parameters (?c - container)
    :precondition (near ?c)
    :effect (and (opened ?c) (increase (total-cost) 1)))

  (:action wash
    :parameters (?x - dish ?s - sink ?h - hand)
    :precondition (and (in_hand ?x ?h) (near ?s))
    :effect (and (clean ?x) (increase (total-cost) 1)))

  (:action turn_on
    :parameters (?a - appliance)
    :precondition (near ?a)
    :effect (and (turned_on ?a) (increase (total-cost) 1)))

  (:action cut_in_half
    :parameters (?x - fruit ?k - knife ?hx ?hk - hand)
    :precondition (and (in_hand ?x ?hx) (in_hand ?k ?hk))
    :effect (and (halved ?x) (increase (total-cost) 1))))
