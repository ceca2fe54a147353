"""How many pictures of an action's outcome are photos, variations and from prompts."""

from dataclasses import dataclass

from tpvqa.errors import PictureSetError

PARTS = ("photos", "variations", "prompts")


@dataclass(frozen=True, slots=True)
class Shares:
    """Percentages, by default the paper's (Experiments, "Simulator with Diffusion Models").

    Attributes:
        photos: Of photos.
        variations: Of variations of photos.
        prompts: Of pictures made from prompts alone.
    """

    photos: int = 20
    variations: int = 60
    prompts: int = 20

    @classmethod
    def parse(cls, text: str) -> "Shares":
        """Read "20,60,20".

        Raises:
            PictureSetError: It is not three percentages that make 100.
        """
        words = [word.strip() for word in text.split(",")]
        if len(words) != len(PARTS) or not all(word.isdecimal() for word in words):
            raise PictureSetError(
                f"{text!r} are no shares: write the percentages of {', '.join(PARTS)}, "
                "e.g. 20,60,20"
            )
        made = cls(*map(int, words))
        if sum(made.percentages) != 100:
            raise PictureSetError(
                f"The shares {text} make {sum(made.percentages)}% in all. They must make 100%"
            )
        return made

    @property
    def percentages(self) -> tuple[int, int, int]:
        """Of photos, variations, prompts."""
        return (self.photos, self.variations, self.prompts)

    def of(self, count: int) -> tuple[int, int, int]:
        """Whole numbers of photos, variations and prompts that make `count`.

        What is left over by rounding down goes to the largest remainders.
        """
        whole = [percent * count // 100 for percent in self.percentages]
        by_remainder = sorted(
            range(len(PARTS)), key=lambda part: -(self.percentages[part] * count % 100)
        )
        for part in by_remainder[: count - sum(whole)]:
            whole[part] += 1
        return (whole[0], whole[1], whole[2])
