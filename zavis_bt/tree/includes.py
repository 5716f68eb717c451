"""All files that a mission is made of, and the kinds each of them may use."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from zavis_bt.errors import InputError, did_you_mean
from zavis_bt.tree.controls import CONTROLS, DECORATIONS, SET, SET_DOC
from zavis_bt.tree.datatypes import type_names
from zavis_bt.tree.declarations import read_declarations
from zavis_bt.tree.document import Element, Items, Scalar, Table, read_document
from zavis_bt.tree.faults import Faults, Mark
from zavis_bt.tree.leaves import LEAVES
from zavis_bt.tree.nodes import NodeParser
from zavis_bt.tree.registry import Registry
from zavis_bt.tree.spec import Declared, FileSpec, Signature, TreeSpec

FORMAT = 1
"""Version of the tree format."""

FILE_KEYS = ("bt", "include", "root", "globals", "trees")
TREE_KEYS = ("doc", "params", "in", "out", "do")


class Library:
    """Reads a tree file and everything it includes."""

    def __init__(self, registry: Mapping[str, Any], faults: Faults) -> None:
        """Start empty; behaviours come from the registry, and what is wrong goes to ``faults``."""
        self.behaviours = Registry([*LEAVES, *registry.values()])
        self.faults = faults
        self.files: dict[Path, FileSpec] = {}
        self.content: dict[Path, Any] = {}
        """What the files say, without places: equal if only comments and layout differ."""
        ports = [
            port
            for class_ in self.behaviours.values()
            for port in (*class_.in_ports.values(), *class_.out_ports.values())
        ]
        self.types = type_names(port.data_type for port in ports)
        self._signatures: dict[str, Signature] = {}

    @property
    def trees(self) -> Iterator[TreeSpec]:
        """Every tree of every file."""
        return (tree for file in self.files.values() for tree in file.trees.values())

    @property
    def globals(self) -> dict[str, Declared]:
        """Variables that every tree may read and write."""
        return {name: declared for file in self.files.values() for name, declared in file.globals.items()}

    def signature(self, kind: str, file: FileSpec) -> Signature | None:
        """Return the interface of a kind as nodes of a file may use it, or None if there is no such kind."""
        if (tree := file.scope.get(kind)) is not None:
            return tree_signature(tree)
        if kind not in self._signatures:
            if (control := CONTROLS.get(kind)) is not None:
                self._signatures[kind] = control.signature
            elif (class_ := self.behaviours.get(kind)) is not None:
                self._signatures[kind] = Signature(kind, class_.__doc__ or "", class_.in_ports, class_.out_ports)
            elif kind == SET:
                self._signatures[kind] = Signature(kind, SET_DOC, {}, {})
        return self._signatures.get(kind)

    def read(self, path: Path, name: str = "", chain: tuple[Path, ...] = ()) -> FileSpec | None:
        """Read a file and, before it, those it includes.

        Args:
            path: The file.
            name: How messages call it.
            chain: The files that are being read, the outermost first.

        Raises:
            InputError: The file cannot be read.
        """
        resolved = path.resolve()
        if resolved in self.files:
            return self.files[resolved]
        document = read_document(path, self.faults, name or str(path))
        if document is None:
            return None
        file = FileSpec(resolved, name or str(path), document.mark)
        self.content[resolved] = document.plain
        if not isinstance(document, Table):
            self.faults.add(document.mark, "structure", "a tree file is a mapping with 'bt', 'root' and 'trees'")
            return None
        if not self._version(document):
            return None
        self._unknown_keys(document, FILE_KEYS, "a tree file")
        self._include(document.get("include"), file, (*chain, resolved))
        file.globals = read_declarations(document.get("globals"), self.types, self.faults)
        self._read_root(document.get("root"), file)
        self._read_trees(document, file)
        self.files[resolved] = file
        return file

    def _version(self, document: Table) -> bool:
        element = document.get("bt")
        version = element.plain if element else None
        if isinstance(version, int) and not isinstance(version, bool) and version == FORMAT:
            return True
        mark = element.mark if element else document.mark
        if element is None:
            self.faults.add(mark, "version", f"the format's version is missing (begin with 'bt: {FORMAT}')")
        elif isinstance(version, int) and version > FORMAT:
            self.faults.add(
                mark, "version", f"format {version} is newer than this program (it reads bt: {FORMAT}; update it)"
            )
        else:
            self.faults.add(mark, "version", f"there is no format {version!r} (it is bt: {FORMAT})")
        return False

    def _unknown_keys(self, table: Table, known: tuple[str, ...], what: str) -> None:
        for key in table:
            if key not in known:
                self.faults.add(
                    table.keys[key], "structure", f"unknown key '{key}' in {what}{did_you_mean(key, known)}"
                )

    def _include(self, element: Element | None, file: FileSpec, chain: tuple[Path, ...]) -> None:
        for item in self._texts(element, "'include' is a list of files, such as [safety.yaml]"):
            target = (file.path.parent / str(item.value)).resolve()
            if target in chain:
                way = " → ".join(path.name for path in (*chain[chain.index(target) :], target))
                self.faults.add(item.mark, "include", f"'{item.value}' includes itself: {way}")
                continue
            try:
                included = self.read(target, _shown(file.name, str(item.value)), chain)
            except InputError as error:
                beside = target.parent.glob("*.yaml") if target.parent.is_dir() else ()
                files = [path.name for path in beside if path.resolve() not in chain]
                near = did_you_mean(target.name, files)
                self.faults.add(item.mark, "include", f"{error}{near}")
                continue
            if included is not None:
                self._adopt(included, target.stem, item.mark, file)

    def _adopt(self, included: FileSpec, prefix: str, mark: Mark, file: FileSpec) -> None:
        if any(name.startswith(f"{prefix}.") for name in file.scope):
            self.faults.add(mark, "include", f"two included files are called '{prefix}' (rename one)")
        for name, tree in included.trees.items():
            tree.title = f"{prefix}.{name}"
            file.scope[f"{prefix}.{name}"] = tree

    def _texts(self, element: Element | None, form: str) -> list[Scalar]:
        if element is None:
            return []
        items = element.items if isinstance(element, Items) else (element,)
        texts = [item for item in items if isinstance(item, Scalar) and isinstance(item.value, str)]
        if not isinstance(element, Items) or len(texts) < len(items):
            self.faults.add(element.mark, "structure", form)
        return texts

    def _read_root(self, element: Element | None, file: FileSpec) -> None:
        if element is None:
            return
        if isinstance(element, Scalar) and isinstance(element.value, str):
            file.root, file.root_mark = element.value, element.mark
        else:
            self.faults.add(element.mark, "root", "'root' is the name of a tree")

    def _read_trees(self, document: Table, file: FileSpec) -> None:
        element = document.get("trees")
        if not isinstance(element, Table) or not element.entries:
            mark = element.mark if element else document.mark
            self.faults.add(mark, "structure", "'trees' is a mapping from names to trees, such as {search: {do: scan}}")
            return
        for name in element:
            if self._free_name(name, element.keys[name]):
                file.trees[name] = file.scope[name] = TreeSpec(name, name, file, element.keys[name])
        parser = NodeParser({*file.scope, *self.behaviours, *CONTROLS, SET}, self.faults)
        for name, tree in file.trees.items():
            self._read_tree(tree, element.entries[name], parser)

    def _free_name(self, name: str, mark: Mark) -> bool:
        if name in self.behaviours or name in CONTROLS or name in DECORATIONS or name == SET:
            self.faults.add(mark, "name", f"tree '{name}' has the name of a kind that exists already (rename it)")
        elif not name.replace("_", "").replace("-", "").isalnum():
            self.faults.add(mark, "name", f"'{name}' is no name of a tree (letters, digits, underscores)")
        else:
            return True
        return False

    def _read_tree(self, tree: TreeSpec, element: Element, parser: NodeParser) -> None:
        if not isinstance(element, Table):
            self.faults.add(
                element.mark, "structure", f"tree '{tree.name}' is a mapping with 'do', such as {{do: scan}}"
            )
            return
        self._unknown_keys(element, TREE_KEYS, f"tree '{tree.name}'")
        doc = element.get("doc")
        tree.doc = str(doc.value) if isinstance(doc, Scalar) else ""
        tree.params = read_declarations(element.get("params"), self.types, self.faults)
        tree.inputs = read_declarations(element.get("in"), self.types, self.faults)
        tree.outputs = read_declarations(element.get("out"), self.types, self.faults)
        self._distinct(tree)
        do = element.get("do")
        if do is None:
            self.faults.add(tree.mark, "structure", f"tree '{tree.name}' needs 'do', its root node")
        else:
            tree.do = parser.node(do, tree.name)

    def _distinct(self, tree: TreeSpec) -> None:
        seen: dict[str, Declared] = {}
        for declared in (*tree.params.values(), *tree.inputs.values(), *tree.outputs.values()):
            if declared.name in seen:
                line = seen[declared.name].mark.line
                self.faults.add(declared.mark, "name", f"'{declared.name}' is already declared in line {line}")
            seen.setdefault(declared.name, declared)


def tree_signature(tree: TreeSpec) -> Signature:
    """Return the interface of a tree as a kind."""
    inputs = {name: declared.port for name, declared in (tree.params | tree.inputs).items()}
    outputs = {name: declared.port for name, declared in tree.outputs.items()}
    return Signature(tree.title, tree.doc, inputs, outputs, frozenset(tree.params))


def _shown(includer: str, included: str) -> str:
    """Return how messages call an included file: seen from where the including one was."""
    return str(Path(includer).parent / included)
