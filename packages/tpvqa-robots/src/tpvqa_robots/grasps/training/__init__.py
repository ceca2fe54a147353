"""How GG-CNN was taught: things, depth images of them, grasps tried by physics, the training."""
