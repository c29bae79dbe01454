"""The three numbers of the first page of the report, and their intervals."""

from tests.support.answers import bounds, fem, results
from tests.support.sections import analysed, slope
from workflow.report.first_page import headlines
from workflow.report.texts import Texts
from workflow.results.continuum import FactorOfSafety


def test_a_factor_of_safety_is_in_the_headline_only_with_its_error() -> None:
    """One mesh, as S-13 has it: strict bounds of its critical Kh tell its error, else the number stays in the text."""
    run = analysed(slope())
    factor = FactorOfSafety(
        kh=0.0, factor=8.84, upper=8.9, verdict="plateau", reason="", curve=(), shallow_failure=None
    )
    answer = fem(run, 0.2345).model_copy(update={"safety_factors": (factor,)})
    alone = headlines(results(run, fem=answer), Texts())[1]
    assert (alone.value, alone.interval) == ("–", "numerical error not known: one mesh, no strict bounds")
    assert "with a factor of safety of 8.84" in alone.conclusion
    told = headlines(results(run, fem=answer, bounds=bounds(run, 0.2293, 0.2349)), Texts())[1]
    assert told.value == "8.84"
    assert told.interval == "one mesh, on which the critical Kh is off by at most 3 % by strict bounds"
    meshes = answer.model_copy(update={"safety_factors": (factor.model_copy(update={"rest": 0.01}),)})
    assert headlines(results(run, fem=meshes), Texts())[1].interval == "8.75 to 8.84 by the sequence of meshes"
