(define (problem medicine_round)
  (:domain hospital)
  (:objects
    pharmacy bay_one bay_two utility - room
    cabinet - cabinet
    table_one table_two - table
    floor_pharmacy floor_one floor_two floor_utility - floor
    bin - bin
    tablets drops - medicine
    syringe - instrument)
  (:init
    (robot_at pharmacy)
    (in_room cabinet pharmacy) (in_room floor_pharmacy pharmacy)
    (in_room table_one bay_one) (in_room floor_one bay_one)
    (in_room table_two bay_two) (in_room floor_two bay_two)
    (in_room bin utility) (in_room floor_utility utility)
    (dispenser_in utility)
    (lies tablets cabinet) (lies drops cabinet) (lies syringe table_one)
    (gripper_free) (gripper_soiled)
    (shut cabinet) (locked cabinet)
    (not_scanned tablets) (not_scanned drops))
  (:goal (and
    (lies syringe bin)
    (lies tablets table_one) (lies drops table_two)
    (scanned tablets) (scanned drops)
    (shut cabinet) (locked cabinet))))
