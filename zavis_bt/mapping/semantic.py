"""The semantic map: pieces of furniture as instances, their labels fused over many views."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations, groupby
from pathlib import Path

from zavis_bt.errors import InputError
from zavis_bt.mapping.association import AssociationSettings, assign, is_duplicate, is_same_place
from zavis_bt.mapping.evidence import Evidence
from zavis_bt.mapping.semantic_file import decode_landmarks, encode_landmarks
from zavis_bt.types import Landmark, LandmarkSighting


class SemanticMap:
    """Landmarks seen so far. Each instance is one landmark: two desks never become one for being both desks."""

    def __init__(self, settings: AssociationSettings | None = None) -> None:
        """Start empty.

        Args:
            settings: When two things seen are one.
        """
        self._settings = settings or AssociationSettings()
        self._evidence: dict[int, Evidence] = {}
        self._merged: dict[int, int] = {}
        self._visited: set[int] = set()
        self._next_id = 0
        self._version = 0
        self._landmarks: tuple[Landmark, ...] = ()

    @property
    def landmarks(self) -> tuple[Landmark, ...]:
        """All landmarks, oldest first."""
        return self._landmarks

    @property
    def visited(self) -> frozenset[int]:
        """Ids of the landmarks that were visited."""
        return frozenset(self._visited)

    @property
    def version(self) -> int:
        """Grows whenever the landmarks change."""
        return self._version

    def integrate(self, sightings: Sequence[LandmarkSighting]) -> None:
        """Fuse sightings; those with the same stamp are taken to come from one frame."""
        if not sightings:
            return
        by_stamp = sorted(sightings, key=lambda sighting: sighting.stamp)
        for _, frame in groupby(by_stamp, key=lambda sighting: sighting.stamp):
            self._fuse([Evidence.of(sighting) for sighting in frame])
        while self._merge_one():
            pass
        self._publish()

    def mark_visited(self, landmark: int) -> None:
        """Note that a landmark was visited, under its present or an earlier id."""
        self._visited.add(self.resolve(landmark))

    def resolve(self, landmark: int) -> int:
        """Return the present id of a landmark that may have been merged into another since."""
        while landmark in self._merged:
            landmark = self._merged[landmark]
        return landmark

    def forget_visits(self) -> None:
        """Make every landmark unvisited again, as for another target."""
        self._visited.clear()

    def to_json(self) -> str:
        """Return the landmarks as JSON text, format ``zavis-semantic-map/1``; visits belong to a search, not here."""
        return encode_landmarks(self._landmarks)

    @classmethod
    def from_json(
        cls, text: str, settings: AssociationSettings | None = None, where: str = "semantic map"
    ) -> SemanticMap:
        """Return a map with the landmarks of `to_json`, ready to fuse more sightings.

        Args:
            text: JSON.
            settings: When two things seen are one.
            where: Where the text comes from, for messages.

        Raises:
            InputError: The text is not a semantic map.
        """
        semantic = cls(settings)
        landmarks = sorted(decode_landmarks(text, where), key=lambda landmark: landmark.id)
        semantic._evidence = {landmark.id: Evidence.remembered(landmark) for landmark in landmarks}
        semantic._next_id = max((landmark.id for landmark in landmarks), default=-1) + 1
        semantic._publish()
        return semantic

    def save(self, path: Path | str) -> None:
        """Write ``semantic_map.json``.

        Raises:
            InputError: The file cannot be written.
        """
        try:
            Path(path).write_text(self.to_json(), encoding="utf-8")
        except OSError as error:
            raise InputError(f"{path}: cannot be written: {error.strerror}") from error

    @classmethod
    def load(cls, path: Path | str, settings: AssociationSettings | None = None) -> SemanticMap:
        """Read ``semantic_map.json``.

        Raises:
            InputError: The file is missing or is not a semantic map.
        """
        try:
            text = Path(path).read_text(encoding="utf-8")
        except FileNotFoundError as error:
            raise InputError(f"{path}: no such file") from error
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: cannot be read: {error}") from error
        return cls.from_json(text, settings, str(path))

    def _fuse(self, frame: list[Evidence]) -> None:
        ids = list(self._evidence)
        known = [self._evidence[i] for i in ids]
        matches = assign(frame, known, self._settings)
        for seen, match in zip(frame, matches, strict=True):
            if match is not None:
                self._evidence[ids[match]] += seen
        for seen, match in zip(frame, matches, strict=True):
            if match is None and not self._is_repeated(seen):
                self._evidence[self._next_id] = seen
                self._next_id += 1

    def _is_repeated(self, seen: Evidence) -> bool:
        """Tell whether a sighting without a landmark of its own shows again what its frame has shown already."""
        return any(
            is_same_place(seen, known, self._settings) or is_duplicate(seen, known, self._settings)
            for known in self._evidence.values()
        )

    def _merge_one(self) -> bool:
        for kept, gone in combinations(self._evidence, 2):
            if is_duplicate(self._evidence[kept], self._evidence[gone], self._settings):
                self._evidence[kept] += self._evidence.pop(gone)
                self._merged[gone] = kept
                if gone in self._visited:
                    self._visited.remove(gone)
                    self._visited.add(kept)
                return True
        return False

    def _publish(self) -> None:
        self._landmarks = tuple(
            Landmark(id, tuple(evidence.probabilities.items()), evidence.position, evidence.radius, evidence.views)
            for id, evidence in self._evidence.items()
        )
        self._version += 1
