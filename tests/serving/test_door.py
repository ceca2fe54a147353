"""Which pages in a browser on this machine are answered."""

import pytest

from tests.serving.running import Known, body, complete, picture, running

FRIDGE = body("Is the fridge open?", picture())
KEY = "a-token-for-the-tests"
CROSS_SITE = {"Sec-Fetch-Site": "cross-site"}


@pytest.mark.parametrize(
    ("headers", "token", "status"),
    [
        ({}, None, 200),
        ({"Content-Type": "Application/JSON; charset=utf-8"}, None, 200),
        ({"Origin": "http://localhost:3000", "Sec-Fetch-Site": "same-site"}, None, 200),
        ({"Origin": "https://evil.example"}, None, 403),
        ({"Origin": "https://localhost.evil.example"}, None, 403),
        ({"Origin": "http://["}, None, 403),
        ({"Origin": "null"}, None, 403),
        (CROSS_SITE, None, 403),
        ({"Content-Type": "text/plain;charset=UTF-8"}, None, 415),
        ({"Content-Type": "application/x-www-form-urlencoded"}, None, 415),
        ({"Content-Type": ""}, None, 415),
        ({"Origin": "https://page.example", "Content-Type": "text/plain", **CROSS_SITE}, KEY, 200),
    ],
)
def test_without_a_token_pages_of_other_sites_are_refused(
    headers: dict[str, str], token: str | None, status: int
) -> None:
    known = {} if token is None else {"Authorization": f"Bearer {token}"}
    vlm = Known({"Is the fridge open?": 0.9})
    with running(vlm, token=token) as serving:
        said = complete(serving, FRIDGE, **known, **headers)
        assert said.status == status
        if status == 200:
            assert said.word == "yes"
        else:
            assert said.error["code"] in ("foreign_origin", "unsupported_media_type")
            assert not vlm.calls
        large = complete(serving, b" " * 2**21, **known, **headers)
        assert large.status == (400 if status == 200 else status)
