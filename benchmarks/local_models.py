"""How long models of real sizes take for a picture: `python -m benchmarks.local_models`.

No hub is asked: the models have the sizes of published ones and random weights, which take as long.
Each picture is new; all questions of a step are asked at once. For the chat model also what it
takes where every question brings the picture along.
"""

import argparse
import statistics
import time

import torch
import transformers
from PIL import Image
from transformers.models.blip.image_processing_pil_blip import BlipImageProcessorPil
from transformers.models.idefics3.image_processing_pil_idefics3 import Idefics3ImageProcessorPil
from transformers.models.vilt.image_processing_pil_vilt import ViltImageProcessorPil

from tests.vlm.hf import tiny
from tpvqa.vlm.hf.family import Asked, Family, Loaded
from tpvqa.vlm.hf.loading import family_of

QUESTIONS = (
    "Is there a plate in the image?",
    "Is the plate in a robot's hand?",
    "Is the plate clean?",
    "Is the bread on the plate?",
    "Is there a fridge in the image?",
    "Is the fridge open?",
    "Is the TV turned on?",
    "Is the apple cut in half?",
)


def family(model: object, processor: object) -> Family:
    """A model as it would have been loaded."""
    return family_of(Loaded("model", model, processor, torch.device("cpu")))


def vilt() -> Family:
    """Of the size of ViLT-B/32."""
    words = tiny.bert()
    labels = {n: f"answer {n}" for n in range(3127)} | {3127: "yes", 3128: "no"}
    config = transformers.ViltConfig(id2label=labels)
    images = ViltImageProcessorPil(size={"shortest_edge": 384})
    model = transformers.ViltForQuestionAnswering(config).eval()
    return family(model, transformers.ViltProcessor(images, words))


def blip() -> Family:
    """Of the size of BLIP for VQA, base."""
    words = tiny.bert()
    config = transformers.BlipConfig(vision_config={"image_size": 384})
    config.text_config.bos_token_id = words.convert_tokens_to_ids("[DEC]")
    images = BlipImageProcessorPil(size={"height": 384, "width": 384})
    model = transformers.BlipForQuestionAnswering(config).eval()
    return family(model, transformers.BlipProcessor(images, words))


def smolvlm() -> Family:
    """Of the size of SmolVLM-256M: 512 × 512 pixels, 64 tokens a picture."""
    words = tiny.tokenizer(
        "<fake_token_around_image>", "<image>", "<global-img>", "<end_of_utterance>"
    )
    size = {"hidden_size": 576, "intermediate_size": 1536, "num_hidden_layers": 30}
    heads = {"num_attention_heads": 9, "num_key_value_heads": 3}
    text = {"model_type": "llama", **tiny.text(49280), **size, **heads}
    text["max_position_embeddings"] = 8192
    config = transformers.Idefics3Config(
        text_config=text,
        vision_config={
            "hidden_size": 768,
            "intermediate_size": 3072,
            "num_hidden_layers": 12,
            "num_attention_heads": 12,
            "image_size": 512,
            "patch_size": 16,
        },
        image_token_id=words.convert_tokens_to_ids("<image>"),
        scale_factor=4,
        tie_word_embeddings=False,
        pad_token_id=0,
    )
    edge = {"longest_edge": 512}
    images = Idefics3ImageProcessorPil(size=edge, max_image_size=edge, do_image_splitting=False)
    processor = transformers.Idefics3Processor(
        images,
        words,
        image_seq_len=64,
        chat_template=tiny.TEMPLATE.replace("IMAGE", "<image>"),
    )
    return family(transformers.Idefics3ForConditionalGeneration(config).eval(), processor)


def timed(asked: Family, pictures: int, *, apart: bool = False) -> float:
    """Seconds a picture, at the median; the first picture is not counted."""
    taken = []
    for number in range(pictures + 1):
        image = Image.effect_noise((640, 480), 20 + number).convert("RGB")
        # A copy beside every question is another picture: each goes through by itself.
        batch = [Asked((image.copy() if apart else image,), text) for text in QUESTIONS]
        began = time.perf_counter()
        with torch.no_grad():
            logs = asked.log_masses(batch)
        taken.append(time.perf_counter() - began)
        assert bool(torch.isfinite(logs).all())
    return statistics.median(taken[1:])


def main() -> None:
    """Print seconds a picture with eight questions."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pictures", type=int, default=5)
    makers = {each.__name__: each for each in (vilt, blip, smolvlm)}
    parser.add_argument("--models", nargs="+", choices=makers, default=list(makers))
    given = parser.parse_args()
    print(f"{torch.get_num_threads()} threads, {len(QUESTIONS)} questions a picture; seconds")
    for name in given.models:
        model = makers[name]()
        print(f"{name:10}{timed(model, given.pictures):8.2f}", flush=True)
        if name != "vilt":
            apart = timed(model, given.pictures, apart=True)
            print(f"{'':10}{apart:8.2f} where each question brings the picture along", flush=True)


if __name__ == "__main__":
    main()
