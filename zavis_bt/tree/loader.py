"""From a file to a tree, through five stages of checks whose faults are reported all at once."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from zavis_bt.errors import InputError, TreeError
from zavis_bt.tree.behaviour import Behaviour
from zavis_bt.tree.builder import Builder
from zavis_bt.tree.checks import check_arguments, check_file_root, check_recursion
from zavis_bt.tree.faults import Faults
from zavis_bt.tree.flow import check_flow
from zavis_bt.tree.includes import Library
from zavis_bt.tree.inputs import TreeInput, inputs_of, root_values
from zavis_bt.tree.mocks import read_mocks
from zavis_bt.tree.registry import Registry
from zavis_bt.tree.spec import FileSpec, TreeSpec
from zavis_bt.tree.tree import Tree, new_namespace


def load_tree(
    path: Path | str, registry: Registry, inputs: Mapping[str, Any] | None = None, *, mocks: Path | None = None
) -> Tree:
    """Return the tree of a file, checked and built.

    Args:
        path: Tree file (format: ``bt: 1``).
        registry: Behaviours that the tree may use.
        inputs: Values of the root tree's params and inputs.
        mocks: File of mocks that take the place of kinds.

    Raises:
        TreeError: The file has faults, or the inputs do not fit; one line for each.
    """
    return _build(Path(path), registry, dict(inputs or {}), mocks)


def check_tree(path: Path | str, registry: Registry, *, mocks: Path | None = None) -> Tree:
    """Return the tree of a file as far as it is known without inputs, to be shown but not ticked.

    Raises:
        TreeError: The file has faults; one line for each.
    """
    return _build(Path(path), registry, None, mocks)


def read_inputs(path: Path | str, registry: Registry) -> tuple[TreeInput, ...]:
    """Return what the root tree of a file takes, in the order of the file.

    Raises:
        TreeError: The file has faults; one line for each.
    """
    faults = Faults()
    _, root = _checked(Path(path), registry, faults)
    return inputs_of(root)


def read_library(path: Path | str, registry: Registry) -> tuple[Library, FileSpec]:
    """Return a file and all it includes, checked.

    Raises:
        TreeError: The file has faults; one line for each.
    """
    library, root = _checked(Path(path), registry, Faults())
    return library, root.file


def _checked(path: Path, registry: Registry, faults: Faults) -> tuple[Library, TreeSpec]:
    """Run the first four stages."""
    library = Library(registry, faults)
    try:
        file = library.read(path)
    except InputError as error:
        raise TreeError(str(error)) from error
    if file is not None:
        check_file_root(file, faults)
    check_recursion(library)
    for tree in library.trees:
        check_arguments(tree, library)
        check_flow(tree, library)
    faults.raise_if_any()
    assert file is not None
    return library, file.trees[file.root]


def _build(path: Path, registry: Registry, inputs: Mapping[str, Any] | None, mocks: Path | None) -> Tree:
    faults = Faults()
    library, root = _checked(path, registry, faults)
    replaced: dict[str, type[Behaviour]] = {}
    if mocks is not None:
        try:
            replaced = read_mocks(mocks, library, {tree.title: tree for tree in library.trees})
        except InputError as error:
            raise TreeError(str(error)) from error
    values = root_values(root, inputs, faults)
    namespace = new_namespace()
    builder = Builder(library, replaced, namespace)
    node = builder.build(root, values)
    tree = Tree(node, builder.built, {**builder.scopes, "globals": builder.globals}, namespace)
    tree.source = (library.content, inputs, mocks)
    faults.raise_if_any()
    return tree
