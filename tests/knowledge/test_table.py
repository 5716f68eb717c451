from __future__ import annotations

from pathlib import Path

import pytest

from zavis_bt.errors import InputError
from zavis_bt.knowledge import load_table
from zavis_bt.knowledge.table import CommonsenseTable, parse_table


@pytest.fixture(scope="module")
def table() -> CommonsenseTable:
    return load_table()


def test_built_in_table_covers_a_household(table: CommonsenseTable) -> None:
    assert len(table.objects) >= 160
    assert all(4 <= len(places) <= 10 for places in table.objects.values())


def test_built_in_table_is_sorted(table: CommonsenseTable) -> None:
    assert list(table.objects) == sorted(table.objects)


def test_every_name_of_the_table_is_found(table: CommonsenseTable) -> None:
    for name in (*table.objects, *table.places):
        assert table.find(name) == name
    for other, name in table.aliases.items():
        assert table.find(other) == name


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("red wallet", "wallet"),
        ("my small old red wallet with stripes", "wallet"),
        ("RemoteControl", "remote control"),
        ("the TV remote", "remote control"),
        ("CellPhone", "cell phone"),
        ("two books about robots", "book"),
        ("reading glasses", "glasses"),
        ("wine glasses", "wine glass"),
        ("a shoe", "shoes"),
        ("the mug on the desk", "mug"),
        ("something on the desk", "desk"),
        ("nightstand", "side table"),
        ("tv monitor", "tv stand"),
        ("quantum flux capacitor", None),
        ("", None),
    ],
)
def test_free_text_is_read_as_the_thing_it_names(table: CommonsenseTable, text: str, name: str | None) -> None:
    assert table.find(text) == name


def test_own_table_is_read(tmp_path: Path) -> None:
    path = tmp_path / "mine.txt"
    path.write_text("# mine\n\nFluxCapacitor: Garage, desk\ngarage = car port\n", encoding="utf-8")
    table = load_table(path)
    assert table.objects == {"flux capacitor": ("garage", "desk")}
    assert table.find("old flux capacitors") == "flux capacitor"
    assert table.find("car port") == "garage"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("book: desk\nbook: shelf", "t:2: object 'book' is listed twice"),
        ("book: desk, shelf, Desk", "t:1: 'desk' is listed twice"),
        ("book: desk,, shelf", "t:1: empty name"),
        ("book:", "t:1: empty name"),
        (": desk", "t:1: empty name"),
        ("\nbook desk", "t:2: 'book desk' is no entry"),
        ("# nothing", "t: no object"),
        ("book: desk\nbook = novel\ndesk = novel", "t:3: 'novel' already is another name of 'book'"),
        ("book: desk\n\ndesk = book", "t:3: 'book' is a name of its own"),
        ("book: desk\nbok = novel", r"t:2: no object or place is called 'bok' \(did you mean 'book'\?\)"),
    ],
)
def test_faulty_table_names_line_and_fault(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        parse_table(text, "t")


def test_unreadable_table_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"none\.txt: cannot be read as a commonsense table: No such file"):
        load_table(tmp_path / "none.txt")
    (tmp_path / "binary.txt").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not UTF-8"):
        load_table(tmp_path / "binary.txt")
