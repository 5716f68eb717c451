"""Sixteen-bit arithmetic: used where the processor has it, and learning nothing else by it."""

import json
from pathlib import Path

import pytest

torch = pytest.importorskip("torch")

from detector_scenes import KNOWN, write_coco_scenes

from zavis_bt.perception.datasets import open_dataset
from zavis_bt.perception.detector import DetectorConfig, Training, TrainingLog, TrainingSettings, Views
from zavis_bt.perception.detector.building import build_network
from zavis_bt.perception.training.precision import mixed_precision


def a_processor(monkeypatch: pytest.MonkeyPatch, *features: str) -> None:
    monkeypatch.setattr(torch.cpu, "get_capabilities", lambda: dict.fromkeys(features, True))


@pytest.mark.parametrize(
    ("features", "expected"),
    [
        ((), torch.float32),
        (("avx2",), torch.float32),
        (("avx512_bf16",), torch.bfloat16),
        (("amx_bf16",), torch.bfloat16),
    ],
)
def test_products_are_of_sixteen_bits_where_the_processor_multiplies_them(
    monkeypatch: pytest.MonkeyPatch, features: tuple[str, ...], expected: torch.dtype
) -> None:
    a_processor(monkeypatch, *features)
    with mixed_precision("cpu"):
        assert (torch.ones(2, 2) @ torch.ones(2, 2)).dtype == expected


def losses(folder: Path, out: Path) -> list[float]:
    settings = TrainingSettings(iterations=12, batch=2, learning_rate=3e-3, views=Views(96, 1.5, 0.0))
    training = Training(build_network(DetectorConfig(KNOWN), 0), open_dataset(folder), settings)
    out.mkdir()
    with TrainingLog(out, every=1) as log:
        training.run(log, lambda state: None)
    return [json.loads(line)["total"] for line in (out / "log.jsonl").read_text().splitlines()]


def test_a_training_learns_the_same_with_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    torch.set_num_threads(1)
    folder = write_coco_scenes(tmp_path / "scenes", 6)
    a_processor(monkeypatch)
    exact = losses(folder, tmp_path / "exact")
    a_processor(monkeypatch, "avx512_bf16")
    mixed = losses(folder, tmp_path / "mixed")
    assert mixed != exact
    assert mixed[0] == pytest.approx(exact[0], rel=0.1)  # boxes are drawn, and others from other proposals
    for each in (exact, mixed):
        assert sum(each[-3:]) < 0.8 * sum(each[:3])
