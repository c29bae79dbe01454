"""Generates the reference of all keys of a section file from the models that read it: default, unit, range and
description."""

from collections.abc import Iterator
from dataclasses import dataclass
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MinLen
from pydantic import BaseModel, PlainValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from meshes.section.polyline import Line
from meshes.section.quantity import Kind
from meshes.section.section import Section
from meshes.section.zone import Zone
from workflow.config import Config
from workflow.report.tables import setting_text

BOUNDS = ((Ge, "ge", "from {:g}"), (Gt, "gt", "above {:g}"), (Le, "le", "to {:g}"), (Lt, "lt", "below {:g}"))
COMMON = "section"  # what stands at the head of the file, before any table


@dataclass(frozen=True)
class Key:
    """Holds one key of a section file: its table, name, default, unit, allowed values and description."""

    table: str
    name: str
    default: str
    unit: str
    allowed: str
    description: str


def keys() -> list[Key]:
    """Yield all keys: first those at the head of a file, then those of a stratum, then the tables of settings."""
    return [*_of_fields(Section.model_fields, ""), *_of_tables()]


def _of_tables() -> Iterator[Key]:
    for table in Config.tables():
        model = type(Config.model_fields[table].default)
        yield from _of_fields(model.model_fields, table)


def _of_fields(fields: dict[str, FieldInfo], table: str) -> Iterator[Key]:
    """Yield the keys of a table, then those of the tables within it."""
    inside = []
    for name, field in fields.items():
        key = field.alias or name
        yield Key(
            table or COMMON, key, _default(field), _unit(field), _allowed_values(field), str(field.description or "")
        )
        inside += [(f"{table}.{key}" if table else key, model) for model in _tables_in(field)]
    for path, model in inside:
        # The other keys of zones are those of strata; their bottom is none.
        names = model.__annotations__.keys() - {"bottom"} if issubclass(model, Zone) else model.model_fields
        yield from _of_fields({name: field for name, field in model.model_fields.items() if name in names}, path)


def _tables_in(field: FieldInfo) -> list[type[BaseModel]]:
    """Return the models of lists of tables within a field. A line is written in one piece and is not such a list."""
    models = [
        part for part in _annotation_parts(field.annotation) if isinstance(part, type) and issubclass(part, BaseModel)
    ]
    return [model for model in dict.fromkeys(models) if model is not Line]


def _annotation_parts(annotation: Any) -> Iterator[Any]:
    """Yield an annotation and all its parts."""
    yield annotation
    for part in get_args(annotation):
        yield from _annotation_parts(part)
    yield from getattr(annotation, "__metadata__", ())


def _field_annotations(field: FieldInfo) -> list[Any]:
    pieces = [*field.metadata, *_annotation_parts(field.annotation)]
    return [*pieces, *(limit for piece in pieces if isinstance(piece, FieldInfo) for limit in piece.metadata)]


def _kind(field: FieldInfo) -> Kind | None:
    """Return the physical quantity of a field."""
    readers = (getattr(getattr(piece, "func", None), "__self__", None) for piece in _field_annotations(field))
    return next((reader for reader in readers if isinstance(reader, Kind)), None)


def _unit(field: FieldInfo) -> str:
    kind = _kind(field)
    return kind.unit if kind is not None else ""


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "must be given"
    value = field.get_default(call_default_factory=True)
    if value is None or value is PydanticUndefined or value in ("", (), {}):
        return "none"
    if isinstance(value, BaseModel) or (isinstance(value, tuple) and isinstance(value[0], BaseModel)):
        return "as below" if isinstance(value, BaseModel) else "as described"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if type(value) is str else setting_text(value)


def _allowed_values(field: FieldInfo) -> str:
    """Return the allowed values in words, from the checks of the model."""
    kind = _kind(field)
    if kind is not None:
        return (kind.limits.strip() or "any") + f", such as {kind.example}"
    pieces = _field_annotations(field)
    words = [word for piece in pieces if get_origin(piece) is Literal for word in get_args(piece)]
    if words:
        return ", ".join(f'"{word}"' for word in dict.fromkeys(words) if word != "")
    if bool in pieces:
        return "true or false"
    phrases = [
        form.format(getattr(piece, key))
        for kind_of, key, form in BOUNDS
        for piece in pieces
        if isinstance(piece, kind_of)
    ]
    phrases += [f"at least {piece.min_length}" for piece in pieces if isinstance(piece, MinLen)]
    whole = "a whole number" if int in pieces else "a number" if float in pieces else "text" if str in pieces else ""
    entry = " ".join([whole, *dict.fromkeys(phrases)]).strip()
    if not whole.endswith("number"):
        return entry
    if dict in map(get_origin, pieces):
        return (
            f"{entry}, or one for each stratum" if get_origin(field.annotation) is not dict else f"{entry} by stratum"
        )
    if (
        not phrases
        and any(isinstance(piece, PlainValidator) for piece in field.metadata)
        and _list_values(field, "") == ""
    ):
        return "as described"
    return _list_values(field, entry)


def _list_values(field: FieldInfo, entry: str) -> str:
    """Return the allowed values in words of a key that may be a list, from those of one entry."""
    annotation = field.annotation
    choices = get_args(annotation) if get_origin(annotation) in (Union, UnionType) else (annotation,)
    lists = [choice for choice in choices if get_origin(choice) is tuple]
    if not lists:
        return entry
    if get_origin(get_args(lists[0])[0]) is tuple:
        return "a list of points [x, elevation]"
    if any(isinstance(piece, PlainValidator) for piece in field.metadata):
        return "one value, or a list"
    single = [choice for choice in choices if choice is not NoneType and choice not in lists]
    return f"{entry}, or a list" if single else f"a list, each entry {entry}"


def markdown() -> str:
    """Return the reference as a page."""
    lines = [
        "# Every key of a section file",
        "",
        "This page is generated from the models that read and check a section file.",
    ]
    table = None
    for key in keys():
        if key.table != table:
            table = key.table
            head = "At the head of the file" if table == COMMON else f"`[{table}]`"
            lines += ["", f"## {head}", "", "| key | default | unit | allowed | what it is |", "|---|---|---|---|---|"]
        cells = (f"`{key.name}`", key.default, key.unit, key.allowed, key.description)
        lines.append("| " + " | ".join(cell.replace("|", "\\|").replace("\n", " ") for cell in cells) + " |")
    return "\n".join(lines) + "\n"
