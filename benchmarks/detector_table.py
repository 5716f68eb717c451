"""Table of open-set detectors: Faster R-CNN, ORE and the paper's method, several seeds each, on the same data.

    python benchmarks/detector_table.py TRAIN TEST --out DIR [--methods zavis,ore] [--seeds 0,1,2]

One JSON file a row and seed; what is there is not done again, an interrupted training goes on. A row that is trained
but has no JSON file is only judged. Several processes may work in one folder, each on methods or seeds of its own. With
nothing left to do it only prints the table. ``--further DIR`` teaches the detectors of the table in DIR further.
"""

from __future__ import annotations

import argparse
import json
import statistics
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from zavis_bt.perception.clip import ClipModel, ClipObjectness
from zavis_bt.perception.datasets import DetectionDataset, open_dataset
from zavis_bt.perception.detector import (
    Checkpoint,
    ClipLabelling,
    DetectorConfig,
    DetectorNetwork,
    NeuralDetector,
    ProposalLabelling,
    Training,
    TrainingLog,
    TrainingSettings,
    Views,
    load_detector,
    save_detector,
)
from zavis_bt.perception.detector.building import DEFAULT_KNOWN, build_network
from zavis_bt.perception.detector.config import method_named
from zavis_bt.perception.detector.decoded import Decoded
from zavis_bt.perception.detector.pseudo_labels import Labelling
from zavis_bt.perception.detector.warm_up import WarmUp
from zavis_bt.perception.evaluation import OpenSetResult, Truth, collect, judge, truths_of
from zavis_bt.perception.models import find_weights
from zavis_bt.perception.several_scales import SeveralScales
from zavis_bt.types import CameraIntrinsics, Detection, RgbdFrame

NAMES = {"faster_rcnn": "Faster R-CNN", "ore": "ORE", "zavis": "ours"}
COLUMNS = {"wi": "WI", "a_ose": "A-OSE", "u_recall": "U-Recall", "u_precision": "U-Precision", "k_map": "K-mAP"}
LEAST_SIDE = 4.0  # smaller things are ignored [px of the image that the detector sees]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("train")
    parser.add_argument("test")
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--methods", default=",".join(NAMES))
    parser.add_argument("--seeds", default="0,1,2")
    parser.add_argument("--further", type=Path, help="folder of the table whose detectors are taught further")
    parser.add_argument("--iterations", type=int, default=600, help="of each row and seed")
    parser.add_argument("--batch", type=int, default=16)
    parser.add_argument("--warm-up", type=int, default=3000, help="iterations with cut-outs, once for all rows")
    parser.add_argument("--collages", type=int, default=1200, help="iterations of the beginning, once for all rows")
    parser.add_argument("--widths", default="160,320", help="at which the detector looks at test images, joined [px]")
    parser.add_argument("--unknown-score", type=float, default=0.2, help="least score of unknown things")
    parser.add_argument("--images", type=int, help="of the test, from the first; all if not given")
    parser.add_argument("--threads", type=int, default=1)
    given = parser.parse_args()
    torch.set_num_threads(given.threads)
    given.out.mkdir(parents=True, exist_ok=True)
    widths = [int(width) for width in given.widths.split(",")]
    train = Decoded(open_dataset(given.train), given.out / "train.npy", 320)
    test = open_dataset(given.test)
    for seed in map(int, given.seeds.split(",")):
        for method in given.methods.split(","):
            result = given.out / f"{method}-{seed}.json"
            if result.exists():
                continue
            file = trained(method, seed, train, given.out / f"{method}-{seed}", given)
            judged = evaluated(file, test, widths, given)
            result.write_text(json.dumps({"iterations": given.iterations, "widths": widths, **judged.as_dict()}))
    print(table(given.out))


def trained(method: str, seed: int, data: DetectionDataset, folder: Path, given: argparse.Namespace) -> Path:
    """Train, or go on training, one detector, and return its weights file."""
    file = folder / "detector.safetensors"
    if file.exists():
        return file
    if given.further is None:
        network = build_network(DetectorConfig(DEFAULT_KNOWN, method_named(method)), seed)
        begin(network, data, given)
        labels, earlier = labelling(method, start=0.1), {}
    else:
        network, earlier = load_detector(given.further / f"{method}-{seed}" / "detector.safetensors")
        labels = labelling(method, start=0.0)
    settings = TrainingSettings(given.iterations, given.batch, 1e-3, seed, collages=0.35, views=Views(large=0.35))
    finish(Training(network, data, settings, labels), folder)
    facts = {"data": data.name, "images": len(data), "rendered": data.rendered, "seed": seed, "batch": given.batch}
    facts |= {"iterations": given.iterations}
    facts |= {"start": earlier} if earlier else {"collages": given.collages, "warm_up": given.warm_up}
    save_detector(network, file, facts)
    return file


def begin(network: DetectorNetwork, data: DetectionDataset, given: argparse.Namespace) -> None:
    """Give the network what all rows begin with, as usual detectors do with ImageNet's backbone.

    That is a Faster R-CNN trained on known things alone: cut out, in boxes, then in collages. Only the layer of the
    classes is each row's own from the start.
    """
    file = given.out / "begin.pt"
    if not file.exists():
        taught = build_network(DetectorConfig(DEFAULT_KNOWN, "faster_rcnn"), 0)
        settings = TrainingSettings(
            given.collages, given.batch, 2e-3, collages=0.85, warm_up=WarmUp(given.warm_up, 3 * given.warm_up)
        )
        finish(Training(taught, data, settings), given.out / "begin")
        torch.save(taught.state_dict(), file)
    own = network.state_dict()
    shared = {
        name: value
        for name, value in torch.load(file, weights_only=True).items()
        if name in own and own[name].shape == value.shape and not name.startswith("rois.classes")
    }
    network.load_state_dict(own | shared)


def finish(training: Training, folder: Path) -> None:
    """Run a training to its end, from its last checkpoint if there is one."""
    folder.mkdir(exist_ok=True)
    if (folder / "checkpoint.pt").exists():
        training.resume(Checkpoint.load(folder))
    with TrainingLog(folder) as log:
        training.run(log, lambda state: state.save(folder))


def labelling(method: str, *, start: float) -> Labelling | None:
    if method == "zavis":
        return ClipLabelling(ClipObjectness(ClipModel.load(str(find_weights("zavis-tiny")))), start=start)
    return ProposalLabelling() if method == "ore" else None


def evaluated(file: Path, test: DetectionDataset, widths: list[int], given: argparse.Namespace) -> OpenSetResult:
    """Judge a detector that looks at each image at one or more widths."""
    detectors = {width: NeuralDetector.load(file, width=width) for width in widths}
    for each in detectors.values():
        each.network.config = each.network.config.with_choice(unknown_score=given.unknown_score)
    joined = SeveralScales(detectors)
    width, chosen = max(widths), range(len(test))[: given.images]

    def predict(rgb: NDArray[np.uint8]) -> list[Detection]:
        camera = CameraIntrinsics.from_fov(rgb.shape[1], rgb.shape[0], 1.0)
        return joined.detect(RgbdFrame(camera, np.eye(4), 0.0, lambda: (rgb, np.zeros(rgb.shape[:2], np.float32))))

    found = collect(test, predict, indices=chosen, width=width)
    truths = [large_enough(truth, width / test.size(truth.image)[0]) for truth in truths_of(test, chosen)]
    return judge(found, truths, NeuralDetector.load(file).classes, len(chosen))


def large_enough(truth: Truth, scale: float) -> Truth:
    side = min(truth.box.x1 - truth.box.x0, truth.box.y1 - truth.box.y0) * scale
    return Truth(truth.image, truth.box, truth.label, truth.ignored or side < LEAST_SIDE)


def table(folder: Path) -> str:
    """Return the table in Markdown, mean ± standard deviation over the seeds that are done."""
    lines = [f"| | {' | '.join(COLUMNS.values())} | seeds |", "|---|" + "---|" * (len(COLUMNS) + 1)]
    for method, name in NAMES.items():
        rows = [json.loads(path.read_text()) for path in sorted(folder.glob(f"{method}-*.json"))]
        cells = [cell([row[column] for row in rows], column) for column in COLUMNS]
        lines.append(f"| {name} | {' | '.join(cells)} | {len(rows)} |")
    return "\n".join(lines)


def cell(values: list[float | None], column: str) -> str:
    numbers = [value for value in values if value is not None]
    if not numbers or (column.startswith("u_") and not any(numbers)):
        return "-"
    digits = {"a_ose": 0, "wi": 4}.get(column, 3)
    mean, spread = statistics.fmean(numbers), statistics.stdev(numbers) if len(numbers) > 1 else 0.0
    return f"{mean:.{digits}f} ± {spread:.{digits}f}"


if __name__ == "__main__":
    main()
