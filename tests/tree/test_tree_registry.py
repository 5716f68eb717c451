"""Registry: kinds by name, from classes and from entry points."""

from __future__ import annotations

from importlib.metadata import EntryPoint
from types import ModuleType

import pytest
from tree_kinds import Act, Flag

from zavis_bt.errors import InputError
from zavis_bt.tree import Behaviour, Registry
from zavis_bt.tree import registry as registry_module


def test_it_maps_kind_names_to_classes() -> None:
    registry = Registry([Flag, Act, Act])
    assert dict(registry) == {"act": Act, "flag": Flag}
    assert list(registry) == ["act", "flag"]


def test_two_classes_of_one_name_are_refused() -> None:
    with pytest.raises(InputError, match=r"kind 'act' is defined twice: by tree_kinds.Act and "):
        Registry([Act, type("Act", (Behaviour,), {})])


def point(monkeypatch: pytest.MonkeyPatch, *targets: object) -> None:
    points = []
    for index in range(len(targets)):
        points.append(EntryPoint(f"p{index}", f"somewhere:{index}", registry_module.GROUP))
        monkeypatch.setattr(EntryPoint, "load", lambda self: targets[int(self.value.rpartition(":")[2])])
    monkeypatch.setattr(registry_module, "entry_points", lambda *, group: points)


def test_an_entry_point_names_a_module_or_a_class(monkeypatch: pytest.MonkeyPatch) -> None:
    module = ModuleType("plugin")
    vars(module).update(Act=Act, Behaviour=Behaviour, number=3, __all__=["Act", "number"])
    point(monkeypatch, module, Flag)
    assert dict(Registry.from_entry_points()) == {"act": Act, "flag": Flag}


def test_an_entry_point_without_behaviours_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    point(monkeypatch, ModuleType("empty"))
    with pytest.raises(InputError, match=r"entry point 'p0' = somewhere:0: no behaviour in it"):
        Registry.from_entry_points()


def test_an_entry_point_that_cannot_be_imported_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    points = [EntryPoint("ghost", "no_such_module", registry_module.GROUP)]
    monkeypatch.setattr(registry_module, "entry_points", lambda *, group: points)
    with pytest.raises(InputError, match="entry point 'ghost' = no_such_module: No module named"):
        Registry.from_entry_points()
