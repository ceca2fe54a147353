"""Rendered pictures + facts → the embedded network: render, train, export, evaluate.

Each step is a command, `python -m tpvqa.training.<step> --help`. Only `network`, `backbone`,
`augment`, `train` and `export` need torch (extra `train`).
"""
