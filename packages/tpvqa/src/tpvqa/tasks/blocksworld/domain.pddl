; Blocks in columns: a gripper takes the top block of a column and puts it on top of another.
;
; A column is the place below its lowest block. That `moveblock` names all that it changes lets
; the planner see that a block is in exactly one place and in exactly one column.
(define (domain blocksworld)
  (:requirements :strips :typing :negative-preconditions :equality)
  (:types block column - place)
  (:predicates
    (on ?x - block ?under - place)
    (clear ?x - place)
    (incolumn ?x - place ?c - column))

  (:action moveblock
    :parameters (?x - block ?under - place ?onto - place ?from - column ?to - column)
    :precondition (and (clear ?x) (on ?x ?under) (incolumn ?x ?from)
                       (clear ?onto) (incolumn ?onto ?to) (not (= ?from ?to)))
    :effect (and (on ?x ?onto) (not (on ?x ?under))
                 (incolumn ?x ?to) (not (incolumn ?x ?from))
                 (clear ?under) (not (clear ?onto)))))
