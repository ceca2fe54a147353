(define (problem sort_groceries)
  (:domain groceries)
  (:objects milk bread cereal can - thing
            big_bin milk_bin bread_bin cereal_bin can_bin - bin)
  (:init (in milk big_bin) (in bread big_bin) (in cereal big_bin) (in can big_bin) (hand_empty))
  (:goal (and (in milk milk_bin) (in bread bread_bin) (in cereal cereal_bin) (in can can_bin))))
