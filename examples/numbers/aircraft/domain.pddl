; People fly between cities in aircraft that burn fuel and have so many seats, in the manner of
; Zenotravel (third International Planning Competition, numeric track). Neither questions nor a
; world file: what a domain comes to for which nobody wrote any.
(define (domain aircraft)
  (:requirements :typing :numeric-fluents)
  (:types aircraft person - movable city)
  (:predicates
    (located ?x - movable ?c - city)
    (in ?p - person ?a - aircraft))
  (:functions
    (fuel ?a - aircraft)
    (capacity ?a - aircraft)
    (burn ?a - aircraft)
    (onboard ?a - aircraft)
    (seats ?a - aircraft)
    (distance ?from ?to - city)
    (total-fuel-used))

  (:action board
    :parameters (?p - person ?a - aircraft ?c - city)
    :precondition (and (located ?p ?c) (located ?a ?c) (< (onboard ?a) (seats ?a)))
    :effect (and (not (located ?p ?c)) (in ?p ?a) (increase (onboard ?a) 1)))

  (:action debark
    :parameters (?p - person ?a - aircraft ?c - city)
    :precondition (and (in ?p ?a) (located ?a ?c))
    :effect (and (not (in ?p ?a)) (located ?p ?c) (decrease (onboard ?a) 1)))

  (:action fly
    :parameters (?a - aircraft ?from ?to - city)
    :precondition (and (located ?a ?from) (>= (fuel ?a) (* (distance ?from ?to) (burn ?a))))
    :effect (and
      (not (located ?a ?from))
      (located ?a ?to)
      (increase (total-fuel-used) (* (distance ?from ?to) (burn ?a)))
      (decrease (fuel ?a) (* (distance ?from ?to) (burn ?a)))))

  (:action refuel
    :parameters (?a - aircraft ?c - city)
    :precondition (and (located ?a ?c) (< (fuel ?a) (capacity ?a)))
    :effect (assign (fuel ?a) (capacity ?a))))
