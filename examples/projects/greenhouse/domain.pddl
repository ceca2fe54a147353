; A robot waters plants and switches the lamp on over them.
(define (domain greenhouse)
  (:requirements :strips :typing)
  (:types plant - object)
  (:predicates
    (dry ?p - plant)
    (moist ?p - plant)
    (lit)
    (dark)
    (filled)          ; the watering can
    (empty))

  (:action fill_can
    :parameters ()
    :precondition (empty)
    :effect (and (filled) (not (empty))))

  (:action water
    :parameters (?p - plant)
    :precondition (and (filled) (dry ?p))
    :effect (and (moist ?p) (empty) (not (dry ?p)) (not (filled))))

  (:action switch_lamp_on
    :parameters ()
    :precondition (dark)
    :effect (and (lit) (not (dark)))))
