"""The diffusers path, with a tiny pipeline made on the spot from random weights."""

import json
from pathlib import Path

import pytest

from tests.household.images.sources.images_server import picture
from tpvqa.errors import GeneratorError
from tpvqa_household.images.sources.diffusers_images import DiffusersImages
from tpvqa_household.images.sources.generator import Original
from tpvqa_household.images.sources.picture_file import read_picture

diffusers = pytest.importorskip("diffusers")
transformers = pytest.importorskip("transformers")
torch = pytest.importorskip("torch")

SIDE = 32


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A Stable Diffusion pipeline of a few thousand weights, saved in a folder."""
    folder = tmp_path_factory.mktemp("tiny")
    words = ["<|startoftext|>", "<|endoftext|>", *(f"{c}" for c in "abcdefghijklmnopqrstuvwxyz")]
    words += [f"{c}</w>" for c in "abcdefghijklmnopqrstuvwxyz"]
    (folder / "vocab.json").write_text(json.dumps({word: n for n, word in enumerate(words)}))
    (folder / "merges.txt").write_text("#version: 0.2\n")
    torch.manual_seed(0)
    text = transformers.CLIPTextConfig(
        vocab_size=len(words),
        hidden_size=16,
        intermediate_size=16,
        num_hidden_layers=1,
        num_attention_heads=2,
        max_position_embeddings=77,
        bos_token_id=0,
        eos_token_id=1,
        pad_token_id=1,
    )
    pipeline = diffusers.StableDiffusionPipeline(
        vae=diffusers.AutoencoderKL(
            block_out_channels=[8, 16],
            down_block_types=["DownEncoderBlock2D"] * 2,
            up_block_types=["UpDecoderBlock2D"] * 2,
            latent_channels=4,
            norm_num_groups=4,
        ),
        text_encoder=transformers.CLIPTextModel(text),
        tokenizer=transformers.CLIPTokenizer(
            str(folder / "vocab.json"), str(folder / "merges.txt"), model_max_length=77
        ),
        unet=diffusers.UNet2DConditionModel(
            sample_size=16,
            block_out_channels=(8, 16),
            layers_per_block=1,
            down_block_types=("DownBlock2D", "CrossAttnDownBlock2D"),
            up_block_types=("CrossAttnUpBlock2D", "UpBlock2D"),
            cross_attention_dim=16,
            attention_head_dim=2,
            norm_num_groups=4,
        ),
        scheduler=diffusers.DDIMScheduler(
            num_train_timesteps=20, steps_offset=1, clip_sample=False
        ),
        safety_checker=None,
        feature_extractor=None,
        requires_safety_checker=False,
    )
    pipeline.save_pretrained(folder / "saved")
    return folder / "saved"


def test_a_seed_decides_a_picture_from_a_prompt(tiny: Path) -> None:
    images = DiffusersImages(str(tiny), device="cpu", side=SIDE, steps=2)
    one = images.generate("a red apple", seed=1).data
    assert read_picture(one).size == (SIDE, SIDE)
    assert images.generate("a red apple", seed=1).data == one
    assert images.generate("a red apple", seed=2).data != one
    images.close()
    again = DiffusersImages(str(tiny), device="cpu", side=SIDE, steps=2)
    assert again.generate("a red apple", seed=1).data == one


def test_a_variation_depends_on_its_original(tiny: Path) -> None:
    images = DiffusersImages(str(tiny), device="cpu", side=SIDE, steps=4, strength=0.5)
    dark, bright = (Original(picture(n), "a plate") for n in (0, 4))
    one = images.vary(dark, seed=1).data
    assert read_picture(one).size == (SIDE, SIDE)
    assert images.vary(dark, seed=1).data == one
    assert images.vary(dark, seed=2).data != one
    assert images.vary(bright, seed=1).data != one
    assert images.generate("a plate", seed=1).data != one, "the same weights serve both"


def test_a_folder_without_a_pipeline_is_named(tmp_path: Path) -> None:
    with pytest.raises(GeneratorError, match="this folder holds no pipeline"):
        DiffusersImages(str(tmp_path)).generate("a plate", seed=1)
