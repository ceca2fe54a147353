"""`tpvqa serve-vlm`: a VLM behind an endpoint that speaks OpenAI's chat completions."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tpvqa.cli.options import pair
from tpvqa.cli.saying import tell

if TYPE_CHECKING:
    from tpvqa.serving.server import Serving
    from tpvqa.vlm.protocol import VLM

_EXIT = (
    "Exit codes: 0 ended by Ctrl-C or SIGTERM, with every request answered or told; 2 bad input, "
    "the VLM cannot be used, or the port is taken."
)
_REMEMBERED = 64
"""Pictures of which an embedded network keeps what it worked out."""


def register(app: typer.Typer) -> None:
    """Add the command."""
    app.command("serve-vlm", epilog=_EXIT)(serve_vlm)


def serve_vlm(
    *,
    vlm: Annotated[
        str | None, typer.Option(help="embedded (the default), or any VLM that looks at pictures.")
    ] = None,
    base_url: Annotated[
        str | None, typer.Option(help="With --vlm openai:MODEL: the address of that server.")
    ] = None,
    option: Annotated[
        list[str] | None, typer.Option(help="NAME=VALUE: more for the VLM. Can be repeated.")
    ] = None,
    name: Annotated[
        str | None, typer.Option(help="What clients call the model. Default: as --vlm does.")
    ] = None,
    host: Annotated[
        str, typer.Option(help="Where to listen. Others than this machine need a token.")
    ] = "127.0.0.1",
    port: Annotated[int, typer.Option(help="The port; 0 for a free one.", min=0, max=65535)] = 8000,
    token_file: Annotated[
        Path | None,
        typer.Option(
            help="A file that holds the token which clients give as their API key. Default: the "
            "environment variable TPVQA_SERVE_TOKEN."
        ),
    ] = None,
    waiting: Annotated[
        int,
        typer.Option(help="Questions that may wait at once; more are told to come back.", min=1),
    ] = 256,
    patience: Annotated[
        float, typer.Option(help="Seconds that a question waits at most.", min=0.1)
    ] = 60.0,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print address and model as a line of JSON.")
    ] = False,
) -> None:
    """Serve a VLM to OpenAI-compatible clients, until Ctrl-C.

    Ask it with --vlm openai:embedded --base-url http://127.0.0.1:8000/v1, or any such client.
    """
    import importlib.util

    from tpvqa.defaults import default_vlm
    from tpvqa.errors import MissingExtraError
    from tpvqa.plugins import see_free, see_taken
    from tpvqa.vlm.making import make_vlm

    for package in ("fastapi", "uvicorn"):
        if importlib.util.find_spec(package) is None:
            raise MissingExtraError(package, "serve", "tpvqa serve-vlm")

    from tpvqa.serving.app import Limits
    from tpvqa.serving.door import token_for
    from tpvqa.serving.server import Serving

    token = token_for(host, token_file)
    options = dict(map(pair, option or ()))
    context = {**options, "base_url": base_url, "remember": _REMEMBERED}
    see_free(options, context)
    spec = vlm or default_vlm()
    model, taken = make_vlm(spec, context)
    see_taken(options, taken, context)
    limits = Limits(waiting=waiting, patience=patience)
    with Serving(
        model, model=name or spec, host=host, port=port, token=token, limits=limits
    ) as serving:
        _try(model)
        serving.run(ready=lambda: _say_ready(serving, token=token, as_json=as_json))
        counts = serving.counts
        questions = "1 question" if counts.answered == 1 else f"{counts.answered} questions"
        calls = "1 call" if counts.calls == 1 else f"{counts.calls} calls"
        tell(
            f"ended: {questions} answered in {calls} of the VLM, "
            f"{counts.refused} refused, {counts.failed} failed, {counts.given_up} given up",
            error=True,
        )


def _try(vlm: "VLM") -> None:
    """See that the VLM can be asked at all; what it has to load is loaded then, too.

    Raises:
        TpvqaError: It cannot.
    """
    from tpvqa.observation import Observation
    from tpvqa.pddl import Atom
    from tpvqa.plugins import Checked
    from tpvqa.protocols import called_at
    from tpvqa.questions import FactQuestion, Way
    from tpvqa.vlm.checking import ask_checked
    from tpvqa.vlm.pictures import grey_frame

    if isinstance(vlm, Checked):
        called_at(f"check of {vlm.name}", vlm.check)
        return
    question = FactQuestion("Is there an apple in the image?", Way.PRECONDITION, Atom("asked"))
    ask_checked(vlm, Observation(frames={"front": grey_frame()}), [question])


def _say_ready(serving: "Serving", *, token: str | None, as_json: bool) -> None:
    if as_json:
        print(json.dumps({"url": serving.address, "model": serving.model}), flush=True)
    needs = "its clients need the token" if token else "for this machine alone"
    tell(f"serving {serving.model} at {serving.address}, {needs}. Ctrl-C ends it", error=True)
