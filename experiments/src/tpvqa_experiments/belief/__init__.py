"""The belief monitor against votes and the paper's baselines."""

from tpvqa.bench.belief.bench import BeliefBench, run_belief_bench
from tpvqa.bench.belief.parts import Part
from tpvqa.bench.belief.results import BeliefResults

__all__ = ["BeliefBench", "BeliefResults", "Part", "run_belief_bench"]
