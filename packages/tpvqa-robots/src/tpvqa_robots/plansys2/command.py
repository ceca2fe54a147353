"""`tpvqa plansys2-performer`: do actions for PlanSys2."""

from collections.abc import Sequence
from typing import Annotated

import typer

from tpvqa.cli.options import trial_config, trial_layers, trial_options
from tpvqa.cli.plan import Problem, Task
from tpvqa.config.layers import Layer


def register(app: typer.Typer) -> None:
    """Add the command to the application."""
    app.command("plansys2-performer")(plansys2_performer)


@trial_options()
def plansys2_performer(
    task: Task = None,
    problem_file: Problem = None,
    *,
    layers: Sequence[Layer],
    name: Annotated[str, typer.Option(help="Of the performer and its node.")] = "tpvqa",
) -> None:
    """Do the actions of a task for PlanSys2 until Ctrl-C: look whether they may, act, look again.

    Takes what `tpvqa run` takes of task, world and VLM; PlanSys2 plans. Exit codes: 0 ended by
    SIGTERM, 2 bad input, 130 interrupted.
    """
    import signal

    from tpvqa import Trial
    from tpvqa_robots.plansys2.node import PerformerNode

    with Trial(trial_config(trial_layers(layers, task, problem_file))) as trial:
        trial.check()
        node = PerformerNode(trial, name=name, say=lambda text: print(text, flush=True))
        signal.signal(signal.SIGTERM, lambda *_: node.close())
        signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background ignores it
        print(f"{name} performs {trial.task.name} on actions_hub; Ctrl-C ends it.", flush=True)
        node.run()
