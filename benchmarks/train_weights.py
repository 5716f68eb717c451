"""Train the small networks that come along, from nothing: draw the images, train both, measure their thresholds.

    python benchmarks/train_weights.py OUT [--minutes 120] [--install]

Steps that are done are not done again, interrupted ones go on. OUT/train holds the images to learn from, in which ten
categories are never drawn; OUT/val and OUT/test show all. With --install the weights take the place of those in the
package, and are sealed.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

from zavis_bt.perception.detector.building import DEFAULT_KNOWN
from zavis_bt.perception.models import WEIGHTS
from zavis_bt.perception.models.seal import seal_weights

NEVER_DRAWN = (
    "kettle",
    "guitar",
    "radio",
    "glove",
    "dumbbell",
    "toy car",
    "fan",
    "watering can",
    "pear",
    "headphones",
)
"""Left out of the training images, to see what becomes of things that no network was shown."""
RARE = {
    "credit card": 4,
    **dict.fromkeys(("pen", "pencil", "lighter"), 3),
    **dict.fromkeys(("fork", "spoon", "scissors", "key chain", "cd", "cell phone"), 2),
    **dict.fromkeys(("wallet", "knife", "toothbrush", "egg", "sock", "soap bar", "tie", "remote control", "banana"), 1),
    **dict.fromkeys(("watch", "newspaper", "cloth", "plate", "mouse", "baseball bat", "broom", "plunger"), 1),
    **dict.fromkeys(("bed", "desk", "armchair", "cabinet", "countertop", "drawer", "side table", "coffee table"), 1),
    **dict.fromkeys(("tv stand", "fireplace", "floor lamp", "mirror", "safe", "bucket", "garbage can"), 1),
    "laundry basket": 1,
}
"""So many times more often than others: they are small, or mostly hidden or cut off."""
VAL, TEST = 100, 30  # for so many images of training one


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path)
    parser.add_argument("--frames", type=int, default=60000)
    parser.add_argument("--seed", type=int, default=41)
    parser.add_argument("--minutes", type=float, default=120.0, help="for the matcher")
    parser.add_argument("--warm-up", type=int, default=3000, help="iterations of the detector with cut-outs")
    parser.add_argument("--iterations", type=int, default=3500, help="of the detector after that")
    parser.add_argument("--workers", type=int, default=2, help="processes that draw images")
    parser.add_argument("--install", action="store_true", help="into the package")
    given = parser.parse_args()
    given.out.mkdir(parents=True, exist_ok=True)
    draw(given)
    matcher, detector = train_matcher(given), train_detector(given)
    if given.install:
        install(matcher, detector)
        measure = ("perception", "calibrate", given.out / "val", "--images", 600, "--widths", "160,320,640")
        zavis(*measure, "--out", WEIGHTS / "zavis-tiny.eyes.yaml")
        seal_weights()


def draw(given: argparse.Namespace) -> None:
    """Draw the images of training, validation and test."""
    more = [name for name, times in RARE.items() for _ in range(times)] + list(DEFAULT_KNOWN)
    without = [word for name in NEVER_DRAWN for word in ("--without", name)]
    also = [word for name in more for word in ("--also", name)]
    known = [word for name in DEFAULT_KNOWN for word in ("--also", name)]
    for folder, count, seed, words in (
        ("train", given.frames, given.seed, without + also),
        ("val", given.frames // VAL, 2, known),
        ("test", given.frames // TEST, 3, known),
    ):
        if not (given.out / folder / "annotations.json").exists():
            shutil.rmtree(given.out / folder, ignore_errors=True)
            zavis(
                *("sim", "frames", given.out / folder, "--count", count, "--seed", seed),
                *("--workers", given.workers, *words),
            )


def train_matcher(given: argparse.Namespace) -> Path:
    """Return the folder of the trained matcher."""
    folder: Path = given.out / "matcher"
    if not (folder / "open_clip_config.json").exists():
        resume = ["--resume"] if (folder / "checkpoint.pt").exists() else []
        length = ("--steps", 10**6, "--minutes", given.minutes)
        zavis("matcher", "train", given.out / "train", "--out", folder, *length, *resume)
    return folder


def train_detector(given: argparse.Namespace) -> Path:
    """Return the file of the trained detector, whose labels of unknown things come from the trained matcher.

    Its cut of the uncertainty is set on the validation images.
    """
    folder: Path = given.out / "detector"
    tuned = folder / "tuned.safetensors"
    if not (folder / "detector.safetensors").exists():
        resume = ["--resume"] if (folder / "checkpoint.pt").exists() else []
        length = ("--warm-up", given.warm_up, "--iterations", given.iterations)
        clip = ("--clip", given.out / "matcher")
        zavis("detector", "train", given.out / "train", "--out", folder, *clip, *length, *resume)
    if not tuned.exists():
        zavis("detector", "tune", folder / "detector.safetensors", given.out / "val", "--out", tuned)
    return tuned


def install(matcher: Path, detector: Path) -> None:
    """Put the weights into the package."""
    for name in ("open_clip_config.json", "open_clip_model.safetensors"):
        shutil.copyfile(matcher / name, WEIGHTS / "zavis_tiny_clip" / name)
    shutil.copyfile(detector, WEIGHTS / "zavis_tiny_detector.safetensors")


def zavis(*words: object) -> None:
    command = [sys.executable, "-m", "zavis_bt", *map(str, words)]
    print("zavis", *command[3:11], *["…"] * (len(command) > 11), flush=True)
    subprocess.run(command, check=True)


if __name__ == "__main__":
    main()
