"""Tables of kinds for the terminal."""

from __future__ import annotations

import inspect
from collections.abc import Iterable

from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from zavis_bt.tree.datatypes import type_name
from zavis_bt.tree.ports import Port
from zavis_bt.tree.spec import Signature


def kinds_table(signatures: Iterable[Signature]) -> Table:
    """Return one row for each kind."""
    table = Table("kind", "in", "out", "what it does", show_lines=False)
    for signature in signatures:
        doc = inspect.cleandoc(signature.doc).partition("\n")[0]
        inputs = ", ".join(f"{name}{'' if port.required else '?'}" for name, port in signature.inputs.items())
        table.add_row(signature.kind, escape(inputs), escape(", ".join(signature.outputs)), escape(doc))
    return table


def kind_page(signature: Signature) -> RenderableType:
    """Return everything about one kind."""
    table = Table("port", "", "type", "unit", "range", "default", "meaning")
    for direction, ports in (("in", signature.inputs), ("out", signature.outputs)):
        for name, port in ports.items():
            table.add_row(name, direction, *_columns(port, direction))
    doc = inspect.cleandoc(signature.doc)
    parts: list[RenderableType] = [Text(signature.kind, style="bold"), Text(doc)]
    return Group(*parts, *([table] if table.row_count else []))


def _columns(port: Port, direction: str) -> tuple[str, ...]:
    default = "" if direction == "out" else "required" if port.required else str(port.default_value)
    columns = (type_name(port.data_type), port.unit, port.range_text, default, port.description)
    return tuple(escape(column) for column in columns)
