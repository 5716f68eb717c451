"""Names of categories: data sets spell the same thing differently."""

from __future__ import annotations

from zavis_bt.perception.naming import key

_PROJECT_NAMES = {
    key(name): ours
    for ours, names in {
        "sofa": ("sofa", "couch"),
        "dining table": ("dining table",),
        "tv": ("tv", "tv monitor", "television"),
        "plant": ("plant", "potted plant", "house plant"),
        "fridge": ("fridge", "refrigerator"),
        "cell phone": ("cell phone", "mobile phone"),
        "remote control": ("remote control", "remote"),
        "washing machine": ("washing machine",),
        "airplane": ("airplane", "aeroplane"),
        "motorcycle": ("motorcycle", "motorbike"),
    }.items()
    for name in names
}


def project_name(name: str) -> str:
    """Return the name this project uses for a category of Pascal VOC or COCO; other names as they are.

    ``diningtable`` is ``dining table``, ``tvmonitor`` is ``tv``, ``couch`` is ``sofa``.
    """
    return _PROJECT_NAMES.get(key(name), " ".join(name.split()))
