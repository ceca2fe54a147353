"""Teach GG-CNN: `python -m tpvqa_robots.grasps.training.train SCENES RUN --steps 8000 --seed 1`.

Needs torch. Writes `RUN/ggcnn.pt` and a line of JSON per hundred steps into `RUN/log.jsonl`.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
from torch.utils.data import DataLoader, Dataset

from tpvqa_robots.grasps.training.examples import Scene, example, scenes_of
from tpvqa_robots.grasps.training.network import GgCnn, loss_of

BATCH, RATE = 8, 1e-3
"""As published: Adam with these."""
KEPT = 20
"""One of so many scenes is kept from training, to be looked at."""


class Examples(Dataset):
    """Scenes drawn at random, each time seen differently.

    Args:
        scenes: Of `examples.scenes_of`.
        seed: Of what is drawn.
        count: How many in all.
    """

    def __init__(self, scenes: Sequence[Scene], seed: int, count: int):
        self._scenes, self._seed, self._count = scenes, seed, count

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, number: int) -> tuple[torch.Tensor, torch.Tensor]:
        rng = np.random.default_rng([self._seed, number])
        depth, rows = self._scenes[int(rng.integers(len(self._scenes)))]
        image, wanted = example(depth, rows, rng)
        return torch.from_numpy(image.copy()), torch.from_numpy(wanted.copy())


def train(folder: Path, run: Path, steps: int, seed: int) -> None:
    """Teach for so many steps of `BATCH` examples.

    Args:
        folder: What `render` wrote.
        run: Where the weights go.
        steps: How many; the learning rate falls to a hundredth over them.
        seed: Of weights and examples. The same scenes, seed and count of threads give the same
            weights on the same machine.
    """
    run.mkdir(parents=True, exist_ok=True)
    torch.manual_seed(seed)
    scenes = scenes_of(folder)
    taught = [scene for i, scene in enumerate(scenes) if i % KEPT]
    kept = Examples(scenes[::KEPT], seed + 1, 96)
    held = torch.utils.data.default_collate([kept[i] for i in range(96)])
    net = GgCnn().to(memory_format=torch.channels_last)  # twice as fast on a processor
    adam = torch.optim.Adam(net.parameters(), RATE)
    loader = DataLoader(
        Examples(taught, seed, steps * BATCH), BATCH, num_workers=1, prefetch_factor=8
    )
    falling = torch.optim.lr_scheduler.ExponentialLR(adam, 0.01 ** (1 / steps))
    mean = 0.0
    with (run / "log.jsonl").open("w") as log:
        for step, (image, wanted) in enumerate(loader, 1):
            seen = image.contiguous(memory_format=torch.channels_last)
            loss = loss_of(net(seen), wanted)
            adam.zero_grad()
            loss.backward()
            adam.step()
            falling.step()
            mean += (loss.item() - mean) * (1 / step if step < 50 else 0.02)
            if step % 100 == 0:
                with torch.no_grad():
                    unseen = loss_of(net(held[0]), held[1]).item()
                line = {"step": step, "loss": round(mean, 5), "kept": round(unseen, 5)}
                print(json.dumps(line), file=log, flush=True)
                print(line, flush=True)
                torch.save(net.state_dict(), run / "ggcnn.pt")
    torch.save(net.state_dict(), run / "ggcnn.pt")
    told = {"scenes": len(taught), "steps": steps, "examples": steps * BATCH, "seed": seed}
    (run / "run.json").write_text(json.dumps(told))


def main() -> None:
    """The command."""
    words = argparse.ArgumentParser(description=__doc__)
    words.add_argument("scenes", type=Path)
    words.add_argument("run", type=Path)
    words.add_argument("--steps", type=int, default=8000)
    words.add_argument("--seed", type=int, default=1)
    said = words.parse_args()
    train(said.scenes, said.run, said.steps, said.seed)


if __name__ == "__main__":
    main()
