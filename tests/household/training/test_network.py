"""A tiny network made on the spot goes through export and gives the same answers."""

from pathlib import Path

import numpy as np
import pytest

from tpvqa_household.training.asking import Asking

torch = pytest.importorskip("torch", reason="training needs torch")
pytest.importorskip("onnx")


def test_an_exported_network_answers_as_torch_does(tmp_path: Path) -> None:
    from tpvqa_household.embedded.sessions import Sessions
    from tpvqa_household.embedded.weights import Weights
    from tpvqa_household.training.export import describe, export, rounded
    from tpvqa_household.training.network import Network
    from tpvqa_household.training.reference import logits

    torch.manual_seed(3)
    asking = Asking.about("clean_dishes")
    network = rounded(Network(len(asking.lexicon.vocabulary), width=16))
    export(network, tmp_path, longest=asking.lexicon.longest)
    describe(tmp_path, asking, temperature=1.0, trained={})
    sessions = Sessions(Weights.read(tmp_path), threads=1)
    rng = np.random.default_rng(0)
    pixels = rng.integers(0, 256, (224, 224, 3), dtype=np.uint8)
    tokens = np.zeros((3, asking.lexicon.longest), np.int64)
    for row, text in zip(tokens, asking.lexicon.questions, strict=False):
        found = asking.lexicon.tokens(text)
        assert isinstance(found, tuple)
        row[: len(found)] = found
    expected = logits(network, pixels, tokens).softmax(-1).numpy()
    ours = sessions.answer(sessions.encode(pixels), tokens).astype(np.float64)
    ours = np.exp(ours) / np.exp(ours).sum(-1, keepdims=True)
    np.testing.assert_allclose(ours, expected, atol=1e-3)


def test_the_folded_backbone_has_the_gradient_of_its_convolutions() -> None:
    import torch.nn.functional as F  # noqa: N812

    from tpvqa_household.training.backbone import Backbone

    torch.manual_seed(0)
    block = Backbone(frozen=0).blocks[11]  # strided, 5 × 5
    torch.nn.init.normal_(block.depthwise.weight)
    x = torch.randn(1, 112, 14, 14, requires_grad=True)
    block(x).square().sum().backward()
    ours, x.grad = x.grad.clone(), None
    h = F.relu6(block.expand(x))
    depthwise = block.depthwise
    h = F.conv2d(F.pad(h, (1, 2, 1, 2)), depthwise.weight, depthwise.bias, 2, 0, 1, 672)
    block.project(F.relu6(h)).square().sum().backward()
    torch.testing.assert_close(ours, x.grad)


def test_augmented_pictures_keep_their_shape_and_their_chance() -> None:
    from tpvqa_household.training.augment import augmented

    pixels = np.random.default_rng(0).integers(0, 256, (3, 224, 224, 3), dtype=np.uint8)
    one, two = (augmented(pixels, np.random.default_rng(7)) for _ in range(2))
    assert one.shape == (3, 3, 224, 224)
    assert torch.equal(one, two)
    assert float(one.min()) >= -1.0
    assert float(one.max()) <= 1.01
