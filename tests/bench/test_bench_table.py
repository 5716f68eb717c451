from __future__ import annotations

import io
from pathlib import Path

from bench_samples import result
from rich.console import Console

from zavis_bt.bench import EpisodeResult, print_summary, write_summary

RESULTS = [
    result(id=f"e{k}", method=method, success=k < wins, spl=0.5 * (k < wins), path_length=2.0 + k)
    for method, wins in (("zavis", 9), ("a|b", 2))
    for k in range(10)
]
CRASH = result(id="e9", method="zavis", seed=1, success=False, spl=0.0, reason="crash: [x] ValueError", details={})


def shown(results: list[EpisodeResult]) -> str:
    console = Console(file=io.StringIO(), width=80)
    print_summary(results, console)
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


def test_markdown_holds_every_method_and_the_paired_differences(tmp_path: Path) -> None:
    text = write_summary(RESULTS, tmp_path).read_text()
    assert "| zavis | bedroom | 10 | 90.0 [70.0, 100.0] | 0.4500 [0.3500, 0.5000] |" in text
    assert "| a\\|b | bedroom | 10 | 20.0" in text
    assert "## Difference to zavis" in text
    assert "| a\\|b | bedroom | 10 | -70.0 [-100.0, -40.0] * |" in text
    assert "+0.00 [+0.00, +0.00] |" in text
    assert "CRASH" not in text


def test_every_row_of_markdown_has_as_many_cells_as_its_header(tmp_path: Path) -> None:
    rows = [line for line in write_summary(RESULTS, tmp_path).read_text().splitlines() if line.startswith("|")]
    assert {row.replace("\\|", "").count("|") for row in rows} == {10}


def test_one_method_alone_has_nothing_to_be_compared_with(tmp_path: Path) -> None:
    assert "Difference" not in write_summary(RESULTS[:10], tmp_path).read_text() + shown(RESULTS[:10])


def test_the_reference_can_be_chosen(tmp_path: Path) -> None:
    assert "| zavis | bedroom | 10 | +70.0" in write_summary(RESULTS, tmp_path, reference="a|b").read_text()


def test_the_terminal_shows_units_and_whole_numbers_in_80_columns() -> None:
    text = shown(RESULTS)
    assert "SR [%]" in text
    assert "time [s]" in text
    assert "…" not in text


def test_crashes_are_loud(tmp_path: Path) -> None:
    for text in (write_summary([*RESULTS, CRASH], tmp_path).read_text(), shown([*RESULTS, CRASH]).replace("\n", " ")):
        assert "1 of 21 runs CRASHED" in text
        assert "crash: [x] ValueError" in text


def test_a_number_that_nobody_has_is_a_dash(tmp_path: Path) -> None:
    assert "| – |" in write_summary([result(details={})], tmp_path).read_text()
