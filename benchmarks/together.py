"""What asking a step's questions together costs: `python -m benchmarks.together`.

The client asks a server of its own over HTTP, the embedded network behind `tpvqa serve-vlm`, about
pictures that nobody has seen before, eight questions a picture: one request for each question, and
all in one. Both ways ask about the same pictures, in turn. Requests, bytes and seconds are counted,
and whether P(yes) is the same.

Tokens are those of a real VLM, Pixtral 12B, whose tokenizer the package mistral-common brings
(Apache-2.0; `pip install mistral-common`); without it they are left out. Those of a reply are of
the one word, and of the object in JSON.
"""

import argparse
import json
import statistics
import time
from collections.abc import Sequence
from typing import Any

from benchmarks.network import QUESTIONS
from benchmarks.serving import Served, new_pictures
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Way
from tpvqa.vlm.chat_completions import Inquiry, messages
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM
from tpvqa.vlm.prompt import shipped_prompt

WIDTHS = (224, 640, 1024)


def main() -> None:
    """Print both ways side by side, for several sizes of pictures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pictures", type=int, default=60)
    given = parser.parse_args()
    questions = [FactQuestion(text, Way.EFFECT, Atom("asked")) for text in QUESTIONS]
    for width in WIDTHS:
        pictures = new_pictures(given.pictures, width, 0)
        with Served() as served:
            _compare(served.url, pictures, questions, width)
        _tokens(pictures[0], width)


def _compare(
    url: str, pictures: Sequence[bytes], questions: Sequence[FactQuestion], width: int
) -> None:
    vlms = {
        way: OpenAICompatibleVLM("embedded", base_url=url, together=way == "together")
        for way in ("alone", "together")
    }
    taken: dict[str, list[float]] = {way: [] for way in vlms}
    told: dict[str, list[float | None]] = {way: [] for way in vlms}
    for number, picture in enumerate(pictures):
        # What the server kept of a picture must help neither way: each has its own half.
        way = ("alone", "together")[number % 2]
        seen = Observation(number, 0.0, {"front": Frame(f"{number}", "front", picture)})
        began = time.perf_counter()
        vlms[way].ask(seen, questions)
        taken[way].append(time.perf_counter() - began)
    for number, picture in enumerate(pictures):
        seen = Observation(number, 0.0, {"front": Frame(f"{number}", "front", picture)})
        for way, vlm in vlms.items():
            told[way] += [answer.p_yes for answer in vlm.ask(seen, questions)]
    pairs = list(zip(told["alone"], told["together"], strict=True))
    most = max(abs(a - b) for a, b in pairs if a is not None and b is not None)
    differ = sum((a is None) != (b is None) for a, b in pairs)
    print(f"pictures of {width} × {width}, {len(questions)} questions each:")
    for way, vlm in vlms.items():
        requests = vlm.usage.requests / (len(pictures) + len(taken[way]))
        seconds = statistics.median(taken[way][1:])  # the first connects
        print(f"  {way}: {requests:.2f} requests a picture, {1000 * seconds:.1f} ms at the median")
        vlm.close()
    print(f"  P(yes): {len(pairs)} answers, {differ} read one way alone, differs by {most:.1g}")


def _tokens(picture: bytes, width: int) -> None:
    try:
        from mistral_common.protocol.instruct.request import ChatCompletionRequest
        from mistral_common.tokens.tokenizers.mistral import MistralTokenizer
    except ImportError:
        print("  tokens: mistral-common is not installed")
        return
    tokenizer = MistralTokenizer.v3(is_tekken=True, is_mm=True)

    def prompt(texts: Sequence[str], *, together: bool) -> int:
        frame = Frame("a", "front", picture)
        said: Any = messages(Inquiry(tuple(texts), (frame,), together=together), shipped_prompt())
        request: Any = ChatCompletionRequest(messages=said)
        return len(tokenizer.encode_chat_completion(request).tokens)

    def spoken(text: str) -> int:
        return len(tokenizer.instruct_tokenizer.tokenizer.encode(text, bos=False, eos=True))

    alone = sum(prompt([text], together=False) for text in QUESTIONS)
    reply = json.dumps({f"q{at}": "no" for at in range(1, len(QUESTIONS) + 1)})
    print(
        f"  tokens of Pixtral 12B: alone {alone} and {len(QUESTIONS) * spoken('no')} of the reply, "
        f"together {prompt(QUESTIONS, together=True)} and {spoken(reply)}"
    )


if __name__ == "__main__":
    main()
