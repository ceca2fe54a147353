"""The visual question answering network: picture and question → yes, no or cannot see."""

import torch
import torch.nn.functional as F  # noqa: N812
from torch import Tensor, nn

from tpvqa_household.training.backbone import CHANNELS, Backbone

SIDE = 224
"""Side of the square picture in pixels."""


class ImageEncoder(nn.Module):
    """Picture → one map of features at 1/16 of its side, fused from four scales.

    Thin and pale things (a knife, dirt, a cut) vanish below 1/16, so the finer maps are folded in
    by strided convolutions instead of being pooled.
    """

    def __init__(self, *, width: int = 128, frozen: int = 3, backbone: Backbone | None = None):
        super().__init__()
        self.backbone = backbone if backbone is not None else Backbone(frozen=frozen)
        quarter, eighth, sixteenth, half = CHANNELS
        self.from_quarter = nn.Conv2d(quarter, width, 4, 4)
        self.from_eighth = nn.Conv2d(eighth, width, 2, 2)
        self.from_sixteenth = nn.Conv2d(sixteenth, width, 1)
        self.from_half = nn.Conv2d(half, width, 1)
        self.norm = nn.GroupNorm(8, width)
        self.place = nn.Parameter(torch.randn(1, width, SIDE // 16, SIDE // 16) * 0.02)

    def forward(self, x: Tensor) -> Tensor:
        """Normalised pictures, B × 3 × 224 × 224, to maps, B × width × 14 × 14."""
        quarter, eighth, sixteenth, half = self.backbone(x)
        h = (
            self.from_quarter(quarter)
            + self.from_eighth(eighth)
            + self.from_sixteenth(sixteenth)
            + F.interpolate(self.from_half(half), scale_factor=2.0, mode="nearest")
        )
        out: Tensor = self.norm(h.float()) + self.place
        return out.to(h.dtype)


class QuestionHead(nn.Module):
    """Map of a picture + tokens of questions → three logits a question: yes, no, cannot see.

    The question, read by a GRU, scales and shifts the map's channels (FiLM, Perez et al. 2018);
    attention then pools the map.
    """

    def __init__(self, words: int, *, width: int = 128, embedding: int = 64):
        super().__init__()
        self.width = width
        self.embed = nn.Embedding(words + 1, embedding, padding_idx=0)
        self.read = nn.GRU(embedding, width, batch_first=True)
        self.film = nn.Linear(width, 4 * width)
        self.mix = nn.Conv2d(width, width, 1)
        self.around = nn.Conv2d(width, width, 3, padding=1, groups=width)
        self.again = nn.Conv2d(width, width, 1)
        self.attend = nn.Conv2d(width, 2, 1)
        self.answer = nn.Sequential(
            nn.Linear(4 * width, width), nn.ReLU(), nn.Dropout(0.1), nn.Linear(width, 3)
        )

    def text(self, tokens: Tensor) -> Tensor:
        """Tokens, N × L with 0 for padding, to question vectors, N × width."""
        states, _ = self.read(self.embed(tokens))
        mask = (tokens > 0).to(states.dtype).unsqueeze(-1)
        out: Tensor = (states * mask).sum(1) / mask.sum(1).clamp(min=1.0)
        return out

    def forward(self, maps: Tensor, tokens: Tensor) -> Tensor:
        """Maps, N × width × 14 × 14, and their questions' tokens, N × L, to logits, N × 3."""
        question = self.text(tokens)
        film = self.film(question).to(maps.dtype)[:, :, None, None]
        scale1, shift1, scale2, shift2 = film.chunk(4, 1)
        h = F.relu((1 + scale1) * maps + shift1)
        h = h + F.relu(self.around(self.mix(h)))
        h = F.relu((1 + scale2) * self.again(h) + shift2)
        weights = self.attend(h).flatten(2).softmax(-1)
        flat = h.flatten(2)
        pooled = torch.einsum("ncp,nap->nac", flat, weights.to(flat.dtype)).flatten(1)
        features = torch.cat([pooled, flat.amax(-1), question.to(flat.dtype)], 1)
        out: Tensor = self.answer(features)
        return out


class Network(nn.Module):
    """Image encoder and question head together."""

    def __init__(
        self, words: int, *, width: int = 128, frozen: int = 3, backbone: Backbone | None = None
    ):
        super().__init__()
        self.image = ImageEncoder(width=width, frozen=frozen, backbone=backbone)
        self.head = QuestionHead(words, width=width)

    def forward(self, pictures: Tensor, tokens: Tensor) -> Tensor:
        """Pictures, B × 3 × 224 × 224, and tokens, B × Q × L, to logits, B × Q × 3."""
        batch, asked, length = tokens.shape
        maps = self.image(pictures)
        # Channels stay innermost in memory, or every convolution of the head would copy.
        rows = maps.permute(0, 2, 3, 1).unsqueeze(1).expand(-1, asked, -1, -1, -1)
        maps = rows.reshape(batch * asked, *rows.shape[2:]).permute(0, 3, 1, 2)
        out: Tensor = self.head(maps, tokens.reshape(batch * asked, length))
        return out.view(batch, asked, 3)


def normalise(pixels: Tensor) -> Tensor:
    """Pixels, 0 to 255, to what the backbone was trained on."""
    return (pixels.float() - 127.0) / 128.0
