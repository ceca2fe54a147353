; Five blocks for the shipped domain blocksworld.
(define (problem blocks_5) (:domain blocksworld)
  (:objects red green blue yellow white_block - block
            c1 c2 c3 - column)
  (:init (on green c1) (on red green) (on white_block red)
         (on blue c2) (on yellow blue)
         (clear white_block) (clear yellow) (clear c3)
         (incolumn c1 c1) (incolumn c2 c2) (incolumn c3 c3)
         (incolumn green c1) (incolumn red c1) (incolumn white_block c1)
         (incolumn blue c2) (incolumn yellow c2))
  (:goal (and (on red blue) (on green red) (on yellow green) (on white_block yellow))))
