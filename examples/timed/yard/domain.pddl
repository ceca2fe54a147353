; Two cranes carry crates, at once where they can, past a lorry that has to stay; crates are painted
; where they stand. Nothing was tuned to it: it has no questions and no world file.
(define (domain yard)
  (:requirements :strips :typing :durative-actions)
  (:types crane crate spot)
  (:predicates
    (idle ?c - crane)
    (reach ?c - crane ?s - spot)
    (on ?x - crate ?s - spot)
    (lifted ?x - crate ?c - crane)
    (empty ?s - spot)
    (painted ?x - crate)
    (parked))

  (:durative-action carry :parameters (?c - crane ?x - crate ?from ?to - spot)
    :duration (= ?duration 4)
    :condition (and (at start (idle ?c)) (at start (on ?x ?from)) (at start (empty ?to))
                    (at start (reach ?c ?from)) (at start (reach ?c ?to))
                    (over all (parked)) (over all (lifted ?x ?c)))
    :effect (and (at start (not (idle ?c))) (at start (not (on ?x ?from)))
                 (at start (not (empty ?to))) (at start (lifted ?x ?c))
                 (at end (idle ?c)) (at end (on ?x ?to)) (at end (not (lifted ?x ?c)))
                 (at end (empty ?from))))

  (:durative-action paint :parameters (?x - crate ?s - spot)
    :duration (= ?duration 3)
    :condition (over all (on ?x ?s))
    :effect (at end (painted ?x))))
