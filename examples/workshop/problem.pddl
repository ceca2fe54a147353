(define (problem gearbox)
  (:domain workshop)
  (:objects
    housing - housing
    shaft - shaft
    lid - lid
    screw_one screw_two - screw
    gripper - gripper
    drill - drill
    deburrer - deburrer
    grease_gun - grease_gun
    screwdriver - screwdriver
    parts_tray bench finished_tray - tray)
  (:init
    (racked gripper) (racked drill) (racked deburrer) (racked grease_gun) (racked screwdriver)
    (flange_free) (jaws_free) (vice_free)
    (lies housing parts_tray) (lies shaft parts_tray) (lies lid parts_tray)
    (lies screw_one parts_tray) (lies screw_two parts_tray))
  (:goal (and
    (inserted shaft housing) (covers lid housing)
    (set_in screw_one lid) (set_in screw_two lid)
    (tightened screw_one) (tightened screw_two)
    (lies housing finished_tray))))
