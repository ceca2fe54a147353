"""Chat models that take pictures, of any architecture that the Auto classes know."""

import inspect
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from tpvqa.errors import AnswerError
from tpvqa.vlm.chat_completions import weighed
from tpvqa.vlm.hf.family import Asked, Loaded
from tpvqa.vlm.hf.prefix import SHARING, last_logits
from tpvqa.vlm.prompt import shipped_prompt
from tpvqa.vlm.reading import Reading
from tpvqa.vlm.reply_shape import read_words
from tpvqa.vlm.yes_no import Token, meaning

if TYPE_CHECKING:
    import torch

_MOST_WORDS = 12
"""Tokens of a reply whose first one says neither yes nor no."""
_UNTOLD: Mapping[str, str] = {
    "paligemma": "answer en {question}",
}
"""How models without a chat template are asked, by their architecture, as their makers say."""


class Chat:
    """Reads the probabilities of the first token of the reply, over all of the vocabulary.

    Args:
        loaded: A model for images and text to text, with its processor.

    Raises:
        AnswerError: How the model is asked is not known, or it has no token for yes or for no.
    """

    source = "logprobs"
    several = True

    def __init__(self, loaded: Loaded):
        self._loaded = loaded
        self._tokenizer = loaded.processor.tokenizer
        self._keeps = "logits_to_keep" in inspect.signature(loaded.model.forward).parameters
        if loaded.model.config.is_encoder_decoder:
            raise AnswerError(
                f"{loaded.name}: models that encode the question apart are not known."
            )
        self._shares = loaded.model.config.model_type in SHARING
        self._untold = _UNTOLD.get(loaded.model.config.model_type)
        if self._untold is None and not _has_template(loaded.processor):
            raise AnswerError(
                f"{loaded.name} has no chat template, so how it is asked is not known. Take the "
                "variant of it that was tuned to follow instructions."
            )
        self._words: dict[str, list[int]] = {"yes": [], "no": []}
        special = set(self._tokenizer.all_special_ids)
        for text, number in self._tokenizer.get_vocab().items():
            word = meaning(text)
            if word is not None and number not in special:
                self._words[word].append(number)
        if not all(self._words.values()):
            raise AnswerError(f"{loaded.name}: yes and no are not both tokens of its vocabulary.")

    def log_masses(self, asked: Sequence[Asked]) -> "torch.Tensor":
        """See `Family`.

        Prompts are padded on the right: what follows a prompt's end changes nothing before it, so
        that a question has the same answer in whatever company it is asked.
        """
        import torch

        inputs = self._inputs(asked)
        last = None
        if self._shares and not torch.is_grad_enabled() and _of_same_pictures(asked):
            last = last_logits(self._loaded.model, inputs)
        if last is None:
            last = self._plainly(inputs)
        logs = last.float().log_softmax(-1)
        return torch.stack([logs[:, self._words[w]].logsumexp(-1) for w in ("yes", "no")], -1)

    def _plainly(self, inputs: Mapping[str, "torch.Tensor"]) -> "torch.Tensor":
        """Logits after the last token of each prompt, each with its pictures."""
        import torch

        ends = inputs["attention_mask"].sum(-1) - 1
        kept, place = torch.unique(ends, return_inverse=True)
        if self._keeps:
            logits = self._loaded.model(**inputs, use_cache=False, logits_to_keep=kept).logits
        else:
            logits, place = self._loaded.model(**inputs, use_cache=False).logits, ends
        last: torch.Tensor = logits[torch.arange(len(ends), device=logits.device), place]
        return last

    def at_length(self, asked: Asked) -> Reading:
        """Let it speak on, and look for its answer there, as in a server's reply."""
        import torch

        inputs = self._inputs([asked])
        with torch.no_grad():
            done = self._loaded.model.generate(
                **inputs,
                do_sample=False,
                max_new_tokens=_MOST_WORDS,
                output_logits=True,
                return_dict_in_generate=True,
                pad_token_id=self._tokenizer.pad_token_id,
            )
        tokens = done.sequences[0, -len(done.logits) :].tolist()
        said = self._tokenizer.decode(tokens, skip_special_tokens=True).strip()
        cut = len(tokens) == _MOST_WORDS and tokens[-1] not in self._ends()
        word = read_words(said, asked.text, cut=cut)
        steps = zip(tokens, done.logits, strict=True)
        return weighed(word, said, [self._token(*each) for each in steps])

    def _token(self, number: int, logits: "torch.Tensor") -> Token:
        logs = logits[0].float().log_softmax(-1)
        known = [number, *self._words["yes"], *self._words["no"]]
        names = self._tokenizer.convert_ids_to_tokens(known)
        told = {name: float(logs[each]) for name, each in zip(names, known, strict=True)}
        return Token(names[0], told)

    def _ends(self) -> Sequence[int]:
        told = self._loaded.model.generation_config.eos_token_id
        return told if isinstance(told, list) else [told]

    def _inputs(self, asked: Sequence[Asked]) -> Any:
        loaded = self._loaded
        options = {"padding": True, "padding_side": "right"}
        if self._untold is not None:
            inputs = loaded.processor(
                images=[list(each.pictures) for each in asked],
                text=[self._untold_prompt(each) for each in asked],
                return_tensors="pt",
                **options,
            )
            inputs.pop("labels", None)
        else:
            inputs = loaded.processor.apply_chat_template(
                [self._conversation(each) for each in asked],
                add_generation_prompt=True,
                tokenize=True,
                return_dict=True,
                return_tensors="pt",
                processor_kwargs=options,
            )
        return inputs.to(loaded.device, loaded.model.dtype)

    def _untold_prompt(self, asked: Asked) -> str:
        token: str = self._loaded.processor.image_token
        return token * len(asked.pictures) + (self._untold or "").format(question=asked.text)

    def _conversation(self, asked: Asked) -> list[dict[str, Any]]:
        """One user message, as servers are sent it: the pictures, the question, how to answer."""
        content: list[dict[str, Any]] = [
            {"type": "image", "image": picture} for picture in asked.pictures
        ]
        text = shipped_prompt().one(asked.text, pictures=len(asked.pictures), before=0)
        content.append({"type": "text", "text": text})
        return [{"role": "user", "content": content}]


def _has_template(processor: Any) -> bool:
    tokenizer = processor.tokenizer
    return bool(
        getattr(processor, "chat_template", None) or getattr(tokenizer, "chat_template", None)
    )


def _of_same_pictures(asked: Sequence[Asked]) -> bool:
    first = [id(picture) for picture in asked[0].pictures]
    return len(asked) > 1 and all([id(p) for p in each.pictures] == first for each in asked)
