"""Tiny models of every family, with random weights, made on the spot and saved as real ones are.

python -m tests.vlm.hf.tiny FAMILY FOLDER    makes one that nearly always says yes or no
"""

import argparse
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import torch
import transformers
from tokenizers import Tokenizer, models, pre_tokenizers
from transformers import PreTrainedTokenizerFast
from transformers.models.blip.image_processing_pil_blip import BlipImageProcessorPil
from transformers.models.clip.image_processing_pil_clip import CLIPImageProcessorPil
from transformers.models.gemma3.image_processing_pil_gemma3 import Gemma3ImageProcessorPil
from transformers.models.got_ocr2.image_processing_pil_got_ocr2 import GotOcr2ImageProcessorPil
from transformers.models.idefics3.image_processing_pil_idefics3 import Idefics3ImageProcessorPil
from transformers.models.qwen2_vl.image_processing_pil_qwen2_vl import Qwen2VLImageProcessorPil
from transformers.models.siglip.image_processing_pil_siglip import SiglipImageProcessorPil
from transformers.models.smolvlm.image_processing_pil_smolvlm import SmolVLMImageProcessorPil
from transformers.models.vilt.image_processing_pil_vilt import ViltImageProcessorPil

from tpvqa.vlm.hf.processors import NO_VIDEOS, without_videos
from tpvqa.vlm.hf.quiet import quiet

Made = tuple[Any, Any]
_SAID = """is are the a left right both lamp lamps lit dark on it ? . , answer with one word user
assistant these 2 pictures show same moment from several views en yes Yes ▁yes ▁Yes no No ▁no ▁No
maybe picture grey"""
WORDS = tuple(_SAID.split())
SPECIAL = ("<pad>", "<unk>", "<s>", "</s>")
TEMPLATE = (
    "{% for message in messages %}{{ message['role'] }} {% for part in message['content'] %}"
    "{% if part['type'] == 'image' %}IMAGE {% else %}{{ part['text'] }} {% endif %}{% endfor %}"
    "{% endfor %}{% if add_generation_prompt %}assistant {% endif %}"
)


def tokenizer(*more: str, **named: str) -> Any:
    """Words and marks, lower case apart; what it does not know is <unk>."""
    vocabulary = {word: at for at, word in enumerate(dict.fromkeys((*SPECIAL, *WORDS)))}
    made = Tokenizer(models.WordLevel(vocabulary, unk_token="<unk>"))
    made.pre_tokenizer = pre_tokenizers.Whitespace()
    made.add_special_tokens([*SPECIAL, *named.values(), *more])
    return PreTrainedTokenizerFast(
        tokenizer_object=made,
        pad_token="<pad>",
        unk_token="<unk>",
        bos_token="<s>",
        eos_token="</s>",
        extra_special_tokens=named,
        model_input_names=["input_ids", "attention_mask"],
    )


def bert() -> Any:
    words = ["[PAD]", "[UNK]", "[CLS]", "[SEP]", "[MASK]", "[DEC]", *map(str.lower, WORDS)]
    vocabulary = {word: at for at, word in enumerate(dict.fromkeys(words))}
    return transformers.BertTokenizer(vocab=vocabulary)


def text(vocabulary: int, **more: Any) -> dict[str, Any]:
    return {
        "vocab_size": vocabulary,
        "hidden_size": 16,
        "intermediate_size": 32,
        "num_hidden_layers": 2,
        "num_attention_heads": 2,
        "num_key_value_heads": 1,
        "max_position_embeddings": 512,
        "pad_token_id": 0,
        "bos_token_id": 2,
        "eos_token_id": 3,
        "tie_word_embeddings": False,
        **more,
    }


def vision(**more: Any) -> dict[str, Any]:
    return {
        "hidden_size": 16,
        "intermediate_size": 32,
        "num_hidden_layers": 2,
        "num_attention_heads": 2,
        "image_size": 28,
        "patch_size": 14,
        **more,
    }


def vilt() -> Made:
    words = bert()
    config = transformers.ViltConfig(
        vocab_size=len(words),
        max_position_embeddings=64,
        **vision(image_size=32, patch_size=8),
        id2label={0: "no", 1: "yes", 2: "maybe"},
    )
    images = ViltImageProcessorPil(size={"shortest_edge": 32})
    return (
        transformers.ViltForQuestionAnswering(config),
        transformers.ViltProcessor(images, words),
    )


def blip() -> Made:
    words = bert()
    config = transformers.BlipConfig(
        text_config={
            "vocab_size": len(words),
            "hidden_size": 16,
            "encoder_hidden_size": 16,
            "intermediate_size": 32,
            "num_hidden_layers": 2,
            "num_attention_heads": 2,
            "max_position_embeddings": 64,
            "pad_token_id": 0,
            "bos_token_id": words.convert_tokens_to_ids("[DEC]"),
            "sep_token_id": words.sep_token_id,
        },
        vision_config=vision(patch_size=7),
    )
    images = BlipImageProcessorPil(size={"height": 28, "width": 28})
    return (
        transformers.BlipForQuestionAnswering(config),
        transformers.BlipProcessor(images, words),
    )


def _qwen(config: str, model: str, processor: str, **of_vision: Any) -> Made:
    words = tokenizer("<|vision_start|>", "<|vision_end|>", "<|image_pad|>", "<|video_pad|>")
    ids = {
        f"{name}_token_id": words.convert_tokens_to_ids(f"<|{token}|>")
        for name, token in (
            ("image", "image_pad"),
            ("video", "video_pad"),
            ("vision_start", "vision_start"),
            ("vision_end", "vision_end"),
        )
    }
    rope = {"rope_type": "default", "mrope_section": [1, 1, 2], "rope_theta": 10000.0}
    made = getattr(transformers, config)(
        text_config=text(len(words), rope_scaling=rope),
        vision_config={"depth": 2, "num_heads": 2, "patch_size": 14, **of_vision},
        tie_word_embeddings=False,
        **ids,
    )
    images = Qwen2VLImageProcessorPil(min_pixels=28 * 28, max_pixels=56 * 56)
    template = TEMPLATE.replace("IMAGE", "<|vision_start|><|image_pad|><|vision_end|>")
    kind = without_videos(getattr(transformers, processor))
    return getattr(transformers, model)(made), kind(images, words, NO_VIDEOS, template)


def qwen2_vl() -> Made:
    return _qwen(
        "Qwen2VLConfig",
        "Qwen2VLForConditionalGeneration",
        "Qwen2VLProcessor",
        embed_dim=16,
        hidden_size=16,
    )


def qwen2_5_vl() -> Made:
    return _qwen(
        "Qwen2_5_VLConfig",
        "Qwen2_5_VLForConditionalGeneration",
        "Qwen2_5_VLProcessor",
        hidden_size=16,
        out_hidden_size=16,
        intermediate_size=32,
        window_size=56,
        fullatt_block_indexes=[1],
    )


def _idefics(kind: str, images: Any, *videos: Any) -> Made:
    words = tokenizer("<fake_token_around_image>", "<image>", "<global-img>", "<end_of_utterance>")
    config = getattr(transformers, f"{kind}Config")(
        text_config={"model_type": "llama", **text(len(words))},
        vision_config=vision(patch_size=7),
        image_token_id=words.convert_tokens_to_ids("<image>"),
        scale_factor=2,
        tie_word_embeddings=False,
        pad_token_id=0,
    )
    images = images(
        size={"longest_edge": 28}, max_image_size={"longest_edge": 28}, do_image_splitting=False
    )
    made = getattr(transformers, f"{kind}Processor")
    processor = (without_videos(made) if videos else made)(
        images, words, *videos, image_seq_len=4, chat_template=TEMPLATE.replace("IMAGE", "<image>")
    )
    return getattr(transformers, f"{kind}ForConditionalGeneration")(config), processor


def idefics3() -> Made:
    return _idefics("Idefics3", Idefics3ImageProcessorPil)


def smolvlm() -> Made:
    return _idefics("SmolVLM", SmolVLMImageProcessorPil, NO_VIDEOS)


def llava() -> Made:
    words = tokenizer("<image>")
    config = transformers.LlavaConfig(
        vision_config={"model_type": "clip_vision_model", **vision()},
        text_config={"model_type": "llama", **text(len(words))},
        image_token_index=words.convert_tokens_to_ids("<image>"),
        image_token_id=words.convert_tokens_to_ids("<image>"),
        vision_feature_layer=-1,
        tie_word_embeddings=False,
    )
    processor = transformers.LlavaProcessor(
        CLIPImageProcessorPil(size={"shortest_edge": 28}, crop_size={"height": 28, "width": 28}),
        words,
        patch_size=14,
        vision_feature_select_strategy="default",
        num_additional_image_tokens=1,
        chat_template=TEMPLATE.replace("IMAGE", "<image>"),
    )
    return transformers.LlavaForConditionalGeneration(config), processor


def internvl() -> Made:
    words = tokenizer(
        start_image_token="<img>",
        end_image_token="</img>",
        context_image_token="<IMG_CONTEXT>",
        video_token="<video>",
    )
    config = transformers.InternVLConfig(
        vision_config=vision(image_size=[28, 28], patch_size=[7, 7]),
        text_config={"model_type": "qwen2", **text(len(words))},
        image_token_id=words.convert_tokens_to_ids("<IMG_CONTEXT>"),
        image_seq_length=4,
        tie_word_embeddings=False,
    )
    images = GotOcr2ImageProcessorPil(
        size={"height": 28, "width": 28}, crop_to_patches=False, max_patches=1
    )
    processor = without_videos(transformers.InternVLProcessor)(
        images,
        words,
        NO_VIDEOS,
        image_seq_length=4,
        chat_template=TEMPLATE.replace("IMAGE", "<IMG_CONTEXT>"),
    )
    return transformers.InternVLForConditionalGeneration(config), processor


def paligemma() -> Made:
    words = tokenizer("<image>")
    images = SiglipImageProcessorPil(size={"height": 28, "width": 28})
    images.image_seq_length = 4
    processor = transformers.PaliGemmaProcessor(images, words)
    config = transformers.PaliGemmaConfig(
        vision_config={"model_type": "siglip_vision_model", **vision(projection_dim=16)},
        text_config={"model_type": "gemma", **text(len(words), head_dim=8)},
        image_token_index=words.convert_tokens_to_ids("<image>"),
        image_token_id=words.convert_tokens_to_ids("<image>"),
        projection_dim=16,
        tie_word_embeddings=False,
    )
    return transformers.PaliGemmaForConditionalGeneration(config), processor


def gemma3() -> Made:
    words = tokenizer(
        boi_token="<start_of_image>", eoi_token="<end_of_image>", image_token="<image_soft_token>"
    )
    config = transformers.Gemma3Config(
        vision_config={"model_type": "siglip_vision_model", **vision()},
        text_config=text(len(words), head_dim=8, sliding_window=256),
        mm_tokens_per_image=4,
        image_token_id=words.image_token_id,
        image_token_index=words.image_token_id,
        boi_token_index=words.boi_token_id,
        eoi_token_index=words.eoi_token_id,
        tie_word_embeddings=False,
    )
    processor = transformers.Gemma3Processor(
        Gemma3ImageProcessorPil(size={"height": 28, "width": 28}),
        words,
        image_seq_length=4,
        chat_template=TEMPLATE.replace("IMAGE", "<start_of_image>"),
    )
    return transformers.Gemma3ForConditionalGeneration(config), processor


CHAT: dict[str, Callable[[], Made]] = {
    each.__name__: each
    for each in (
        qwen2_vl,
        qwen2_5_vl,
        idefics3,
        smolvlm,
        llava,
        internvl,
        paligemma,
        gemma3,
    )
}
ALL = {"vilt": vilt, "blip": blip} | CHAT


def save(family: str, folder: Path, *, seed: int = 0, outspoken: bool = False) -> Path:
    """Make a model and save it with its processor.

    Args:
        family: One of `ALL`.
        folder: Where.
        seed: Of its weights.
        outspoken: Whether it nearly always says yes or no; not for BLIP.
    """
    torch.manual_seed(seed)
    model, processor = ALL[family]()
    with torch.no_grad():
        for weights in model.parameters():  # as they are made, everything is nearly alike
            if weights.ndim > 1:
                weights.normal_(0, 0.25)
        if outspoken and family == "vilt":
            model.classifier[-1].bias[2] = -9
        elif outspoken:
            head = model.get_output_embeddings().weight
            number = processor.tokenizer.convert_tokens_to_ids
            head *= 0.05
            direction = torch.randn_like(head[0]) * 60
            for word, times in (("yes", 1.0), ("No", 0.9), ("▁no", -1.0), ("▁Yes", -0.9)):
                head[number(word)] = direction * times
    with quiet():
        model.save_pretrained(folder)
        if getattr(processor, "video_processor", None) is NO_VIDEOS:
            processor.tokenizer.save_pretrained(folder)
            processor.image_processor.save_pretrained(folder)
            described = {
                "processor_class": type(processor).__name__,
                **{k: 4 for k in ("image_seq_length", "image_seq_len") if hasattr(processor, k)},
            }
            (folder / "processor_config.json").write_text(json.dumps(described))
            (folder / "chat_template.jinja").write_text(processor.chat_template)
        else:
            processor.save_pretrained(folder)
    return folder


def main() -> None:
    """Make one for whoever has no hub."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("family", choices=sorted(ALL))
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=0, help="of its weights")
    given = parser.parse_args()
    if given.folder.exists():
        parser.error(f"{given.folder} is there already. Name another folder.")
    save(given.family, given.folder, seed=given.seed, outspoken=given.family != "blip")
    print(f"made {given.folder}: --vlm hf:{given.folder}")


if __name__ == "__main__":
    main()
