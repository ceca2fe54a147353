; A robot on a hospital ward: it clears away used instruments, cleans its gripper, and brings
; medicines from a locked cabinet to patients' tables, each scanned before it is handed over.
(define (domain hospital)
  (:requirements :strips :typing)
  (:types room spot item - object
          cabinet table floor bin - spot
          medicine instrument - item)
  (:predicates
    (robot_at ?r - room)
    (in_room ?s - spot ?r - room)
    (dispenser_in ?r - room)
    (lies ?i - item ?s - spot)
    (holding ?i - item)
    (gripper_free)
    (opened ?c - cabinet)
    (shut ?c - cabinet)
    (locked ?c - cabinet)           ; a bolt that no camera shows
    (unlocked ?c - cabinet)
    (gripper_clean)                 ; nor germs
    (gripper_soiled)
    (scanned ?m - medicine)         ; nor what the ward's computer knows
    (not_scanned ?m - medicine))

  (:action go
    :parameters (?from - room ?to - room)
    :precondition (robot_at ?from)
    :effect (and (robot_at ?to) (not (robot_at ?from))))

  (:action collect
    :parameters (?i - instrument ?s - table ?r - room)
    :precondition (and (robot_at ?r) (in_room ?s ?r) (lies ?i ?s) (gripper_free))
    :effect (and (holding ?i) (gripper_soiled)
                 (not (lies ?i ?s)) (not (gripper_free)) (not (gripper_clean))))

  (:action collect_from_floor
    :parameters (?i - instrument ?f - floor ?r - room)
    :precondition (and (robot_at ?r) (in_room ?f ?r) (lies ?i ?f) (gripper_free))
    :effect (and (holding ?i) (gripper_soiled)
                 (not (lies ?i ?f)) (not (gripper_free)) (not (gripper_clean))))

  (:action throw_away
    :parameters (?i - instrument ?b - bin ?r - room)
    :precondition (and (robot_at ?r) (in_room ?b ?r) (holding ?i))
    :effect (and (lies ?i ?b) (gripper_free) (not (holding ?i))))

  (:action clean_gripper
    :parameters (?r - room)
    :precondition (and (robot_at ?r) (dispenser_in ?r) (gripper_free) (gripper_soiled))
    :effect (and (gripper_clean) (not (gripper_soiled))))

  (:action unlock
    :parameters (?c - cabinet ?r - room)
    :precondition (and (robot_at ?r) (in_room ?c ?r) (shut ?c) (locked ?c))
    :effect (and (unlocked ?c) (not (locked ?c))))

  (:action open
    :parameters (?c - cabinet ?r - room)
    :precondition (and (robot_at ?r) (in_room ?c ?r) (shut ?c) (unlocked ?c) (gripper_free))
    :effect (and (opened ?c) (not (shut ?c))))

  (:action close
    :parameters (?c - cabinet ?r - room)
    :precondition (and (robot_at ?r) (in_room ?c ?r) (opened ?c) (gripper_free))
    :effect (and (shut ?c) (not (opened ?c))))

  (:action lock
    :parameters (?c - cabinet ?r - room)
    :precondition (and (robot_at ?r) (in_room ?c ?r) (shut ?c) (unlocked ?c))
    :effect (and (locked ?c) (not (unlocked ?c))))

  (:action take
    :parameters (?m - medicine ?c - cabinet ?r - room)
    :precondition (and (robot_at ?r) (in_room ?c ?r) (opened ?c) (lies ?m ?c) (gripper_free)
                       (gripper_clean))
    :effect (and (holding ?m) (not (lies ?m ?c)) (not (gripper_free))))

  (:action pick_up
    :parameters (?m - medicine ?f - floor ?r - room)
    :precondition (and (robot_at ?r) (in_room ?f ?r) (lies ?m ?f) (gripper_free) (gripper_clean))
    :effect (and (holding ?m) (not (lies ?m ?f)) (not (gripper_free))))

  (:action scan
    :parameters (?m - medicine)
    :precondition (and (holding ?m) (not_scanned ?m))
    :effect (and (scanned ?m) (not (not_scanned ?m))))

  (:action hand_over
    :parameters (?m - medicine ?t - table ?r - room)
    :precondition (and (robot_at ?r) (in_room ?t ?r) (holding ?m) (scanned ?m))
    :effect (and (lies ?m ?t) (gripper_free) (not (holding ?m)))))
