"""States the results of a run in a few lines, which the command prints."""

from workflow.report.crests import crests_in_short
from workflow.report.verdicts import verdict_paragraph
from workflow.results.summary import Summary
from workflow.results.verdicts import NOTE_WEIGHT
from workflow.texts.report_texts import Texts

NO_NUMBER = "–"  # the value of a headline that has none, only its reason
MOST_LINES = 9  # of a run without -v, after the one on its time, before the two that say where the report is


def run_lines(answer: Summary, texts: Texts | None = None) -> list[str]:
    """Return the results of a run in a few lines, in the language of its report.

    The lines are three numbers, crests, criteria, the first stage without an answer, and as many warnings as fit in
    nine lines.

    Parameters
    ----------
    answer : summary of the run
    texts : texts in the language of the report; None for English

    Returns
    -------
    One line each; the last line counts the warnings that are left out.
    """
    _ = texts or Texts()
    lines = [
        f"{part.name}: {part.value}" + (f"; {part.interval}" if part.interval else "")
        if part.value != NO_NUMBER else part.conclusion
        for part in answer.headlines
    ]  # fmt: skip
    lines += crests_in_short(answer.crests or (), _)
    lines += verdict_paragraph(list(answer.criteria or ()), _, liquefies=bool(answer.liquefied or answer.cases))
    for stage, entry in list(answer.no_answer.items())[:1]:
        lines.append(_("the stage {stage} has no answer: {reason}", stage=stage, reason=entry.reason))
    warnings = [
        " ".join(_.sentence(text) for text in (part.observation, part.remedy) if text)
        for part in answer.warnings
        if part.weight < NOTE_WEIGHT
    ]
    shown = warnings[: max(MOST_LINES - len(lines) - 1, 0)]
    lines += [f"- {line}" for line in shown]
    if len(warnings) > len(shown):
        number = len(warnings) - len(shown)
        lines.append(_.sentence(f"{number} more {'warning is' if number == 1 else 'warnings are'} in the report."))
    return lines
