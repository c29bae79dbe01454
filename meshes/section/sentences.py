"""Writes problems of an input in sentences: the key as in the file, the value, and what was expected; and counts."""

import difflib
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, get_origin

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

# What pydantic calls by Python's names.
PLAIN_WORDS = {
    "model_type": "expected a table of keys and values",
    "dict_type": "expected a table of keys and values",
    "tuple_type": "expected a list",
    "too_short": "expected at least one",
    "string_type": "expected text",
    "string_pattern_mismatch": "expected another spelling",
    "bool_type": "expected true or false",
    "int_type": "expected a whole number",
}
# The same, of numbers, whose description need not say that they are such.
NUMBERS = {
    "int_parsing": "expected a whole number",
    "int_from_float": "expected a whole number",
    "float_type": "expected a number",
    "float_parsing": "expected a number",
    "finite_number": "expected a finite number",
}

# The same, of limits of numbers: words before the limit, and its name in the context of the error.
LIMITS = {
    "greater_than_equal": ("at least", "ge"),
    "greater_than": ("a number above", "gt"),
    "less_than_equal": ("at most", "le"),
    "less_than": ("a number below", "lt"),
}

LONGEST = 80  # characters of a value that are shown
FEW_KEYS = 10  # of a table that are all named, rather than the table in which an unknown key has its place


Place = tuple[int | str, ...]


def sentences(error: ValidationError, data: Any, model: type[BaseModel], other_keys: Sequence[str] = ()) -> list[str]:
    """Return one sentence for each problem of a table: the key, the value, what was expected.

    Parameters
    ----------
    error : error of pydantic
    data : the table of the file
    model : model that the table was read as
    other_keys : keys of other tables at that place, among which a similar key is looked for

    Returns
    -------
    The sentences, each once.
    """
    choices: dict[Place, list[ErrorDetails]] = {}
    for entry in error.errors():
        place, choice = _without_choices(entry["loc"], data)
        entry["loc"] = place
        choices.setdefault(choice or place, []).append(entry)
    texts = [text for field, same in choices.items() for entry in _nearest(field, same)
            for text in _sentences_of(entry, data, model, other_keys)]  # fmt: skip
    return list(dict.fromkeys(texts))


def _without_choices(location: Place, data: Any) -> tuple[Place, Place]:
    """Return a location as it is in the data, and the location of the key in it whose value can be of several kinds, or
    ().

    After such a key, pydantic inserts the type that it tried, such as "dict[str,float]", which is no key of the data.
    """
    place: list[int | str] = []
    field: Place = ()
    for step in location:
        whole = isinstance(data, Mapping | list | tuple)
        if isinstance(step, str) and place and (not whole or "[" in step or isinstance(data, list | tuple)):
            field = field or tuple(place)
            continue
        place.append(step)
        try:
            data = data[step] if whole else None
        except (KeyError, IndexError, TypeError):
            data = None
    return tuple(place), field


# What other programs and hand calculations call a key of a stratum or a case: the key, and what to know of it.
UNDRAINED = ("cohesion", ', with friction_angle = "0 deg"')
RESIDUAL_RATIO = ("residual", ", the residual strength over the vertical effective stress before shaking")
RESIDUAL = ("residual_strength", ' as a stress ("4 kPa"), or residual as a ratio to the vertical effective stress')
WEIGHT = ("density", ', which may be a unit weight such as "18 kN/m^3"')
SATURATED = ("density_saturated", WEIGHT[1])
HOEK_BROWN = ("cohesion", " and friction_angle, fitted to the Hoek-Brown envelope: see docs/how-to/section.md, Rock")
SEISMIC = ("fem", ", whose safety_factor_at = [0, 0.15] are the Kh at which factors of safety are computed")
STRUCTURAL = ("zones", ": forces of anchors, nails, piles and geotextiles are not computed; a wall is a zone")
OTHER_WORDS = {
    **dict.fromkeys(("kh", "k_h", "seismic", "seismic_coefficient"), SEISMIC),
    **dict.fromkeys(
        (
            "anchor", "anchors", "tiebacks", "nails", "soil_nails", "piles", "wall", "walls", "retaining_wall",
            "sheet_pile", "sheet_piles", "geotextile", "geotextiles", "geogrid", "geogrids", "reinforcement",
            "reinforcements", "supports",
        ),
        STRUCTURAL,
    ),
    "gsi": HOEK_BROWN, "mi": HOEK_BROWN, "m_i": HOEK_BROWN, "mb": HOEK_BROWN, "ucs": HOEK_BROWN, "sigma_ci": HOEK_BROWN,
    "sigci": HOEK_BROWN, "disturbance": HOEK_BROWN, "hoek_brown": HOEK_BROWN,
    "unit_weight": WEIGHT, "gamma": WEIGHT, "γ": WEIGHT, "gamma_sat": SATURATED,
    "unit_weight_saturated": SATURATED, "saturated_unit_weight": SATURATED,
    "su": UNDRAINED, "s_u": UNDRAINED, "cu": UNDRAINED, "c_u": UNDRAINED, "undrained_shear_strength": UNDRAINED,
    "undrained_strength": UNDRAINED, "c": ("cohesion", ""), "phi": ("friction_angle", ""), "φ": ("friction_angle", ""),
    "psi": ("dilation_angle", ""), "e": ("youngs_modulus", ""), "nu": ("poissons_ratio", ""),
    "ru": ("pore_pressure_ratio", ""), "r_u": ("pore_pressure_ratio", ""), "k": ("permeability", ""),
    "kx": ("permeability", ""), "ky": ("permeability_vertical", ""), "kv": ("permeability_vertical", ""),
    "borings": ("triggering", ", where [[triggering.borings]] have blow counts or cones"),
    "pop": ("pre_overburden_pressure", ""), "shansep": ("strength_ratio", ""),
    "residual_strength_ratio": RESIDUAL_RATIO, "residual_ratio": RESIDUAL_RATIO, "sr": RESIDUAL, "s_r": RESIDUAL,
}  # fmt: skip


def _nearest(field: Place, errors: list[ErrorDetails]) -> list[ErrorDetails]:
    """Return the faults by the kind of value that the writer most likely meant, among all kinds that the value
    can be."""

    def far(error: ErrorDetails) -> int:
        inside, table = len(error["loc"]) > len(field), isinstance(error["input"], Mapping | list | tuple)
        kind, literal = error["type"].endswith(("_type", "_parsing")), error["type"] == "literal_error"
        other = table or error["type"] in ("dict_type", "model_type")  # a table where a value stands, or the reverse
        return 0 if inside else 4 if other else 3 if kind else 2 if literal else 1

    least = min(map(far, errors))
    several = any(error["loc"] != field for error in errors) or len({error["type"] for error in errors}) > 1
    return [error for error in errors if far(error) == least] if several else errors


def _sentences_of(error: ErrorDetails, data: Any, model: type[BaseModel], other_keys: Sequence[str]) -> Iterable[str]:
    """Return one sentence for each problem in a pydantic error: the key, the value, what was expected."""
    key = _key(error["loc"], data)
    if error["type"] == "missing":
        expected = _description(error["loc"], model)
        return [f"{key}: missing" + (f"; expected {expected}" if expected else "")]
    if error["type"] == "extra_forbidden":
        known = [*_known_keys(error["loc"], model), *(other_keys if len(error["loc"]) == 1 else ())]
        close = difflib.get_close_matches(str(error["loc"][-1]), known, n=1)
        listed = f"; expected one of {', '.join(known)}" if known else ""
        hint = f'; did you mean "{close[0]}"?' if close else listed
        at_head = len(error["loc"]) == 1
        other = OTHER_WORDS.get(str(error["loc"][-1]).lower())
        if other and (other[0] in known or (at_head and other is SEISMIC)):
            hint = f"; expected {other[0]}{other[1]}"
        elif not close and len(known) > FEW_KEYS and (place := _right_place(error["loc"], model)):
            hint = f" here; {place}"
        return [f"{key}: unknown key{hint}"]
    value = error["input"]
    written = str(value).lower() if isinstance(value, bool) else repr(value)
    shown = f" = {shortened(written)}" if isinstance(value, str | int | float) else ""
    if error["type"] == "too_short" and len(error["input"]) > 0:
        return []  # none of the entries is sound, and each has its own sentence
    if error["type"] == "value_error":
        return [f"{key}{shown}: {text}" if key else text for text in str(error["ctx"]["error"]).split("\n")]
    return [f"{key}{shown}: {_expectation(error, _description(error['loc'], model))}"]


def _expectation(error: ErrorDetails, description: str) -> str:
    """Return in words what was expected in place of a value, with the description of its key."""
    meaning, plain = _first_part(description), PLAIN_WORDS.get(error["type"])
    note = f" ({meaning})" if meaning else ""
    hint = _similar_word(error["input"], description)
    if number := NUMBERS.get(error["type"]):
        return f"{number}{note}{hint}"
    if limit := limit_words(error):
        return f"expected {limit}{note}"
    if error["type"] == "literal_error":
        choices = str(error["ctx"]["expected"])
        described = all(choice.strip("'") in meaning for choice in re.split(", | or ", choices))
        return f"expected {meaning if described else choices + note}{hint}"
    if error["type"] == "bool_type" and description.startswith("true ") and not description.startswith("true or"):
        return f"{plain}; {description}"
    if plain:
        return f"expected {description}" if description else plain
    message = error["msg"][0].lower() + error["msg"][1:]
    return message + (f"; expected {description}" if description else "")


def _similar_word(value: Any, description: str) -> str:
    """Return a question with the word of a description that is similar to a value; empty if there is none."""
    close = difflib.get_close_matches(str(value), re.findall(r'"([^" ]+)"', description), n=1)
    return f'; did you mean "{close[0]}"?' if close else ""


def limit_words(error: ErrorDetails) -> str:
    """Return the limit that a number violates.

    Parameters
    ----------
    error : details of an error of pydantic

    Returns
    -------
    Words such as "at most 5"; empty for other errors.
    """
    limit = LIMITS.get(error["type"])
    return "" if limit is None else f"{limit[0]} {error['ctx'][limit[1]]:g}"


def _first_part(description: str) -> str:
    """Return the first sentence of a description, without notes on its default value."""
    return re.split(r"\. (?=[A-Z\"])|; (?=a section file|by default)", description)[0]


def shortened(text: str) -> str:
    """Return a value for messages: only its beginning, if it is longer than a line."""
    return text if len(text) <= LONGEST else f"{text[:LONGEST]}..."


def _key(location: tuple[int | str, ...], data: Any) -> str:
    """Return a location in the form in which a person finds it: tables by number from 1, and by name if they have
    one."""
    parts: list[str] = []
    for step in location:
        inside = isinstance(data, Mapping | list | tuple)
        try:
            data = data[step] if inside else None
        except (KeyError, IndexError, TypeError):
            data = None
        if isinstance(step, int):
            name = data.get("name") if isinstance(data, Mapping) else None
            parts[-1] += f" {step + 1}" + (f' "{name}"' if isinstance(name, str) else "")
        else:
            parts.append(step)
    return ", ".join(parts)


def model_at(location: tuple[int | str, ...], model: type[BaseModel]) -> type[BaseModel] | None:
    """Return the model that has the field at a location.

    Parameters
    ----------
    location : keys and numbers from the whole table to the field
    model : model of the whole table

    Returns
    -------
    The model; None if the location leads to no model.
    """
    owner: type[BaseModel] | None = model
    for step in location[:-1]:
        if isinstance(step, int):
            continue
        if owner is None:
            return None
        field = owner.model_fields.get(step)
        others = owner.__annotations__.get("__pydantic_extra__")  # of keys that a user makes up
        owner = next(_models_in(others if field is None else field.annotation), None)
    return owner


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in getattr(annotation, "__args__", ()):
        yield from _models_in(part)


def _known_keys(location: tuple[int | str, ...], model: type[BaseModel]) -> list[str]:
    owner = model_at(location, model)
    return [field.alias or name for name, field in owner.model_fields.items()] if owner else []


def _right_place(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    """Return where in the file a key has its place: at the head, or in another table; empty if it has none."""
    name = location[-1]
    if len(location) > 1 and name in model.model_fields:
        annotation = model.model_fields[str(name)].annotation
        if any(_models_in(annotation)):
            return f"expected tables [[{name}]]" if get_origin(annotation) is tuple else f"expected a table [{name}]"
        return "expected at the head of the file, before all tables"
    tables = [
        f"[{table}]"
        for table, field in model.model_fields.items()
        if table != location[0] and any(name in part.model_fields for part in _models_in(field.annotation))
    ]
    return f"expected in {' or '.join(tables)}" if tables else ""


def _description(location: tuple[int | str, ...], model: type[BaseModel]) -> str:
    owner = model_at(location, model)
    fields = {field.alias or name: field for name, field in owner.model_fields.items()} if owner else {}
    field = fields.get(str(location[-1]))
    return (field.description or "") if field else ""


def counted(count: int, singular: str, plural: str) -> str:
    """Return a count with its noun and, if a verb follows, the verb: "1 disc overlaps", "2 discs overlap".

    Parameters
    ----------
    count : the count
    singular, plural : the words that follow 1, and that follow every other count

    Returns
    -------
    Count and words.
    """
    return f"{count} {singular if count == 1 else plural}"


def coordinate(value: float) -> str:
    """Return a coordinate with four significant digits, one of national grids to the centimetre: "12.35", "523417.25".

    Parameters
    ----------
    value : coordinate (m)

    Returns
    -------
    The coordinate, without unit.
    """
    return f"{value:.4g}" if abs(value) < 1000.0 else f"{value:.2f}".rstrip("0").rstrip(".")
