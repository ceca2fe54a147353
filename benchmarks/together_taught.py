"""What asking together does to P(yes): `python -m benchmarks.together_taught [STEPS]`.

No hub is asked: a small chat model (LLaVA's architecture, some 400,000 weights) is made on the spot
and taught to answer about pictures of eight lamps, one question at a time and all of them in one
object of JSON. Then it is asked both ways about the same new pictures, as a server holds it to the
schema: between the answers all is given, and each answer is the likelier of yes and no, which the
next ones see. Lamps may be dim, so that nobody could be right about all of them.

What comes out is how much a reply in one piece costs where a model was taught both; real models
were taught otherwise.
"""

import random
import sys
import time
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
import transformers
from tokenizers import Tokenizer, models, pre_tokenizers
from torch import Tensor

LAMPS, SIDE, PATCH = 8, 48, 8
PICTURE = (SIDE // PATCH) ** 2
RATE = 1e-3
FORM = '{ " q1 q2 q3 q4 q5 q6 q7 q8 " : " yes no unknown , }'
WORDS = (
    "<pad> <unk> <s> </s> <image> is lamp 1 2 3 4 5 6 7 8 lit ? answer with one word yes no . , or "
    "every question in json each unknown by its key user assistant " + FORM
)


class Speech:
    """Words to numbers and back."""

    def __init__(self) -> None:
        vocabulary = {word: at for at, word in enumerate(dict.fromkeys(WORDS.split()))}
        made = Tokenizer(models.WordLevel(vocabulary, unk_token="<unk>"))
        made.pre_tokenizer = pre_tokenizers.WhitespaceSplit()
        self._made, self.size = made, len(vocabulary)
        self.yes, self.no = vocabulary["yes"], vocabulary["no"]
        self.image = vocabulary["<image>"]

    def __call__(self, text: str) -> list[int]:
        found: list[int] = self._made.encode(text).ids
        return found


def alone(lamp: int) -> str:
    """A prompt with one question."""
    return f"is lamp {lamp + 1} lit ? answer with one word , yes or no . assistant"


def together(order: Sequence[int]) -> str:
    """A prompt with all of them."""
    listed = " ".join(f"q{at + 1} : is lamp {lamp + 1} lit ?" for at, lamp in enumerate(order))
    return (
        f"{listed} answer every question in json , each with yes , no or unknown , by its key . "
        "assistant"
    )


def before(at: int) -> str:
    """What a reply in JSON says before its answer to a question."""
    return f'{"{" if at == 0 else ","} " q{at + 1} " : "'


def pictures(count: int, seed: int) -> tuple[Tensor, np.ndarray]:
    """Pictures, scaled to [-1, 1], and what is lit in each."""
    draw = np.random.default_rng(seed)
    lit = draw.random((count, LAMPS)) < 0.5
    found = draw.normal(0.35, 0.12, (count, 3, SIDE, SIDE))
    for at in range(LAMPS):
        row, column = 6 + 24 * (at // 4), 2 + 12 * (at % 4)
        bright = np.where(lit[:, at], 0.18, 0.0) + draw.normal(0, 0.07, count)
        found[:, :, row : row + 8, column : column + 8] += bright[:, None, None, None]
    return torch.tensor(found * 2 - 1, dtype=torch.float32).clamp(-1, 1), lit


def make(speech: Speech) -> Any:
    """The model, with random weights."""
    wide = {"hidden_size": 80, "intermediate_size": 160, "num_attention_heads": 4}
    config = transformers.LlavaConfig(
        vision_config={
            "model_type": "clip_vision_model",
            "image_size": SIDE,
            "patch_size": PATCH,
            "num_hidden_layers": 2,
            **wide,
        },
        text_config={
            "model_type": "llama",
            "vocab_size": speech.size,
            "num_hidden_layers": 3,
            "num_key_value_heads": 4,
            "max_position_embeddings": 512,
            **wide,
        },
        image_token_index=speech.image,
        image_token_id=speech.image,
        vision_feature_layer=-1,
        tie_word_embeddings=False,
    )
    return transformers.LlavaForConditionalGeneration(config)


def logits(model: Any, shown: Tensor, texts: Sequence[list[int]]) -> Tensor:
    """Of every token of prompts of one length."""
    ids = torch.tensor(texts)
    out: Tensor = model(pixel_values=shown, input_ids=ids, use_cache=False).logits
    return out


def teach(model: Any, speech: Speech, steps: int) -> None:
    """A third of the steps one question a time, else all together, in an order that is drawn."""
    optimizer = torch.optim.AdamW(model.parameters(), RATE, weight_decay=0.01)
    rate = torch.optim.lr_scheduler.OneCycleLR(optimizer, RATE, total_steps=steps, pct_start=0.1)
    draw, began = random.Random(0), time.monotonic()
    for step in range(steps):
        shown, lit = pictures(24 if step % 3 else 8, 1_000_000 + step)
        right = torch.tensor(np.where(lit, speech.yes, speech.no))
        order = draw.sample(range(LAMPS), LAMPS)
        if step % 3:
            texts, places = [], []
            for row in range(len(lit)):
                said = image() + speech(together(order))
                for at, lamp in enumerate(order):
                    said += speech(before(at))
                    places.append(len(said) - 1)
                    said += [int(right[row, lamp]), *speech('"')]
                texts.append(said)
            found = logits(model, shown, texts)[:, places[:LAMPS]]
            loss = torch.nn.functional.cross_entropy(
                found.reshape(-1, speech.size), right[:, order].reshape(-1)
            )
        else:
            each = [image() + speech(alone(lamp)) for _ in lit for lamp in range(LAMPS)]
            found = logits(model, shown.repeat_interleave(LAMPS, 0), each)[:, -1]
            loss = torch.nn.functional.cross_entropy(found, right.reshape(-1))
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(model.parameters(), 1.0)
        optimizer.step()
        rate.step()
        if step % 300 in (0, 1):
            print(f"step {step}: {loss.item():.3f}, {time.monotonic() - began:.0f} s", flush=True)


def image() -> list[int]:
    """The tokens that stand for the picture, and who speaks."""
    return Speech()("user " + "<image> " * PICTURE)


def asked_alone(model: Any, speech: Speech, shown: Tensor) -> np.ndarray:
    """P(yes) of pictures × lamps, each question by itself."""
    found = [
        p_yes(logits(model, shown, [image() + speech(alone(lamp))] * len(shown))[:, -1], speech)
        for lamp in range(LAMPS)
    ]
    return np.asarray(torch.stack(found, 1))


def asked_together(model: Any, speech: Speech, shown: Tensor) -> np.ndarray:
    """P(yes) of pictures × lamps, all in one reply."""
    said = [image() + speech(together(range(LAMPS))) for _ in shown]
    found = []
    for at in range(LAMPS):
        said = [each + speech(before(at)) for each in said]
        odds = p_yes(logits(model, shown, said)[:, -1], speech)
        found.append(odds)
        said = [
            [*each, speech.yes if p > 0.5 else speech.no, *speech('"')]
            for each, p in zip(said, odds.tolist(), strict=True)
        ]
    return np.asarray(torch.stack(found, 1))


def p_yes(of_token: Tensor, speech: Speech) -> Tensor:
    """As tpvqa reads it: yes / (yes + no)."""
    return of_token[:, [speech.yes, speech.no]].softmax(-1)[:, 0]


def told(name: str, p: np.ndarray, lit: np.ndarray) -> dict[str, float]:
    """Print what P(yes) is worth."""
    wrong = (p > 0.5) != lit
    clear = np.clip(p, 1e-6, 1 - 1e-6)
    loss = -np.where(lit, np.log(clear), np.log(1 - clear)).mean()
    order = np.argsort(p.ravel(), kind="stable")
    ranks = np.empty(order.size)
    ranks[order] = np.arange(1, order.size + 1)
    yes = lit.ravel()
    auroc = (ranks[yes].mean() - (yes.sum() + 1) / 2) / (~yes).sum()
    pairs = np.corrcoef(wrong.T.astype(float))[np.triu_indices(LAMPS, 1)]
    found = {
        "right": 1 - wrong.mean(),
        "AUROC": auroc,
        "log loss": loss,
        "errors of one picture correlate": np.nanmean(pairs),
    }
    print(f"{name}: " + ", ".join(f"{key} {value:.4f}" for key, value in found.items()))
    return found


def main() -> None:
    """Teach, ask both ways, print."""
    torch.manual_seed(0)
    speech = Speech()
    model = make(speech)
    print(f"{sum(each.numel() for each in model.parameters()):,} weights")
    teach(model, speech, int(sys.argv[1]) if len(sys.argv) > 1 else 12000)
    model.eval()
    shown, lit = pictures(1500, 7)
    both: dict[str, list[np.ndarray]] = {"alone": [], "together": []}
    with torch.no_grad():
        for part in shown.split(100):
            both["alone"].append(asked_alone(model, speech, part))
            both["together"].append(asked_together(model, speech, part))
    odds = {way: np.concatenate(found) for way, found in both.items()}
    each = {way: told(way, found, lit) for way, found in odds.items()}
    draw, differ = np.random.default_rng(0), []
    for _ in range(400):
        rows = draw.integers(0, len(lit), len(lit))
        right = {way: ((found > 0.5) == lit)[rows].mean() for way, found in odds.items()}
        differ.append(right["together"] - right["alone"])
    low, high = np.quantile(differ, (0.025, 0.975))
    print(
        f"together less alone, right: {each['together']['right'] - each['alone']['right']:+.4f} "
        f"({low:+.4f} to {high:+.4f}); the same word in "
        f"{((odds['alone'] > 0.5) == (odds['together'] > 0.5)).mean():.4f}"
    )


if __name__ == "__main__":
    main()
