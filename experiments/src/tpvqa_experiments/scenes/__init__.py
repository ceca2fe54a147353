"""Whole scenes as real VLMs saw them: from one look at a picture, how is the world?

Every answer is of a real VLM about a real picture; there is no noise model. The arrangements of a
few blocks are enumerated here and nowhere else: the belief monitor's own states are made of a
task's mutex groups.
"""

from tpvqa_experiments.scenes.bench import ScenesBench, run_scenes_bench

__all__ = ["ScenesBench", "run_scenes_bench"]
