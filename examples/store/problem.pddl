(define (problem morning_delivery)
  (:domain store)
  (:objects
    dock hall bakery dairy - zone
    pallet - pallet
    cold_store - cold_store
    bakery_shelf canned_shelf dairy_shelf - shelf
    dock_floor hall_floor bakery_floor dairy_floor - ground
    front_slot rear_slot - slot
    bread beans milk - good)
  (:init
    (robot_at dock)
    (next_to dock hall) (next_to hall dock)
    (next_to hall bakery) (next_to bakery hall)
    (next_to hall dairy) (next_to dairy hall)
    (in_zone pallet dock) (in_zone cold_store dairy)
    (in_zone bakery_shelf bakery) (in_zone canned_shelf hall) (in_zone dairy_shelf dairy)
    (in_zone dock_floor dock) (in_zone hall_floor hall)
    (in_zone bakery_floor bakery) (in_zone dairy_floor dairy)
    (scale_in hall)
    (belongs bread bakery_shelf) (belongs beans canned_shelf) (belongs milk dairy_shelf)
    (stands bread pallet) (stands beans pallet) (stands milk cold_store)
    (slot_free front_slot) (slot_free rear_slot)
    (closed cold_store))
  (:goal (and
    (stands bread bakery_shelf) (stands beans canned_shelf) (stands milk dairy_shelf)
    (priced bread) (priced beans) (priced milk)
    (closed cold_store)
    (robot_at dock))))
