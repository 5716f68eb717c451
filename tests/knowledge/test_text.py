from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from zavis_bt.knowledge.text import normalise, phrases, singular


@pytest.mark.parametrize(
    ("written", "meant"),
    [
        ("RemoteControl", "remote control"),
        ("remote_control", "remote control"),
        ("  Remote-Control ", "remote control"),
        ("CD", "cd"),
        ("DVDPlayer", "dvd player"),
        ("TVStand", "tv stand"),
        ("iPod", "ipod"),
        ("MP3Player", "mp3 player"),
        ("ｍｕｇ", "mug"),
        ("", ""),
        (" _ - ", ""),
    ],
)
def test_spellings_come_to_one_form(written: str, meant: str) -> None:
    assert normalise(written) == meant


@given(st.text(max_size=400))
def test_normalised_text_stays_as_it_is(text: str) -> None:
    once = normalise(text)
    assert "  " not in once
    assert once == once.strip()
    assert singular(once) is not None
    assert phrases(once)[0] == once


@pytest.mark.parametrize(
    ("plural", "expected"),
    [("books", "book"), ("toothbrushes", "toothbrush"), ("batteries", "battery"), ("glass", "glass"), ("boxes", "box")],
)
def test_last_word_becomes_singular(plural: str, expected: str) -> None:
    assert singular(plural) == expected


def test_noun_phrase_loses_its_adjectives_before_its_description_counts() -> None:
    found = phrases("my red wallet with white stripes")
    assert found.index("red wallet") < found.index("wallet") < found.index("white stripes")
