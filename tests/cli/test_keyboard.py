from __future__ import annotations

import contextlib
import os
import pty
import termios

import pytest

from zavis_bt.cli.keyboard import KEY_ESCAPE, KEY_OTHER, Keyboard, split_keys
from zavis_bt.cli.line_editor import LineEditor
from zavis_bt.errors import InputError


@pytest.mark.parametrize(
    ("data", "keys", "rest"),
    [
        (b"wa", ["w", "a"], b""),
        (b"\x1b[A\x1b[B\x1b[C\x1b[D", ["up", "down", "right", "left"], b""),
        (b"\x1bOA", ["up"], b""),
        (b"w\x1b[Aw", ["w", "up", "w"], b""),
        (b"\x1b[15~", [KEY_OTHER], b""),
        (b"\x1bw", [KEY_OTHER], b""),
        (b"w\x1b", ["w"], b"\x1b"),
        (b"\x1b[1;5", [], b"\x1b[1;5"),
        ("é".encode(), ["é"], b""),
        (b"\xff", ["\ufffd"], b""),
    ],
)
def test_bytes_become_keys_and_what_is_incomplete_waits(data, keys, rest):
    assert split_keys(data) == (keys, rest)


@pytest.fixture
def ends():
    ours, theirs = pty.openpty()
    yield ours, theirs
    for end in (ours, theirs):
        with contextlib.suppress(OSError):  # closed by the test
            os.close(end)


def test_keys_come_without_enter_and_the_terminal_is_restored(ends):
    ours, theirs = ends
    before = termios.tcgetattr(theirs)
    with Keyboard(theirs) as keyboard:
        assert termios.tcgetattr(theirs) != before
        os.write(ours, b"w")
        assert keyboard.pressed(5.0) == ["w"]
        assert keyboard.pressed() == []
    assert termios.tcgetattr(theirs) == before


def test_ctrl_z_and_ctrl_s_are_keys(ends):
    ours, theirs = ends
    with Keyboard(theirs) as keyboard:
        os.write(ours, b"\x1a\x13")
        assert keyboard.pressed(5.0) == ["\x1a", "\x13"]


def test_escape_is_escape_when_nothing_follows_and_a_sequence_may_come_in_pieces(ends):
    ours, theirs = ends
    with Keyboard(theirs) as keyboard:
        os.write(ours, b"\x1b")
        assert keyboard.pressed(5.0) == []
        assert keyboard.pressed(0.01) == [KEY_ESCAPE]
        os.write(ours, b"\x1b[")
        assert keyboard.pressed(5.0) == []
        os.write(ours, b"A")
        assert keyboard.pressed(5.0) == ["up"]


def test_a_terminal_that_is_closed_says_so(ends):
    ours, theirs = ends
    with Keyboard(theirs) as keyboard:
        os.close(ours)
        with pytest.raises(EOFError, match="closed"):
            keyboard.pressed(5.0)


def test_what_is_no_terminal_is_refused(tmp_path):
    with (tmp_path / "file").open("w") as file, pytest.raises(InputError, match="not a terminal"):
        Keyboard(file.fileno())


def typed(editor: LineEditor, keys: list[str]) -> list[str | None]:
    return [line for key in keys if (line := editor.press(key)) is not None]


def test_a_line_is_edited_with_backspace_and_cleared_with_escape():
    editor = LineEditor()
    assert typed(editor, [*"xx", KEY_ESCAPE, *"helo", "\x7f", *"p\x01", "left", "\n"]) == ["help"]
    assert editor.text == ""


def test_earlier_lines_come_back_with_the_arrows():
    editor = LineEditor()
    assert typed(editor, [*"one\n", *"two\n", *"two\n"]) == ["one", "two", "two"]
    typed(editor, ["up", "up", "up"])
    assert editor.text == "one"
    assert typed(editor, ["down", "\n"]) == ["two"]
    typed(editor, ["down"])
    assert editor.text == ""
