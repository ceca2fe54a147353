(define (problem clean_dishes)
  (:domain household)
  (:objects
    left right - hand
    plate - dish  bread - bread  apple - fruit  knife - knife
    table - table  counter - counter  floor - ground
    sink - sink  fridge - fridge  tv - tv)
  (:init
    (near tv) (free left) (free right)
    (on plate table) (on bread counter) (on apple fridge) (on knife counter)
    (= (total-cost) 0))
  (:goal (and (clean plate)))
  (:metric minimize (total-cost)))
