; An arm at a bench that changes its tools: it clamps a housing, drills, deburrs and greases its bore,
; mounts a shaft and a lid, and screws the lid down.
(define (domain workshop)
  (:requirements :strips :typing)
  (:types part tool tray - object
          housing shaft lid screw - part
          gripper drill deburrer grease_gun screwdriver - tool)
  (:predicates
    (mounted ?t - tool)
    (racked ?t - tool)
    (flange_free)
    (lies ?p - part ?t - tray)
    (held ?p - part)
    (jaws_free)
    (clamped ?h - housing)
    (vice_free)
    (drilled ?h - housing)
    (deburred ?h - housing)            ; burrs are too small to be seen
    (greased ?h - housing)             ; grease lies deep in the bore
    (inserted ?s - shaft ?h - housing)
    (covers ?l - lid ?h - housing)
    (set_in ?w - screw ?l - lid)
    (tightened ?w - screw))            ; torque cannot be seen

  (:action mount_tool
    :parameters (?t - tool)
    :precondition (and (racked ?t) (flange_free))
    :effect (and (mounted ?t) (not (racked ?t)) (not (flange_free))))

  (:action rack_tool
    :parameters (?t - tool)
    :precondition (and (mounted ?t) (jaws_free))
    :effect (and (racked ?t) (flange_free) (not (mounted ?t))))

  (:action pick
    :parameters (?p - part ?tray - tray ?g - gripper)
    :precondition (and (mounted ?g) (jaws_free) (lies ?p ?tray))
    :effect (and (held ?p) (not (jaws_free)) (not (lies ?p ?tray))))

  (:action put_down
    :parameters (?p - part ?tray - tray ?g - gripper)
    :precondition (and (mounted ?g) (held ?p))
    :effect (and (lies ?p ?tray) (jaws_free) (not (held ?p))))

  (:action clamp
    :parameters (?h - housing ?g - gripper)
    :precondition (and (mounted ?g) (held ?h) (vice_free))
    :effect (and (clamped ?h) (jaws_free) (not (held ?h)) (not (vice_free))))

  (:action unclamp
    :parameters (?h - housing ?tray - tray ?g - gripper)
    :precondition (and (mounted ?g) (clamped ?h) (jaws_free))
    :effect (and (lies ?h ?tray) (vice_free) (not (clamped ?h))))

  (:action bore
    :parameters (?h - housing ?d - drill)
    :precondition (and (mounted ?d) (clamped ?h))
    :effect (drilled ?h))

  (:action deburr
    :parameters (?h - housing ?d - deburrer)
    :precondition (and (mounted ?d) (clamped ?h) (drilled ?h))
    :effect (deburred ?h))

  (:action grease
    :parameters (?h - housing ?g - grease_gun)
    :precondition (and (mounted ?g) (clamped ?h) (deburred ?h))
    :effect (greased ?h))

  (:action insert
    :parameters (?s - shaft ?h - housing ?g - gripper)
    :precondition (and (mounted ?g) (held ?s) (clamped ?h) (greased ?h))
    :effect (and (inserted ?s ?h) (jaws_free) (not (held ?s))))

  (:action cover
    :parameters (?l - lid ?h - housing ?s - shaft ?g - gripper)
    :precondition (and (mounted ?g) (held ?l) (clamped ?h) (inserted ?s ?h))
    :effect (and (covers ?l ?h) (jaws_free) (not (held ?l))))

  (:action set_screw
    :parameters (?w - screw ?l - lid ?h - housing ?g - gripper)
    :precondition (and (mounted ?g) (held ?w) (clamped ?h) (covers ?l ?h))
    :effect (and (set_in ?w ?l) (jaws_free) (not (held ?w))))

  (:action tighten
    :parameters (?w - screw ?l - lid ?h - housing ?d - screwdriver)
    :precondition (and (mounted ?d) (clamped ?h) (covers ?l ?h) (set_in ?w ?l))
    :effect (tightened ?w)))
