; A robot with one gripper sterilises an instrument and lays it on a tray.
; While the autoclave runs the robot's gripper is free for something else.
(define (domain laboratory)
  (:requirements :strips :typing :negative-preconditions :durative-actions)
  (:types item place - object autoclave table - place instrument tray - item)
  (:predicates
    (at ?x - item ?p - place)
    (in_store ?x - item)
    (held ?x - item)
    (gripper_free)
    (shut ?a - autoclave)
    (opened ?a - autoclave)
    (sterilised ?i - instrument)
    (laid ?i - instrument ?t - tray))
  (:functions (way ?t - tray) (cycle ?a - autoclave))

  (:action open :parameters (?a - autoclave)
    :precondition (and (shut ?a) (gripper_free))
    :effect (and (opened ?a) (not (shut ?a))))

  (:action close :parameters (?a - autoclave)
    :precondition (and (opened ?a) (gripper_free))
    :effect (and (shut ?a) (not (opened ?a))))

  (:action put_down :parameters (?x - item ?p - table)
    :precondition (held ?x)
    :effect (and (at ?x ?p) (gripper_free) (not (held ?x))))

  (:durative-action load :parameters (?i - instrument ?p - table ?a - autoclave)
    :duration (= ?duration 5)
    :condition (and (at start (at ?i ?p)) (at start (gripper_free))
                    (over all (held ?i)) (over all (opened ?a)))
    :effect (and (at start (not (at ?i ?p))) (at start (not (gripper_free))) (at start (held ?i))
                 (at end (not (held ?i))) (at end (gripper_free)) (at end (at ?i ?a))))

  (:durative-action sterilise :parameters (?i - instrument ?a - autoclave)
    :duration (= ?duration (cycle ?a))
    :condition (and (over all (at ?i ?a)) (over all (shut ?a)))
    :effect (at end (sterilised ?i)))

  (:durative-action fetch :parameters (?t - tray ?p - table)
    :duration (= ?duration (* 2 (way ?t)))
    :condition (and (at start (in_store ?t)) (at start (gripper_free)) (over all (held ?t)))
    :effect (and (at start (not (in_store ?t))) (at start (not (gripper_free)))
                 (at start (held ?t))
                 (at end (not (held ?t))) (at end (gripper_free)) (at end (at ?t ?p))))

  (:durative-action lay :parameters (?i - instrument ?a - autoclave ?t - tray ?p - table)
    :duration (= ?duration 4)
    :condition (and (at start (at ?i ?a)) (at start (sterilised ?i)) (at start (gripper_free))
                    (over all (held ?i)) (over all (opened ?a)) (over all (at ?t ?p)))
    :effect (and (at start (not (at ?i ?a))) (at start (not (gripper_free))) (at start (held ?i))
                 (at end (not (held ?i))) (at end (gripper_free)) (at end (laid ?i ?t)))))
