; Robosuite's door: a handle is gripped and turned, and the door pulled open.
(define (domain door)
  (:requirements :strips :typing)
  (:types door handle)
  (:predicates (holding ?h - handle) (hand_empty) (turned ?h - handle) (open ?d - door))
  (:action grasp_handle
    :parameters (?h - handle)
    :precondition (hand_empty)
    :effect (and (holding ?h) (not (hand_empty))))
  (:action turn_handle
    :parameters (?h - handle)
    :precondition (holding ?h)
    :effect (turned ?h))
  (:action pull_open
    :parameters (?d - door ?h - handle)
    :precondition (and (holding ?h) (turned ?h))
    :effect (open ?d))
  (:action let_go
    :parameters (?h - handle)
    :precondition (holding ?h)
    :effect (and (not (holding ?h)) (hand_empty) (not (turned ?h)))))
