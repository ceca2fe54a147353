"""Train the embedded network: `python -m tpvqa_household.training.train --help`.

Writes a checkpoint every few minutes and goes on from it when started again. With --follow it
takes in pictures while another process still renders them.
"""

import argparse
import json
import math
import os
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F  # noqa: N812
from torch import Tensor, nn

from tpvqa.errors import TpvqaError
from tpvqa_household.training.asking import Asking
from tpvqa_household.training.augment import augmented
from tpvqa_household.training.backbone import pretrained
from tpvqa_household.training.data import Pictures
from tpvqa_household.training.memory import keep_memory
from tpvqa_household.training.network import Network
from tpvqa_household.training.recipe import DEFAULT, Recipe
from tpvqa_household.training.sampling import Sampler
from tpvqa_household.training.validate import validate

_SAVE_EVERY = 180.0
_FEWEST = 1000


@dataclass
class Progress:
    """How far a run has come."""

    step: int = 0
    seconds: float = 0.0
    pictures: int = 0


class Run:
    """One training run and what it needs to go on after a stop.

    Args:
        recipe: All settings.
        folder: Where checkpoints and the log go.
        words: How many words the lexicon has.
        threads: Of the CPU.
    """

    def __init__(self, recipe: Recipe, folder: Path, words: int, *, threads: int):
        torch.set_num_threads(threads)
        torch.manual_seed(recipe.seed)
        keep_memory()
        self.recipe, self.folder = recipe, folder
        folder.mkdir(parents=True, exist_ok=True)
        backbone = pretrained(frozen=recipe.frozen_blocks)
        net = Network(words, width=recipe.width, backbone=backbone)
        self.net = net.to(memory_format=torch.channels_last)
        self.average = {k: v.clone().float() for k, v in net.state_dict().items()}
        self.optimizer = torch.optim.AdamW(
            list(_groups(net, recipe)), weight_decay=recipe.weight_decay
        )
        self.progress = Progress()

    @property
    def _checkpoint(self) -> Path:
        return self.folder / "checkpoint.pt"

    def save(self) -> None:
        """Write the checkpoint; a stop in between leaves the one before."""
        fresh = self._checkpoint.with_suffix(".tmp")
        torch.save(
            {
                "net": self.net.state_dict(),
                "average": self.average,
                "optimizer": self.optimizer.state_dict(),
                "progress": asdict(self.progress),
                "recipe": asdict(self.recipe),
            },
            fresh,
        )
        os.replace(fresh, self._checkpoint)

    def resume(self) -> bool:
        """Go on from the checkpoint, if there is one."""
        if not self._checkpoint.exists():
            return False
        data = torch.load(self._checkpoint, map_location="cpu")
        self.net.load_state_dict(data["net"])
        self.average = data["average"]
        self.optimizer.load_state_dict(data["optimizer"])
        self.progress = Progress(**data["progress"])
        return True

    def rate(self, done: float) -> float:
        """The learning rate as a part of its peak: a warm-up, then half a cosine."""
        warm = min(1.0, (self.progress.step + 1) / self.recipe.warm_up)
        return warm * (0.5 * (1 + math.cos(math.pi * min(done, 1.0))) + 0.005)

    def step(self, pictures: Tensor, tokens: Tensor, answers: Tensor, *, done: float) -> float:
        """One step of training; its loss."""
        for group in self.optimizer.param_groups:
            group["lr"] = group["peak"] * self.rate(done)
        self.net.train()
        with torch.autocast("cpu", torch.bfloat16):
            logits = self.net(pictures, tokens).float()
        loss = F.cross_entropy(
            logits.flatten(0, 1),
            answers.flatten(),
            ignore_index=-1,
            label_smoothing=self.recipe.smoothing,
        )
        self.optimizer.zero_grad(set_to_none=True)
        loss.backward()
        trained = [p for g in self.optimizer.param_groups for p in g["params"]]
        nn.utils.clip_grad_norm_(trained, 2.0)
        self.optimizer.step()
        self.progress.step += 1
        self.progress.pictures += len(pictures)
        self._move_average()
        return float(loss.detach())

    def _move_average(self) -> None:
        keep = min(self.recipe.average, (1 + self.progress.step) / (10 + self.progress.step))
        with torch.no_grad():
            for name, value in self.net.named_parameters():
                if value.requires_grad:
                    self.average[name].lerp_(value.float(), 1 - keep)

    def averaged(self) -> Network:
        """A copy of the network with the averaged weights, for judging and for export."""
        words, width = self.net.head.embed.num_embeddings - 1, self.recipe.width
        net = Network(words, width=width, frozen=self.recipe.frozen_blocks)
        net.load_state_dict(self.average)
        return net.eval()


def _groups(net: Network, recipe: Recipe) -> Iterator[dict[str, object]]:
    """Parameters by learning rate. The folded layers of the backbone differ much in size, so each
    gets a rate in proportion to its own."""
    head = []
    for name, parameter in net.named_parameters():
        if not parameter.requires_grad:
            continue
        if not name.startswith("image.backbone."):
            head.append(parameter)
            continue
        size = float(parameter.detach().square().mean().sqrt())
        rate = recipe.head_rate * recipe.backbone_rate * max(size, 1e-3)
        yield {"params": [parameter], "peak": rate, "lr": 0.0, "weight_decay": 0.0}
    yield {"params": head, "peak": recipe.head_rate, "lr": 0.0}


def train(
    run: Run,
    asking: Asking,
    pictures: Pictures,
    checks: dict[str, Pictures],
    *,
    minutes: float | None,
    follow: bool,
) -> None:
    """Train until the recipe's steps or the minutes are over."""
    recipe, log = run.recipe, run.folder / "log.jsonl"
    while pictures.refresh() < _FEWEST and follow:
        time.sleep(5)
    if not len(pictures):
        raise TpvqaError("There are no pictures; render some first.")
    sampler = Sampler(asking.subjects, asking.lexicon, pictures.labels, per_share=recipe.per_share)
    began = time.perf_counter() - run.progress.seconds
    saved = time.perf_counter()
    losses: list[float] = []

    def note(**values: object) -> None:
        line = json.dumps({"step": run.progress.step, **values})
        print(line, flush=True)
        with log.open("a", encoding="utf-8") as file:
            file.write(line + "\n")

    order = np.zeros(0, np.int64)
    while True:
        elapsed = time.perf_counter() - began
        done = run.progress.step / recipe.steps
        if minutes is not None:
            done = max(done, elapsed / (60 * minutes))
        if done >= 1:
            break
        rng = np.random.default_rng([recipe.seed, run.progress.step])
        if len(order) < recipe.batch:
            if follow and pictures.refresh() > len(sampler):
                sampler = Sampler(
                    asking.subjects, asking.lexicon, pictures.labels, per_share=recipe.per_share
                )
            order = rng.permutation(len(pictures))
        batch, order = order[: recipe.batch], order[recipe.batch :]
        asked = sampler.draw(batch, rng)
        losses.append(
            run.step(
                augmented(pictures.pixels(batch), rng),
                torch.from_numpy(asked.tokens),
                torch.from_numpy(asked.answers),
                done=done,
            )
        )
        run.progress.seconds = time.perf_counter() - began
        if run.progress.step % 50 == 0:
            note(
                loss=round(float(np.mean(losses[-50:])), 4),
                seconds=round(run.progress.seconds),
                pictures=len(pictures),
                epochs=round(run.progress.pictures / len(pictures), 2),
            )
        if time.perf_counter() - saved > _SAVE_EVERY:
            run.save()
            saved = time.perf_counter()
        if run.progress.step % 500 == 0:
            _check(run, asking, checks, note)
    run.save()
    _check(run, asking, checks, note)


def _check(
    run: Run, asking: Asking, checks: dict[str, Pictures], note: Callable[..., None]
) -> None:
    net = run.averaged()
    for name, pictures in checks.items():
        if pictures.refresh():
            note(check=name, **validate(net, asking, pictures))


def main(arguments: Sequence[str] | None = None) -> int:
    """Train, or go on training."""
    parser = argparse.ArgumentParser(
        prog="python -m tpvqa_household.training.train", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("pictures", type=Path, help="the folder that `render` filled")
    parser.add_argument("out", type=Path, help="where checkpoints and the log go")
    parser.add_argument("--recipe", type=Path, default=DEFAULT)
    parser.add_argument("--steps", type=int, default=None, help="instead of the recipe's")
    parser.add_argument("--minutes", type=float, default=None, help="end after this long at most")
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--follow", action="store_true", help="take in pictures as they come")
    parser.add_argument("--start", type=Path, default=None, help="weights of another checkpoint")
    chosen = parser.parse_args(arguments)
    try:
        recipe = Recipe.read(chosen.recipe, steps=chosen.steps)
        asking = Asking.about(recipe.task)
        run = Run(recipe, chosen.out, len(asking.lexicon.vocabulary), threads=chosen.threads)
        if run.resume():
            print(f"going on from step {run.progress.step}", flush=True)
        elif chosen.start is not None:
            data = torch.load(chosen.start, map_location="cpu")
            run.net.load_state_dict(data["average"])
            run.average = data["average"]
        below = range(recipe.validation_from)
        above = range(recipe.validation_from, 1_000_000)
        about = (asking.subjects, asking.actions)
        train(
            run,
            asking,
            Pictures(chosen.pictures, "train", *about, seeds=below),
            {
                "known": Pictures(chosen.pictures, "train", *about, seeds=above),
                "never seen": Pictures(chosen.pictures, "held_out", *about, seeds=above),
            },
            minutes=chosen.minutes,
            follow=chosen.follow,
        )
    except TpvqaError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
