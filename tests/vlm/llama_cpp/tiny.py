"""A tiny model that llama.cpp runs, with random weights: LLaVA's architecture in two GGUF files.

Nearly all that it says is yes or no, by what the picture and the words do to random weights, and
then it ends. Everything else is llama.cpp's own: reading pictures, prompts, tokens, grammars.
"""

from collections.abc import Callable, Iterator
from pathlib import Path

import gguf
import numpy as np
from numpy.typing import NDArray

WIDTH, INNER, HEADS = 32, 64, 2
SIDE, PATCH, LAYERS = 56, 14, 2
YES, NO = {"yes": 1.0, "▁Yes": 0.8}, {"no": -1.0, "▁No": -0.8}
WORDS = (*YES, *NO, "▁yes", "▁no", "unknown")
SAID, HEARD = 0, 1
"""The numbers that yes and no have, so that they end a reply, and that all else has."""
TEMPLATE = (
    "{% for message in messages %}{{ message['role'] }}: {{ message['content'] }}\n{% endfor %}"
    "{% if add_generation_prompt %}assistant:{% endif %}"
)
Weights = NDArray[np.float32]
Drawn = Callable[..., Weights]


def _vocabulary() -> Iterator[tuple[str, float, int]]:
    """Pieces as sentencepiece has them, with scores and kinds: bytes, letters, what joins them."""
    yield from (("<unk>", 0.0, 2), ("<s>", 0.0, 3), ("</s>", 0.0, 3))
    yield from ((f"<0x{byte:02X}>", 0.0, 6) for byte in range(256))
    letters = [*map(chr, range(33, 127)), "▁", "\n"]
    joined = [word[:end] for word in WORDS for end in range(2, len(word) + 1)]
    for piece in dict.fromkeys([*letters, *joined]):
        yield piece, float(len(piece) - 10), 1


def make(folder: Path, seed: int = 0) -> tuple[Path, Path]:
    """Write the model.

    Returns:
        The language model, and what puts pictures before it.
    """
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(seed)

    def drawn(scale: float, *shape: int) -> Weights:
        return random.normal(0, scale, shape).astype(np.float32)

    model, eyes = folder / "tiny.gguf", folder / "mmproj.gguf"
    _words(model, drawn)
    _eyes(eyes, drawn)
    return model, eyes


class _Writer(gguf.GGUFWriter):
    def done(self) -> None:
        self.write_header_to_file()
        self.write_kv_data_to_file()
        self.write_tensors_to_file()
        self.close()


def _words(file: Path, drawn: Drawn) -> None:
    pieces = list(_vocabulary())
    names = [name for name, _, _ in pieces]
    to = _Writer(str(file), "llama")
    to.add_name("tiny")
    to.add_context_length(4096)
    to.add_embedding_length(WIDTH)
    to.add_block_count(1)
    to.add_feed_forward_length(INNER)
    to.add_head_count(HEADS)
    to.add_head_count_kv(HEADS)
    to.add_layer_norm_rms_eps(1e-5)
    to.add_rope_dimension_count(WIDTH // HEADS)
    to.add_vocab_size(len(pieces))
    to.add_file_type(gguf.LlamaFileType.ALL_F32)
    to.add_tokenizer_model("llama")
    to.add_tokenizer_pre("default")
    to.add_token_list([name.encode() for name in names])
    to.add_token_scores([score for _, score, _ in pieces])
    to.add_token_types([kind for _, _, kind in pieces])
    to.add_bos_token_id(1)
    to.add_eos_token_id(2)
    to.add_unk_token_id(0)
    to.add_add_space_prefix(False)
    to.add_chat_template(TEMPLATE)

    heard, said = drawn(0.3, len(names), WIDTH), drawn(0.02, len(names), WIDTH)
    heard[:, SAID], said[:, SAID] = 0, -2
    heard[:, HEARD], said[:, HEARD] = 2, 0
    for word in (*YES, *NO, "▁yes", "▁no"):
        heard[names.index(word)] = 0
        heard[names.index(word), SAID] = 6
    leaning = drawn(0.4, WIDTH)
    for word, lean in (YES | NO).items():
        said[names.index(word)] = lean * leaning
        said[names.index(word), [SAID, HEARD]] = -2, 3
    said[2] = 0
    said[2, SAID] = 8
    to.add_tensor("token_embd.weight", heard)
    to.add_tensor("output_norm.weight", np.ones(WIDTH, np.float32))
    to.add_tensor("output.weight", said)
    for norm in ("attn_norm", "ffn_norm"):
        to.add_tensor(f"blk.0.{norm}.weight", np.ones(WIDTH, np.float32))
    for name, scale in (("q", 0.15), ("k", 0.15), ("v", 0.3)):
        to.add_tensor(f"blk.0.attn_{name}.weight", drawn(scale, WIDTH, WIDTH))
    back, down = drawn(0.3, WIDTH, WIDTH), drawn(0.1, WIDTH, INNER)
    back[[SAID, HEARD]] = down[[SAID, HEARD]] = 0
    to.add_tensor("blk.0.attn_output.weight", back)
    to.add_tensor("blk.0.ffn_down.weight", down)
    for name in ("gate", "up"):
        to.add_tensor(f"blk.0.ffn_{name}.weight", drawn(0.1, INNER, WIDTH))
    to.done()


def _eyes(file: Path, drawn: Drawn) -> None:
    to = _Writer(str(file), "clip")
    to.add_file_type(gguf.LlamaFileType.ALL_F32)
    to.add_bool("clip.has_vision_encoder", True)
    to.add_bool("clip.has_text_encoder", False)
    to.add_bool("clip.has_llava_projector", True)
    to.add_string("clip.projector_type", "mlp")
    to.add_bool("clip.use_gelu", False)
    sizes = {
        "image_size": SIDE,
        "patch_size": PATCH,
        "embedding_length": WIDTH,
        "feed_forward_length": INNER,
        "projection_dim": WIDTH,
        "block_count": LAYERS,
        "attention.head_count": HEADS,
    }
    for name, value in sizes.items():
        to.add_uint32(f"clip.vision.{name}", value)
    to.add_float32("clip.vision.attention.layer_norm_epsilon", 1e-5)
    to.add_array("clip.vision.image_mean", [0.5, 0.5, 0.5])
    to.add_array("clip.vision.image_std", [0.5, 0.5, 0.5])

    def layer(name: str, scale: float, out: int, into: int) -> None:
        to.add_tensor(f"{name}.weight", drawn(scale, out, into))
        to.add_tensor(f"{name}.bias", np.zeros(out, np.float32))

    def norm(name: str) -> None:
        to.add_tensor(f"{name}.weight", np.ones(WIDTH, np.float32))
        to.add_tensor(f"{name}.bias", np.zeros(WIDTH, np.float32))

    to.add_tensor("v.class_embd", drawn(1.0, WIDTH))
    to.add_tensor("v.patch_embd.weight", drawn(0.1, WIDTH, 3, PATCH, PATCH))
    to.add_tensor("v.position_embd.weight", drawn(0.1, (SIDE // PATCH) ** 2 + 1, WIDTH))
    norm("v.pre_ln")
    norm("v.post_ln")
    for at in range(LAYERS):
        for name in ("attn_q", "attn_k", "attn_v", "attn_out"):
            layer(f"v.blk.{at}.{name}", 0.2, WIDTH, WIDTH)
        norm(f"v.blk.{at}.ln1")
        norm(f"v.blk.{at}.ln2")
        layer(f"v.blk.{at}.ffn_up", 0.2, INNER, WIDTH)
        layer(f"v.blk.{at}.ffn_down", 0.2, WIDTH, INNER)
    layer("mm.0", 0.5, WIDTH, WIDTH)
    layer("mm.2", 0.5, WIDTH, WIDTH)
    to.done()
