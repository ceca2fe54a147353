"""Rendered pictures + facts → the embedded network: render, train, export, evaluate.

Each step is a command, `python -m tpvqa_household.training.<step> --help`. Only `network`,
`backbone`, `augment`, `train`, `export` and what they use need torch (extra `train`).
"""
