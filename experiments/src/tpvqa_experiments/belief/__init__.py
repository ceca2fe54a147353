"""The belief monitor against votes and the paper's baselines."""

from tpvqa_experiments.belief.bench import BeliefBench, run_belief_bench
from tpvqa_experiments.belief.parts import Part
from tpvqa_experiments.belief.results import BeliefResults

__all__ = ["BeliefBench", "BeliefResults", "Part", "run_belief_bench"]
