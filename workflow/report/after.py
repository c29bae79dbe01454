"""Whether the ground still stands after liquefaction, in sentences."""

from collections.abc import Iterator

from workflow.report.numbers import coefficient, listed, number
from workflow.results.liquefied import LiquefiedAnswer, LiquefiedCase


def in_short(answer: LiquefiedAnswer | None) -> Iterator[str]:
    """One sentence for each strength that is left; nothing where this was not asked."""
    for one in answer.cases if answer is not None else ():
        which = f"case{'s' if len(one.cases) > 1 else ''} {listed([str(case) for case in one.cases])}"
        if one.stands == "flows":
            yield f"After liquefaction, in {which}, the continuum does not stand without shaking: {one.reason}."
        else:
            most = one.kc if one.kc_upper is None or one.kc is None else min(one.kc, one.kc_upper)
            bears = f", and bears Kh of about {coefficient(most)}" if most is not None else ""
            yield f"After liquefaction, in {which}, the continuum still stands without shaking{bears}: {one.reason}."


def sentences(answer: LiquefiedAnswer) -> Iterator[str]:
    """Every case with its numbers, for the terminal."""
    for one in answer.cases:
        which = f"Case {', '.join(map(str, one.cases))}" + (f" ({', '.join(one.names)})" if one.names else "")
        kept = ", ".join(f'"{s.name}" {s.cohesion_kPa:.3g} kPa' for s in one.strata)
        word = "still stands" if one.stands == "stands" else "flows without any shaking"
        yield f"{which}, strength left {kept}: after liquefaction it {word}; {one.reason}."
        if one.factor is not None or one.factor_lower is not None:
            yield f"    Factor of safety at Kh = 0, between held sides: {factors(one)}."
        if one.kc is not None:
            proven = f" (strict bounds {bracket(one.kc_lower, one.kc_upper, 3)})" if one.kc_lower is not None else ""
            yield f"    It still bears Kh = {one.kc:.3f}{proven}."
        for note in one.notes:
            yield f"    Mind: {note}."


def factors(case: LiquefiedCase) -> str:
    """The factor of safety with its bounds; sides are held in both, as in strength reduction without shaking."""
    told = []
    if case.factor_lower is not None or case.factor_upper is not None:
        told.append(f"{bracket(case.factor_lower, case.factor_upper, 2)} by strict bounds")
    if case.factor is not None:
        told.append(f"{case.factor:.2f} by elements")
    return ", ".join(told)


def bracket(lower: float | None, upper: float | None, digits: int) -> str:
    """Two bounds as a person reads them; a dash where one is missing."""
    return f"{number(lower, digits)} to {number(upper, digits)}"
