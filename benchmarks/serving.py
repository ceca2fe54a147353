"""How many questions a second `tpvqa serve-vlm` answers: `python -m benchmarks.serving`.

A server of its own is started for every run, and asked over HTTP on this machine: robots side by
side, each with pictures that nobody has seen before, eight questions a picture, one question a
request, as tpvqa's own client asks. Every reply is read, and must be a word with probabilities.
Pictures are the shipped ones, each changed a little; they are encoded before time is taken. At the
end the client itself, `openai:embedded`, asks the same.

Processor time is the server's own, by /proc, and does not depend on what else the machine does.
"""

import argparse
import asyncio
import base64
import json
import os
import resource
import statistics
import subprocess
import sys
import time
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageEnhance

import tpvqa_household.images
from benchmarks.network import QUESTIONS
from tpvqa.observation import Frame, Observation
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Way
from tpvqa.vlm.openai_compatible import OpenAICompatibleVLM

PICTURES = Path(tpvqa_household.images.__file__).parent / "data"


def main() -> None:
    """Print every run, and medians."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pictures", type=int, default=200, help="a run")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--robots", type=int, default=4, help="that ask side by side")
    parser.add_argument("--at-once", type=int, default=4, help="requests of a robot under way")
    parser.add_argument("--width", type=int, default=224, help="of the pictures")
    given = parser.parse_args()
    print(
        f"{given.pictures} new pictures of {given.width} × {given.width}, {len(QUESTIONS)} "
        f"questions each, {given.robots} robots with {given.at_once} requests at once; load of "
        f"the machine {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores"
    )
    runs = [_run(given, number) for number in range(given.runs)]
    print("median of the runs:")
    _print({key: statistics.median(run[key] for run in runs) for key in runs[0]})
    taken = _client(given, given.runs)
    print(
        f"openai:embedded, one robot: {1000 * statistics.median(taken):.1f} ms a picture with "
        f"{len(QUESTIONS)} questions at the median, {1000 * float(np.percentile(taken, 95)):.1f} "
        "at 95 %"
    )


class Served:
    """A server in a process of its own."""

    def __enter__(self) -> "Served":
        words = ["-m", "tpvqa", "serve-vlm", "--port", "0", "--json"]
        self._process = subprocess.Popen(
            [sys.executable, *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self._process.stdout is not None
        self.url: str = json.loads(self._process.stdout.readline())["url"]
        return self

    def __exit__(self, *_: object) -> None:
        self._process.terminate()
        if self._process.wait(30) != 0:
            raise SystemExit("the server did not end cleanly")

    @property
    def processor(self) -> float:
        """Seconds of the processor that it took so far."""
        fields = Path(f"/proc/{self._process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def new_pictures(count: int, width: int, run: int) -> list[bytes]:
    """Shipped pictures, each changed a little, so that no two are the same."""
    files = sorted(PICTURES.rglob("*.jpg"))
    random = np.random.default_rng(run)
    found = []
    for number in range(count):
        picture = Image.open(files[number % len(files)]).convert("RGB")
        picture = picture.resize((width, width), Image.Resampling.BICUBIC)
        buffer = BytesIO()
        changed = ImageEnhance.Brightness(picture).enhance(random.uniform(0.9, 1.1))
        changed.save(buffer, "JPEG", quality=90)
        found.append(buffer.getvalue())
    assert len(set(found)) == len(found)
    return found


def _requests(url: str, picture: bytes) -> list[bytes]:
    """The requests about a picture, as they go over the wire."""
    host = url.removeprefix("http://").removesuffix("/v1")
    address = "data:image/jpeg;base64," + base64.b64encode(picture).decode()
    found = []
    for question in QUESTIONS:
        text = f"{question} Answer with one word, yes or no."
        content = [
            {"type": "image_url", "image_url": {"url": address}},
            {"type": "text", "text": text},
        ]
        body = json.dumps(
            {
                "model": "embedded",
                "messages": [{"role": "user", "content": content}],
                "logprobs": True,
                "top_logprobs": 20,
                "temperature": 0,
                "max_tokens": 12,
            }
        ).encode()
        head = (
            f"POST /v1/chat/completions HTTP/1.1\r\nHost: {host}\r\n"
            f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n"
        )
        found.append(head.encode() + body)
    return found


def _run(given: argparse.Namespace, number: int) -> dict[str, float]:
    with Served() as served:
        asked = [
            _requests(served.url, each)
            for each in new_pictures(given.pictures, given.width, number)
        ]
        server, own, began = served.processor, _own_processor(), time.perf_counter()
        taken = asyncio.run(_all_robots(served.url, asked, given))
        seconds = time.perf_counter() - began
        server, own = served.processor - server, _own_processor() - own
    questions = len(taken)
    run = {
        "questions a second": questions / seconds,
        "ms a reply at the median": 1000 * statistics.median(taken),
        "at 95 %": 1000 * float(np.percentile(taken, 95)),
        "ms of the processor a question, server": 1000 * server / questions,
        "load generator": 1000 * own / questions,
    }
    _print(run)
    return run


async def _all_robots(url: str, asked: list[list[bytes]], given: argparse.Namespace) -> list[float]:
    taken: list[float] = []
    robots = [
        _robot(url, asked[first :: given.robots], given.at_once, taken)
        for first in range(given.robots)
    ]
    await asyncio.gather(*robots)
    return taken


async def _robot(url: str, asked: list[list[bytes]], at_once: int, taken: list[float]) -> None:
    """Ask about one picture after the other, several questions at once."""
    host, port = url.removeprefix("http://").removesuffix("/v1").split(":")
    connections = [await asyncio.open_connection(host, int(port)) for _ in range(at_once)]

    async def some(
        reader: asyncio.StreamReader, writer: asyncio.StreamWriter, requests: list[bytes]
    ) -> None:
        for request in requests:
            began = time.perf_counter()
            writer.write(request)
            _check(await _reply(reader))
            taken.append(time.perf_counter() - began)

    for requests in asked:
        shares = [requests[first::at_once] for first in range(at_once)]
        pairs = zip(connections, shares, strict=True)
        await asyncio.gather(*(some(*connection, share) for connection, share in pairs))
    for _, writer in connections:
        writer.close()


async def _reply(reader: asyncio.StreamReader) -> dict[str, Any]:
    head = (await reader.readuntil(b"\r\n\r\n")).decode().lower()
    if not head.startswith("http/1.1 200"):
        raise SystemExit(head)
    length = int(head.partition("content-length:")[2].partition("\r\n")[0])
    found: dict[str, Any] = json.loads(await reader.readexactly(length))
    return found


def _check(reply: dict[str, Any]) -> None:
    choice = reply["choices"][0]
    said = choice["message"]["content"]
    listed = [each["token"] for each in choice["logprobs"]["content"][0]["top_logprobs"]]
    abstains = said == "unknown" and listed == ["unknown"]  # of a picture unlike those it knows
    if not abstains and (said not in ("yes", "no", "cannot see") or {"yes", "no"} - set(listed)):
        raise SystemExit(f"no answer: {choice}")


def _client(given: argparse.Namespace, number: int) -> list[float]:
    """Seconds for each picture, asked by tpvqa's own client."""
    questions = [FactQuestion(text, Way.EFFECT, Atom("asked")) for text in QUESTIONS]
    taken = []
    with Served() as served:
        vlm = OpenAICompatibleVLM("embedded", base_url=served.url)
        for look, picture in enumerate(new_pictures(given.pictures, given.width, number)):
            seen = Observation(look, 0.0, {"front": Frame(f"{look}", "front", picture)})
            began = time.perf_counter()
            answers = vlm.ask(seen, questions)
            taken.append(time.perf_counter() - began)
            assert {answer.source for answer in answers} <= {"logprobs", "word"}, answers
        vlm.close()
    return taken[1:]  # the first connects


def _own_processor() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def _print(run: dict[str, float]) -> None:
    print("; ".join(f"{key} {value:.2f}" for key, value in run.items()), flush=True)


if __name__ == "__main__":
    main()
