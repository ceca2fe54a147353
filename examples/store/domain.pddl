; A robot with a trolley in a shop: it loads goods at the dock and out of the cold store, weighs them,
; shelves them where they belong, and has the shelf's electronic label show the new price.
(define (domain store)
  (:requirements :strips :typing)
  (:types zone place slot good - object
          shelf pallet cold_store ground - place)
  (:predicates
    (robot_at ?z - zone)
    (next_to ?a - zone ?b - zone)
    (in_zone ?p - place ?z - zone)
    (scale_in ?z - zone)
    (belongs ?g - good ?p - shelf)
    (stands ?g - good ?p - place)
    (loaded ?g - good ?s - slot)
    (slot_free ?s - slot)
    (open ?c - cold_store)
    (closed ?c - cold_store)
    (weighed ?g - good)             ; what the scale has told the stock list
    (priced ?g - good))             ; what the label has been sent: it may show yesterday's price

  (:action drive
    :parameters (?from - zone ?to - zone)
    :precondition (and (robot_at ?from) (next_to ?from ?to))
    :effect (and (robot_at ?to) (not (robot_at ?from))))

  (:action load
    :parameters (?g - good ?p - pallet ?s - slot ?z - zone)
    :precondition (and (robot_at ?z) (in_zone ?p ?z) (stands ?g ?p) (slot_free ?s))
    :effect (and (loaded ?g ?s) (not (stands ?g ?p)) (not (slot_free ?s))))

  (:action pick_up
    :parameters (?g - good ?p - ground ?s - slot ?z - zone)
    :precondition (and (robot_at ?z) (in_zone ?p ?z) (stands ?g ?p) (slot_free ?s))
    :effect (and (loaded ?g ?s) (not (stands ?g ?p)) (not (slot_free ?s))))

  (:action take_back
    :parameters (?g - good ?p - shelf ?s - slot ?z - zone)
    :precondition (and (robot_at ?z) (in_zone ?p ?z) (stands ?g ?p) (slot_free ?s))
    :effect (and (loaded ?g ?s) (not (stands ?g ?p)) (not (slot_free ?s))))

  (:action open_door
    :parameters (?c - cold_store ?z - zone)
    :precondition (and (robot_at ?z) (in_zone ?c ?z) (closed ?c))
    :effect (and (open ?c) (not (closed ?c))))

  (:action close_door
    :parameters (?c - cold_store ?z - zone)
    :precondition (and (robot_at ?z) (in_zone ?c ?z) (open ?c))
    :effect (and (closed ?c) (not (open ?c))))

  (:action fetch
    :parameters (?g - good ?c - cold_store ?s - slot ?z - zone)
    :precondition (and (robot_at ?z) (in_zone ?c ?z) (open ?c) (stands ?g ?c) (slot_free ?s))
    :effect (and (loaded ?g ?s) (not (stands ?g ?c)) (not (slot_free ?s))))

  (:action weigh
    :parameters (?g - good ?s - slot ?z - zone)
    :precondition (and (robot_at ?z) (scale_in ?z) (loaded ?g ?s))
    :effect (weighed ?g))

  (:action shelve
    :parameters (?g - good ?s - slot ?p - shelf ?z - zone)
    :precondition (and (robot_at ?z) (in_zone ?p ?z) (belongs ?g ?p) (loaded ?g ?s) (weighed ?g))
    :effect (and (stands ?g ?p) (slot_free ?s) (not (loaded ?g ?s))))

  (:action price
    :parameters (?g - good ?p - shelf ?z - zone)
    :precondition (and (robot_at ?z) (in_zone ?p ?z) (belongs ?g ?p) (stands ?g ?p))
    :effect (priced ?g)))
