; An arm puts parts into trays.
(define (domain sorting)
  (:requirements :strips :typing)
  (:types part tray - object)
  (:predicates
    (lies ?p - part ?t - tray)
    (held ?p - part)
    (gripper_empty))

  (:action pick_up
    :parameters (?p - part ?t - tray)
    :precondition (and (gripper_empty) (lies ?p ?t))
    :effect (and (held ?p) (not (gripper_empty)) (not (lies ?p ?t))))

  (:action put_down
    :parameters (?p - part ?t - tray)
    :precondition (held ?p)
    :effect (and (lies ?p ?t) (gripper_empty) (not (held ?p)))))
