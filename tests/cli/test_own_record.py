"""What `tpvqa vlm compare` writes is a record: `--vlm recorded:FILE` errs by it in whole trials."""

from pathlib import Path

from tests.cli.conftest import Run
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS
from tests.training.conftest import make_lamp_set

OWN = ("--domain", DOMAIN, "--problem", PROBLEM, "--questions", QUESTIONS)


def test_a_vlm_that_was_compared_errs_so_in_whole_trials(tpvqa: Run, tmp_path: Path) -> None:
    lamps = make_lamp_set(tmp_path / "lamps", 6)
    compared = tpvqa("vlm", "compare", "oracle:0.9", "--pictures", lamps, *OWN, "--out", "found")
    assert compared[0] == 0
    code, said, _ = tpvqa("run", *OWN, "--vlm", "recorded:found/answers.csv", "--out", "trial")
    assert code in (0, 1)
    assert "recorded:found/answers.csv:lasting" in (tmp_path / "trial/episode.jsonl").read_text()
    assert "questions" in said
    code, _, error = tpvqa("run", *OWN, "--vlm", "recorded:found/none.csv", "--out", "other")
    assert code == 2
    assert "found/none.csv: cannot be read: there is no such table of answers" in error
    assert not (tmp_path / "other").exists()


def test_a_comparison_does_not_take_the_place_of_the_record(tpvqa: Run, tmp_path: Path) -> None:
    lamps = make_lamp_set(tmp_path / "lamps", 6)
    words = ("vlm", "compare", "--pictures", lamps, *OWN, "--out", "found")
    assert tpvqa(*words, "oracle:0.9")[0] == 0
    record = Path("found/answers.csv").read_bytes()
    code, _, error = tpvqa(*words, "recorded:found/answers.csv:fresh")
    assert (code, "found/answers.csv is read by this command" in error) == (2, True)
    assert Path("found/answers.csv").read_bytes() == record
