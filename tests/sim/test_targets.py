from __future__ import annotations

import pytest
from seen_worlds import piece, room

from sim.targets import SAME_THING, instances_named
from sim.world import World, WorldObject

SYNONYMS = {
    frozenset({"couch", "sofa"}): 0.9,
    frozenset({"purse", "wallet"}): SAME_THING,
    frozenset({"cup", "mug"}): 0.7,
}


def similarity(a: str, b: str) -> float:
    return 1.0 if a == b else SYNONYMS.get(frozenset({a, b}), 0.1)


def thing(id: str, category: str, colour: str | None = None) -> WorldObject:
    return WorldObject(id, category, 1.0, 1.0, 0.0, (0.1, 0.1, 0.1), colour=colour)


@pytest.fixture
def world() -> World:
    return room(
        (piece("sofa", 2.0, 2.0, 0.5), piece("dining table", 4.0, 2.0, 0.8)),
        (
            thing("wallet_1", "wallet", "red"),
            thing("wallet_2", "wallet", "black"),
            thing("wallet_3", "wallet"),
            thing("mug_1", "mug", "red"),
            thing("table_cloth_1", "table"),
        ),
    )


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("wallet", {"wallet_1", "wallet_2", "wallet_3"}),
        ("the red wallet", {"wallet_1"}),
        ("Red  Wallet", {"wallet_1"}),
        ("my black wallet", {"wallet_2"}),
        ("green wallet", set()),
        ("a photo of a wallet", {"wallet_1", "wallet_2", "wallet_3"}),
        ("a red mug", {"mug_1"}),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_a_name_means_all_of_its_kind_and_a_colour_those_that_have_it(world, text, ids):
    assert instances_named(world, text, similarity) == ids


def test_synonyms_mean_the_same_and_related_words_do_not(world):
    assert instances_named(world, "purse", similarity) == {"wallet_1", "wallet_2", "wallet_3"}
    assert instances_named(world, "red purse", similarity) == {"wallet_1"}
    assert instances_named(world, "cup", similarity) == frozenset()


def test_furniture_may_be_looked_for_too_but_has_no_colour(world):
    assert instances_named(world, "sofa", similarity) == {"sofa_1"}
    assert instances_named(world, "couch", similarity) == {"sofa_1"}
    assert instances_named(world, "Dining Table", similarity) == {"dining table_1"}
    assert instances_named(world, "red sofa", similarity) == frozenset()


def test_the_exact_name_rules_out_synonyms(world):
    both = world.with_objects([thing("couch_1", "couch"), *world.objects])
    assert instances_named(both, "couch", similarity) == {"couch_1"}
    assert instances_named(both, "sofa", similarity) == {"sofa_1"}


@pytest.mark.parametrize("text", ["harpsichord", "red", "the", "?"])
def test_what_is_not_there_is_nothing(world, text):
    assert instances_named(world, text, similarity) == frozenset()


def test_an_empty_world_holds_nothing():
    assert instances_named(room(), "wallet", similarity) == frozenset()
