from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import bench_samples
import pytest
from bench_samples import episode, search, search_fatally, search_noted, search_once_fixed

from zavis_bt.bench import Task, load_results, make_tasks, run_benchmark
from zavis_bt.errors import InputError

SETTINGS = {"perception": "simulated", "budget": 50}
TASKS = make_tasks([episode(f"e{k}", group=("bedroom", "living room")[k % 2]) for k in range(6)], ["zavis", "cow"])


def test_methods_share_an_episodes_seed_and_it_does_not_depend_on_the_others() -> None:
    seeds = {task.key[:2]: task.seed for task in TASKS}
    assert len(set(seeds.values())) == 6
    assert all(seeds[f"e{k}", "zavis"] == seeds[f"e{k}", "cow"] for k in range(6))
    (alone,) = make_tasks([episode("e4")], ["cow"])
    assert alone.seed == seeds["e4", "cow"]
    assert make_tasks([episode("e4")], ["cow"], seed=1)[0].seed != alone.seed


def test_repeats_have_seeds_of_their_own() -> None:
    assert len({task.key for task in make_tasks([episode()], ["zavis", "cow"], repeats=3)}) == 6


def test_results_are_the_same_bytes_with_any_number_of_workers(tmp_path: Path) -> None:
    for workers in (1, 2):
        run_benchmark(TASKS, search, tmp_path / str(workers), settings=SETTINGS, workers=workers)
    text = (tmp_path / "1" / "results.jsonl").read_bytes()
    assert text == (tmp_path / "2" / "results.jsonl").read_bytes()
    results = load_results(tmp_path / "1")
    assert [result.key for result in results] == [task.key for task in TASKS]
    assert [result.group for result in results] == [task.episode.group for task in TASKS]


def test_what_is_returned_is_what_is_in_the_file(tmp_path: Path) -> None:
    assert run_benchmark(TASKS[:3], search, tmp_path, settings={}) == load_results(tmp_path)


def test_a_finished_benchmark_runs_nothing_again_and_more_tasks_may_be_added(tmp_path: Path) -> None:
    work = partial(search_noted, tmp_path / "note")
    run_benchmark(TASKS[1:4], work, tmp_path / "out", settings=SETTINGS)
    run_benchmark(TASKS[1:4], work, tmp_path / "out", settings=SETTINGS)
    run_benchmark(TASKS[:5], work, tmp_path / "out", settings=SETTINGS)
    assert sorted((tmp_path / "note").read_text().splitlines()) == [f"{t.episode.id} {t.method}" for t in _sorted(5)]
    assert [result.key for result in load_results(tmp_path / "out")] == [task.key for task in TASKS[:5]]


def _sorted(count: int) -> list[Task]:
    return sorted(TASKS[:count], key=lambda task: (task.episode.id, task.method))


def test_a_killed_run_resumes_to_the_same_bytes(tmp_path: Path) -> None:
    run_benchmark(TASKS, search, tmp_path / "whole", settings=SETTINGS)
    run_benchmark(TASKS[4:9], search, tmp_path / "killed", settings=SETTINGS)
    with (tmp_path / "killed" / "results.jsonl").open("a") as file:
        file.write('{"id": "e0", "meth')  # what a kill in the middle of a line leaves
    run_benchmark(TASKS, search, tmp_path / "killed", settings=SETTINGS)
    assert (tmp_path / "whole" / "results.jsonl").read_bytes() == (tmp_path / "killed" / "results.jsonl").read_bytes()


def test_a_crash_is_a_failed_result_with_its_traceback_and_is_tried_again(tmp_path: Path) -> None:
    work = partial(search_once_fixed, tmp_path / "fixed")
    first = run_benchmark(TASKS[:4], work, tmp_path / "out", settings={})
    crashed = [result for result in first if result.crashed]
    assert {(result.id, result.success, result.spl, result.reason) for result in crashed} == {
        ("e1", False, 0.0, "crash: ZeroDivisionError: no")
    }
    traces = sorted((tmp_path / "out" / "crashes").iterdir())
    assert len(traces) == 2
    assert "search_once_fixed" in traces[0].read_text()
    (tmp_path / "fixed").touch()
    assert not any(result.crashed for result in run_benchmark(TASKS[:4], work, tmp_path / "out", settings={}))
    assert not (tmp_path / "out" / "crashes").exists()


def test_a_dead_process_costs_its_own_episode_only(tmp_path: Path) -> None:
    results = run_benchmark(TASKS[::2], search_fatally, tmp_path, settings={}, workers=2)
    reasons = [result.reason.removeprefix("crash: ") for result in results if result.crashed]
    assert reasons[:2] == ["the process was killed by SIGKILL", "the process ended with exit code 7"]
    assert "ValueError" in reasons[2]
    assert [result.crashed for result in results] == [False, True, True, True, False, False]


def test_other_settings_are_refused_by_name(tmp_path: Path) -> None:
    run_benchmark(TASKS[:1], search, tmp_path, settings=SETTINGS)
    with pytest.raises(InputError, match=r"was begun with budget = 50, not 20 \(use the same settings"):
        run_benchmark(TASKS[:1], search, tmp_path, settings=SETTINGS | {"budget": 20})


def test_results_that_are_not_asked_for_are_refused(tmp_path: Path) -> None:
    run_benchmark(TASKS[:2], search, tmp_path, settings={})
    with pytest.raises(InputError, match=r"not asked for: episode e0, method cow"):
        run_benchmark(TASKS[:1], search, tmp_path, settings={})


def test_a_folder_of_something_else_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(InputError, match="not a benchmark's folder"):
        run_benchmark(TASKS[:1], search, tmp_path, settings={})
    with pytest.raises(InputError, match="cannot be used"):
        run_benchmark(TASKS[:1], search, tmp_path / "thesis.tex", settings={})


@pytest.mark.parametrize("content", ["{", "{}", "[]", '{"format": "zavis-bench/9", "settings": {}}'])
def test_a_damaged_folder_is_refused(tmp_path: Path, content: str) -> None:
    (tmp_path / "bench.json").write_text(content)
    with pytest.raises(InputError, match=r"damaged|another version"):
        run_benchmark(TASKS[:1], search, tmp_path, settings={})


SCRIPT = """
import sys
from functools import partial
from pathlib import Path
import bench_samples
from zavis_bt.bench import make_tasks, run_benchmark
if __name__ == "__main__":
    out = Path(sys.argv[1])
    tasks = make_tasks([bench_samples.episode(f"e{k}") for k in range(8)], ["zavis"])
    try:
        run_benchmark(tasks, partial(bench_samples.search_slowly, out / "../pids"), out, settings={}, workers=2)
    except KeyboardInterrupt:
        sys.exit(130)
"""


@pytest.mark.parametrize(("sign", "code"), [(signal.SIGINT, 130), (signal.SIGKILL, -9)])
def test_an_interrupted_run_leaves_its_results_and_no_process(tmp_path: Path, sign: signal.Signals, code: int) -> None:
    script = tmp_path / "script.py"
    script.write_text(SCRIPT)
    paths = os.pathsep.join([str(Path(bench_samples.__file__).parent), *sys.path])
    process = subprocess.Popen(
        [sys.executable, script, tmp_path / "out"],
        env=os.environ | {"PYTHONPATH": paths},
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    _wait_until(lambda: (tmp_path / "pids").exists() and len((tmp_path / "pids").read_text().split()) == 4)
    with pytest.raises(InputError, match="in use by another benchmark"):
        run_benchmark(TASKS[:1], search, tmp_path / "out", settings={})
    os.killpg(process.pid, sign) if sign == signal.SIGINT else process.send_signal(sign)
    _, errors = process.communicate(timeout=10)
    assert (process.returncode, errors) == (code, b"")
    assert {result.id for result in load_results(tmp_path / "out")} == {"e0", "e1"}
    workers = {int(pid) for pid in (tmp_path / "pids").read_text().split()}
    _wait_until(lambda: not any(Path(f"/proc/{pid}/cwd").exists() for pid in workers))
    settings = json.loads((tmp_path / "out" / "bench.json").read_text())["settings"]
    tasks = make_tasks([episode(f"e{k}") for k in range(8)], ["zavis"])
    assert len(run_benchmark(tasks, search, tmp_path / "out", settings=settings)) == 8


def _wait_until(condition: Callable[[], bool], seconds: float = 15.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.02)
