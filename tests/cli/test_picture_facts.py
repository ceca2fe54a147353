"""Labelled pictures whose facts are none of the domain: told by each command that reads them."""

from pathlib import Path

import pytest

from tests.cli.conftest import Run
from tests.lamps import DOMAIN, PROBLEM, QUESTIONS
from tests.training.conftest import make_lamp_set
from tpvqa.worlds.pictures import MANIFEST, digest

OWN = ("--domain", DOMAIN, "--problem", PROBLEM, "--questions", QUESTIONS)
TRAIN = ("train", "embedded", "--out", "taught", *OWN)
CALIBRATE = ("calibrate", "--vlm", "embedded", "--out", "calibration.json", "--force", *OWN)
COMPARE = ("vlm", "compare", "embedded", *OWN)


def spoilt(folder: Path, old: str, new: str) -> Path:
    lamps = make_lamp_set(folder, 6) / MANIFEST
    lamps.write_text(lamps.read_text().replace(old, new, 1))
    return folder


@pytest.mark.parametrize("command", [TRAIN, CALIBRATE, COMPARE])
@pytest.mark.parametrize(
    ("fact", "said"),
    [
        ("(litt left)", "there is no predicate 'litt'. Did you mean 'lit'?"),
        ("(shining left)", "there is no predicate 'shining'. Known:"),
        ("(lit left right)", "lit takes 1 arguments (lamp), got 2"),
    ],
)
def test_a_fact_that_the_domain_does_not_have_is_an_error_with_its_place(
    command: tuple[object, ...], fact: str, said: str, tpvqa: Run, tmp_path: Path
) -> None:
    lamps = spoilt(tmp_path / "lamps", "(lit left)", fact)
    code, _, error = tpvqa(*command, "--pictures", lamps)
    told = " ".join(error.split())
    assert code == 2
    assert f"{MANIFEST}: 0.png: {fact}: {said}" in told
    assert ".. " not in told
    assert "?. " not in told
    assert not (tmp_path / "taught").exists()


@pytest.mark.parametrize("command", [TRAIN, CALIBRATE, COMPARE])
def test_an_object_that_the_problem_does_not_have_is_told(
    command: tuple[object, ...], tpvqa: Run, tmp_path: Path
) -> None:
    lamps = spoilt(tmp_path / "lamps", '"(lit left)"', '"(lit lefft)"')
    _, _, error = tpvqa(*command, "--pictures", lamps)
    told = " ".join(error.split())
    assert (
        "note: lefft is no object of the problem. Did you mean 'left'? Facts about it, in 1" in told
    )


@pytest.mark.parametrize("command", [TRAIN, CALIBRATE, COMPARE])
def test_another_picture_than_the_manifests_is_refused(
    command: tuple[object, ...], tpvqa: Run, tmp_path: Path
) -> None:
    lamps = make_lamp_set(tmp_path / "lamps", 6)
    (lamps / "0.png").write_bytes((lamps / "1.png").read_bytes())
    code, _, error = tpvqa(*command, "--pictures", lamps)
    assert code == 2
    assert "0.png: its SHA-256 is not the manifest's" in " ".join(error.split())


@pytest.mark.parametrize("command", [TRAIN, CALIBRATE, COMPARE])
def test_a_set_of_another_domain_is_refused(
    command: tuple[object, ...], tpvqa: Run, tmp_path: Path
) -> None:
    lamps = spoilt(tmp_path / "lamps", '"lamps"', '"lanterns"')
    code, _, error = tpvqa(*command, "--pictures", lamps)
    assert code == 2
    assert "of the domain 'lanterns', and the task is of 'lamps'" in " ".join(error.split())


@pytest.mark.parametrize("command", [TRAIN, CALIBRATE, COMPARE])
def test_a_picture_in_which_nothing_is_to_be_seen_is_named(
    command: tuple[object, ...], tpvqa: Run, tmp_path: Path
) -> None:
    lamps = make_lamp_set(tmp_path / "lamps", 6)
    whole = (lamps / "0.png").read_bytes()
    (lamps / "0.png").write_bytes(whole[: len(whole) // 2])
    manifest = (lamps / MANIFEST).read_text()
    torn = digest((lamps / "0.png").read_bytes())
    (lamps / MANIFEST).write_text(manifest.replace(digest(whole), torn))
    _, _, error = tpvqa(*command, "--pictures", lamps)
    told = " ".join(error.split())
    assert "note: " in told
    assert "0.png: the picture is a damaged picture" in told
    assert "1.png" not in told
