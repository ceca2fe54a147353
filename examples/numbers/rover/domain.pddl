; A rover collects samples. Driving takes charge from its battery, the sun gives some back; its
; basket holds so much.
(define (domain rover)
  (:requirements :strips :typing :negative-preconditions :numeric-fluents)
  (:types place sample)
  (:predicates
    (at ?p - place)
    (dock ?p - place)
    (lying ?s - sample ?p - place)
    (aboard ?s - sample)
    (stored ?s - sample))
  (:functions
    (battery)                      ; percent
    (load)                         ; kilograms in the basket
    (capacity)
    (weight ?s - sample)
    (way ?a ?b - place))           ; percent of the battery that the way takes

  (:action drive
    :parameters (?a ?b - place)
    :precondition (and (at ?a) (>= (battery) (way ?a ?b)))
    :effect (and (not (at ?a)) (at ?b) (decrease (battery) (way ?a ?b))))

  (:action charge
    :parameters (?p - place)
    :precondition (and (at ?p) (dock ?p) (< (battery) 100))
    :effect (assign (battery) 100))

  (:action wait
    :parameters ()
    :precondition (< (battery) 100)
    :effect (increase (battery) 10))

  (:action collect
    :parameters (?s - sample ?p - place)
    :precondition (and (at ?p) (lying ?s ?p) (<= (+ (load) (weight ?s)) (capacity)))
    :effect (and (not (lying ?s ?p)) (aboard ?s) (increase (load) (weight ?s))))

  (:action unload
    :parameters (?s - sample ?p - place)
    :precondition (and (at ?p) (dock ?p) (aboard ?s))
    :effect (and (not (aboard ?s)) (stored ?s) (decrease (load) (weight ?s)))))
