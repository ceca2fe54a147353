"""The belief monitor on others' domains, and where the world is not as the problem says."""

from tpvqa_experiments.abroad.bench import AbroadBench, run_abroad_bench
from tpvqa_experiments.abroad.parts import Part

__all__ = ["AbroadBench", "Part", "run_abroad_bench"]
