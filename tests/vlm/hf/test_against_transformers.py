"""Every family, answer by answer, against the plain call of transformers, question by question."""

import math
from pathlib import Path
from typing import Any

import pytest
import torch
import transformers
from PIL import Image

from tests.vlm.hf import tiny
from tests.vlm.hf.conftest import Saved, observation, picture
from tpvqa.pddl import Atom
from tpvqa.questions import FactQuestion, Way
from tpvqa.vlm import Reply
from tpvqa.vlm.hf.family import Asked
from tpvqa.vlm.hf.loading import family_of, load
from tpvqa.vlm.hf.prefix import SHARING
from tpvqa.vlm.hf.vlm import HuggingFaceVLM

TEXTS = (
    "Is the left lamp lit?",
    "Are both the lamps dark?",
    "Is a lamp lit?",
    "Is the right lit?",
)
YES, NO = ("yes", "Yes", "▁yes", "▁Yes"), ("no", "No", "▁no", "▁No")
TOLD = "Answer with one word, yes or no."
Pair = tuple[float, float]


def questions(*texts: str) -> list[FactQuestion]:
    return [FactQuestion(text, Way.PRECONDITION, Atom("asked")) for text in texts]


def of_vilt(folder: Path, image: Image.Image, text: str) -> Pair:
    model = transformers.ViltForQuestionAnswering.from_pretrained(folder).eval()
    processor = transformers.AutoProcessor.from_pretrained(folder)
    with torch.no_grad():
        logits = model(**processor(image, text, return_tensors="pt")).logits[0]
    chances = logits.softmax(-1)
    return float(chances[1]), float(chances[0])


def of_blip(folder: Path, image: Image.Image, text: str) -> Pair:
    """By the loss of the model itself: the mean of the logarithms, with smoothed labels undone."""
    model = transformers.BlipForQuestionAnswering.from_pretrained(folder).eval()
    processor = transformers.AutoProcessor.from_pretrained(folder)
    inputs = processor(images=image, text=text, return_tensors="pt")
    told = []
    for word in ("yes", "no"):
        number = processor.tokenizer.convert_tokens_to_ids(word)
        start = model.config.text_config.bos_token_id
        seen: dict[str, Any] = {}
        hook = model.text_decoder.register_forward_hook(
            lambda _module, _inputs, output, seen=seen: seen.update(logits=output.logits)
        )
        with torch.no_grad():
            model(**inputs, decoder_input_ids=torch.tensor([[start, number]]))
        hook.remove()
        logs = seen["logits"][0].log_softmax(-1)
        told.append(math.exp(logs[0, number] + logs[1, processor.tokenizer.sep_token_id]))
    return told[0], told[1]


def of_chat(family: str, folder: Path, images: list[Image.Image], text: str) -> Pair:
    """The first token, by `generate`."""
    _, processor = tiny.ALL[family]()
    model = transformers.AutoModelForImageTextToText.from_pretrained(folder).eval()
    if family == "paligemma":
        prompt = "<image>" * len(images) + f"answer en {text}"
        inputs = processor(images=[images], text=[prompt], return_tensors="pt")
        inputs.pop("labels")
    else:
        said = f"{text} {TOLD}"
        if len(images) > 1:
            said = f"These 2 pictures show the same moment from several views. {said}"
        content = [{"type": "image"}] * len(images) + [{"type": "text", "text": said}]
        prompt = processor.apply_chat_template(
            [{"role": "user", "content": content}], add_generation_prompt=True
        )
        inputs = processor(images=[images], text=[prompt], return_tensors="pt")
    done = model.generate(
        **inputs,
        max_new_tokens=1,
        do_sample=False,
        output_logits=True,
        return_dict_in_generate=True,
    )
    chances = done.logits[0][0].softmax(-1)
    yes, no = (
        sum(float(chances[processor.tokenizer.convert_tokens_to_ids(w)]) for w in words)
        for words in (YES, NO)
    )
    return yes, no


def plain(family: str, folder: Path, images: list[Image.Image], text: str) -> Pair:
    if family == "vilt":
        return of_vilt(folder, images[0], text)
    if family == "blip":
        return of_blip(folder, images[0], text)
    return of_chat(family, folder, images, text)


@pytest.mark.parametrize("family", tiny.ALL)
def test_probabilities_of_a_batch_are_those_of_the_plain_call(family: str, saved: Saved) -> None:
    folder = saved(family)
    asked_of = family_of(load(str(folder), device="cpu", dtype="float32"))
    pictures = (picture(), picture(left=False, right=True, size=48))
    asked = [Asked((image,), text) for image in pictures for text in TEXTS]
    told = asked_of.log_masses(asked).detach().exp()
    with torch.no_grad():  # where the architecture allows it, the picture goes through once
        halves = [asked_of.log_masses(asked[at : at + 4]).exp() for at in (0, 4)]
    torch.testing.assert_close(torch.cat(halves), told, rtol=2e-4, atol=1e-7)
    for each, pair in zip(asked, told.tolist(), strict=True):
        wanted = plain(family, folder, list(each.pictures), each.text)
        assert pair == pytest.approx(wanted, rel=2e-4, abs=1e-7), each.text
    assert len({round(math.log(yes), 4) for yes, _ in told.tolist()}) == len(
        told
    )  # it looks, and reads


@pytest.mark.parametrize("family", tiny.CHAT)
def test_answers_are_those_of_the_plain_call(family: str, saved: Saved) -> None:
    folder = saved(family, outspoken=True)
    vlm = HuggingFaceVLM(str(folder), device="cpu")
    replies = set()
    for image in (picture(), picture(left=False, size=20), picture(right=True, size=64)):
        for answer in vlm.ask(observation(image), questions(*TEXTS)):
            yes, no = plain(family, folder, [image], answer.question.text)
            if yes + no > 0.5:
                assert answer.p_yes == pytest.approx(yes / (yes + no), rel=1e-3)
                assert answer.leftover == pytest.approx(1 - yes - no, abs=2e-4)
                assert answer.source == "logprobs"
                assert answer.reply is (Reply.YES if yes > no else Reply.NO)
            replies.add(answer.reply)
    assert replies & {Reply.YES, Reply.NO}


@pytest.mark.parametrize("family", ["blip", *sorted(SHARING)])
def test_a_picture_goes_through_once_for_all_questions(family: str, saved: Saved) -> None:
    loaded = load(str(saved(family)), device="cpu", dtype="float32")
    asked_of, image, patches = family_of(loaded), picture(), []
    of_pictures = [
        module
        for name, module in loaded.model.named_modules()
        if name.rpartition(".")[2] in ("vision_model", "vision_tower", "visual")
    ]
    hook = of_pictures[0].register_forward_pre_hook(
        lambda _module, args, kwargs: patches.append(
            next(v for v in (*args, *kwargs.values()) if isinstance(v, torch.Tensor)).shape
        ),
        with_kwargs=True,
    )
    with torch.no_grad():
        asked_of.log_masses([Asked((image,), TEXTS[0])])
        asked_of.log_masses([Asked((image,), text) for text in TEXTS])
    hook.remove()
    one, four = patches
    assert one == four


@pytest.mark.parametrize("family", ["qwen2_vl", "idefics3", "gemma3", "internvl"])
def test_a_chat_model_sees_several_views_at_once(family: str, saved: Saved) -> None:
    folder = saved(family, outspoken=True)
    views = [picture(), picture(left=False, right=True)]
    vlm = HuggingFaceVLM(str(folder))
    for answer in vlm.ask(observation(*views), questions(*TEXTS[:2])):
        yes, no = plain(family, folder, views, answer.question.text)
        if yes + no > 0.5:
            assert answer.leftover == pytest.approx(1 - yes - no, abs=2e-4)
            assert answer.p_yes == pytest.approx(yes / (yes + no), rel=1e-3)


def test_a_model_of_one_picture_is_asked_about_each_view(saved: Saved) -> None:
    folder = saved("vilt")
    views = [picture(), picture(left=False, right=True)]
    (answer,) = HuggingFaceVLM(str(folder)).ask(observation(*views), questions(TEXTS[0]))
    pairs = [plain("vilt", folder, [view], TEXTS[0]) for view in views]
    odds = sum(math.log(yes / no) for yes, no in pairs if yes + no > 0.5)
    told = sum(yes + no > 0.5 for yes, no in pairs)
    assert told
    assert answer.p_yes == pytest.approx(1 / (1 + math.exp(-odds / told)), rel=1e-4)


@pytest.mark.parametrize("family", tiny.ALL)
def test_company_changes_no_answer(family: str, saved: Saved) -> None:
    """Of questions of other lengths in the batch, or in batches of another size."""
    folder, seen = saved(family, outspoken=family in tiny.CHAT), observation(picture())
    together = HuggingFaceVLM(str(folder)).ask(seen, questions(*TEXTS))
    by_twos = HuggingFaceVLM(str(folder), batch=2).ask(seen, questions(*TEXTS[::-1]))[::-1]
    for one, other in zip(together, by_twos, strict=True):
        assert one.reply is other.reply
        assert one.leftover == pytest.approx(other.leftover, abs=2e-4)


def test_the_same_question_about_the_same_picture_has_the_same_answer(saved: Saved) -> None:
    vlm, seen = HuggingFaceVLM(str(saved("vilt"))), observation(picture())
    first = vlm.ask(seen, questions(*TEXTS[:2]))
    again = vlm.ask(seen, questions(TEXTS[1], TEXTS[3], TEXTS[0], TEXTS[1]))
    assert [a.p_yes for a in (again[2], again[0], again[3])] == [
        first[0].p_yes,
        first[1].p_yes,
        first[1].p_yes,
    ]


def test_half_precision_is_said_and_done(saved: Saved) -> None:
    loaded: Any = load(str(saved("blip")), device="cpu", dtype="bfloat16")
    assert loaded.model.dtype is torch.bfloat16
    exact = family_of(load(str(saved("blip")), device="cpu", dtype="auto"))
    rough = family_of(loaded).log_masses([Asked((picture(),), TEXTS[0])])
    assert rough.dtype is torch.float32
    wanted = exact.log_masses([Asked((picture(),), TEXTS[0])])
    assert torch.allclose(rough, wanted, rtol=0.05)
    assert not torch.equal(rough, wanted)
