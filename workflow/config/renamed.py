"""Reads old names of settings, with a notice; `noshiro migrate` rewrites them.

Old names occur in this module only. When a setting is renamed later, its old name is added to ``RENAMED``.
"""

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from meshes.errors import InputError

MIGRATE = "noshiro migrate FILE --write puts the new word into the file"


@dataclass(frozen=True)
class Renamed:
    """Holds a setting that was renamed, or whose values were renamed.

    Attributes
    ----------
    table, key : the table of settings, and the old key
    new_key : the new key; "" if the key is the same
    values : the new value for every old value
    """

    table: str
    key: str
    new_key: str = ""
    values: Mapping[str, str] = field(default_factory=dict)

    @property
    def key_now(self) -> str:
        """Return the present name of the key."""
        return self.new_key or self.key

    @property
    def path(self) -> str:
        """Return table and old key, in the form of the table [uncertain] and of the option --set."""
        return f"{self.table}.{self.key}"

    def value(self, old: Any) -> Any:
        """Return a value, or values within a list or a table, with new names."""
        if isinstance(old, str):
            return self.values.get(old, old)
        if isinstance(old, list | tuple):
            return [self.value(each) for each in old]
        return {key: self.value(each) for key, each in old.items()} if isinstance(old, Mapping) else old

    def moved(self, table: Mapping[str, Any], old: str, new: str) -> dict[str, Any]:
        """Return a copy of a table in which the key ``old`` is renamed ``new``, in its place, with new names in its
        value.
        """
        return {new if key == old else key: self.value(each) if key == old else each for key, each in table.items()}


RENAMED = (
    Renamed("fem", "sides", values={"roller": "free-field", "tied": "periodic"}),
    Renamed("fem", "flow", values={"section": "non-associated"}),
    Renamed("slide", "judges", new_key="methods"),
    Renamed("criteria", "preset", values={"river_levee_mlit": "crest_above_water"}),
)
# Keys of every distribution of the table [uncertain], and of every pair of its list "correlated": old key, new key.
DISTRIBUTION_KEYS = {"between": "truncation", "chances": "probabilities", "does": "applied_as"}
CORRELATION_KEYS = {"of": "paths"}
# Keys of the files that a run leaves: old key, new key, and another key of the same table ("" for any table), without
# which the old key is the name of something else, such as a stratum.
ANSWER_KEYS = (
    ("doubt", "warning", ""),
    ("doubts", "warnings", ""),
    ("skin", "shallow_failure", ""),
    ("skins", "shallow_failures", ""),
    ("what", "observation", "remedy"),
    ("rest", "remaining_error", "factor"),
    ("held", "strong_zones", "slip_surface"),
    ("stands", "verdict", "factor_lower"),
    ("given", "argument", "task"),
    ("by", "method", "reconsolidation_m"),
    ("of", "subject", "criterion"),
    ("over_effective", "residual_strength_ratio", "cohesion_kPa"),
    ("judged", "assessed", "liquefies"),
    ("left", "residual_strengths", "relations"),
    ("first", "first_order", "correlation"),
    ("first_ci95", "first_order_ci95", "correlation"),
    ("total", "total_order", "correlation"),
    ("total_ci95", "total_order_ci95", "correlation"),
    ("over", "coefficient", "low"),
    ("chance", "probability", "low"),
    ("without", "parts_without_answer", "seed"),
    ("fails", "failure_probability", "seed"),
    ("over", "refined", "sizes"),
    ("left", "remaining_error", "sizes"),
    ("within", "tolerance", "converged"),
    ("words", "description", "residuals"),
    ("words", "description", "validity"),
    ("words", "texts", "numbers"),
)


def current(data: Mapping[str, Any]) -> dict[str, Any]:
    """Return the content of a section file with new names in place of old ones.

    Parameters
    ----------
    data : the tables of the file, as ``tomllib`` reads them

    Returns
    -------
    A copy with new words in the tables of settings, and in [uncertain], whose keys are paths such as "fem.sides".
    """
    tables = dict(data)
    for rule in RENAMED:
        places = (rule.table, rule.key, rule.key_now), ("uncertain", rule.path, f"{rule.table}.{rule.key_now}")
        for table, old, new in places:
            if isinstance(tables.get(table), Mapping):
                tables[table] = rule.moved(tables[table], old, new)
    if isinstance(uncertain := tables.get("uncertain"), Mapping):
        tables["uncertain"] = {path: _current_entry(path, entry) for path, entry in uncertain.items()}
    return tables


def _current_entry(path: str, entry: Any) -> Any:
    """Return a distribution, or the list "correlated", with new keys."""
    if isinstance(entry, list | tuple):
        return [_current_entry(path, each) for each in entry]
    keys = CORRELATION_KEYS if path == "correlated" else DISTRIBUTION_KEYS
    return {keys.get(key, key): value for key, value in entry.items()} if isinstance(entry, Mapping) else entry


def current_answer(data: Any) -> Any:
    """Return the content of a run's JSON file with new names in place of old ones: keys, and the values of settings.

    Parameters
    ----------
    data : content of the file, or a part of it

    Returns
    -------
    A copy with new names.
    """
    if isinstance(data, list):
        return [current_answer(each) for each in data]
    if not isinstance(data, dict):
        return data
    new_keys = {old: new for old, new, sibling in ANSWER_KEYS if not sibling or sibling in data}
    answer = {new_keys.get(str(key), str(key)): current_answer(each) for key, each in data.items()}
    for rule in RENAMED:
        answer = rule.moved(answer, rule.key, rule.key_now)
    return answer


def notices(data: Mapping[str, Any]) -> list[str]:
    """Return a sentence for every old name in the tables of a file or of the command line, with the new name.

    Parameters
    ----------
    data : the tables as read, which may contain anything

    Returns
    -------
    The sentences, each once.
    """
    messages = []
    for rule in RENAMED:
        table = data.get(rule.table)
        if isinstance(table, Mapping) and rule.key in table:
            messages += [
                _notice(rule, word) for word in (_old_words(rule, table[rule.key]) or ([""] if rule.new_key else []))
            ]
        uncertain = data.get("uncertain")
        if isinstance(uncertain, Mapping) and rule.path in uncertain:
            messages += [_notice(rule, word) for word in _old_words(rule, uncertain[rule.path])]
    return list(dict.fromkeys([*messages, *_notices_of_uncertain(data.get("uncertain"))]))


def _notices_of_uncertain(uncertain: Any) -> Iterator[str]:
    """Yield a sentence for every old key in the distributions and the correlated pairs."""
    for path, entry in uncertain.items() if isinstance(uncertain, Mapping) else ():
        keys = CORRELATION_KEYS if path == "correlated" else DISTRIBUTION_KEYS
        for table in entry if isinstance(entry, list | tuple) else (entry,):
            for old in [key for key in keys if key in table] if isinstance(table, Mapping) else ():
                owner = "a correlated pair" if path == "correlated" else "a distribution"
                yield f'The key "{old}" of {owner} in [uncertain] is now "{keys[old]}"; {MIGRATE}.'


def _old_words(rule: Renamed, value: Any) -> list[str]:
    """Return the old names in a value."""
    if isinstance(value, str):
        return [value] if value in rule.values else []
    inside = value.values() if isinstance(value, Mapping) else value if isinstance(value, list | tuple) else ()
    return [word for each in inside for word in _old_words(rule, each)]


def _notice(rule: Renamed, word: str) -> str:
    now = f"{rule.table}.{rule.key_now}"
    is_now = f'{rule.path} = "{word}" is now {now} = "{rule.values[word]}"' if word else f"{rule.path} is now {now}"
    return f"{is_now}; {MIGRATE}."


def rewritten(text: str, source: str) -> tuple[str, list[str]]:
    """Return the text of a section file with new names; everything else, including comments, is unchanged.

    A word is replaced only if the file then has the content that ``current`` returns, since the name of a stratum may
    be equal to an old name of a setting.

    Parameters
    ----------
    text : text of the TOML file
    source : name of the file, for messages

    Returns
    -------
    The new text, and each change as "line 12: old -> new".

    Raises
    ------
    InputError : if the text is not TOML, or contains an old name in a form that cannot be replaced
    """
    try:
        wanted = current(tomllib.loads(text))
    except tomllib.TOMLDecodeError as error:
        raise InputError(source, [f"is not TOML: {error}"]) from None
    changes = []
    for start, end, new in sorted(_replacements(text), reverse=True):
        trial = text[:start] + new + text[end:]
        try:
            data = tomllib.loads(trial)
        except tomllib.TOMLDecodeError:
            continue
        if data != tomllib.loads(text) and current(data) == wanted:
            line = text.count("\n", 0, start) + 1
            changes.append(f"line {line}: {text[start:end]} -> {new}")
            text = trial
    if tomllib.loads(text) != wanted:
        raise InputError(
            source, [f"cannot be rewritten; change by hand: {messages}" for messages in notices(tomllib.loads(text))]
        )
    return text, changes[::-1]


def _replacements(text: str) -> Iterator[tuple[int, int, str]]:
    """Yield the possible places of old keys and values in a text: start, end, and replacement."""
    for rule in RENAMED:
        for old, new in rule.values.items():
            for place in re.finditer(f"([\"']){re.escape(old)}\\1", text):
                yield place.start(), place.end(), f"{place[1]}{new}{place[1]}"
        if rule.new_key:
            yield from _places(text, rule.key, rule.new_key)
    for old, new in (DISTRIBUTION_KEYS | CORRELATION_KEYS).items():
        yield from _places(text, old, new)


def _places(text: str, old: str, new: str) -> Iterator[tuple[int, int, str]]:
    for place in re.finditer(rf"(?<![\w-]){re.escape(old)}(?![\w-])", text):
        yield place.start(), place.end(), new
