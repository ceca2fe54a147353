; Eight blocks for the shipped domain blocksworld.
(define (problem blocks_8) (:domain blocksworld)
  (:objects red green blue yellow white_block black_block brown_block pink_block - block
            c1 c2 c3 c4 - column)
  (:init (on green c1) (on red green) (on white_block red)
         (on blue c2) (on yellow blue) (on pink_block yellow)
         (on brown_block c3) (on black_block brown_block)
         (clear white_block) (clear pink_block) (clear black_block) (clear c4)
         (incolumn c1 c1) (incolumn c2 c2) (incolumn c3 c3) (incolumn c4 c4)
         (incolumn green c1) (incolumn red c1) (incolumn white_block c1)
         (incolumn blue c2) (incolumn yellow c2) (incolumn pink_block c2)
         (incolumn brown_block c3) (incolumn black_block c3))
  (:goal (and (on red blue) (on green red) (on yellow green)
              (on black_block white_block) (on pink_block black_block))))
