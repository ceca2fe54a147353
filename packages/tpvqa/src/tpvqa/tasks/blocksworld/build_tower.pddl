(define (problem build_tower) (:domain blocksworld)
  (:objects red green blue yellow - block
            c1 c2 c3 - column)
  (:init (on green c1) (on red green) (on blue c2) (on yellow c3)
         (clear red) (clear blue) (clear yellow)
         (incolumn c1 c1) (incolumn c2 c2) (incolumn c3 c3)
         (incolumn green c1) (incolumn red c1) (incolumn blue c2) (incolumn yellow c3))
  (:goal (and (on green blue) (on yellow green) (on red yellow))))
