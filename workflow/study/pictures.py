"""Draws the pictures of a study, from its table and its answer."""

import numpy as np

from meshes.section.section import Section
from workflow.figures import study as figures
from workflow.results.study import StudyAnswer
from workflow.run.store import Store
from workflow.study.table import SampleTable


def draw_all(section: Section, table: SampleTable, answer: StudyAnswer, store: Store) -> None:
    """Write figures/study_*.png; pictures without data are left out.

    ``section``: the section of the ground; ``table``: table of all samples; ``answer``: answer of the study; ``store``:
    store of the folder with the results.
    """
    title = section.heading
    store.remove(["figures/study_*.png"])
    if answer.fails is not None:
        kc = table.column("kc")
        with store.writing("figures/study_fails.png") as path:
            figures.fails(kc[np.isfinite(kc)], answer.fails, title, path)
    if any(effect.correlation is not None for result in answer.results for effect in result.effects):
        with store.writing("figures/study_effects.png") as path:
            figures.effects(answer.results, title, path)
    if answer.fragility:
        with store.writing("figures/study_fragility.png") as path:
            figures.fragility(answer.fragility, title, path)
    first = answer.results[:1]
    slides = [result for result in answer.results[1:] if result.name.startswith("case") and not result.is_detail]
    for result in (*first, *slides):
        drawn = {effect.path: table.drawn(effect.path) for effect in result.effects}
        name = "samples" if result in first else f"samples_{result.name.split('_')[0]}"
        with store.writing(f"figures/study_{name}.png") as path:
            figures.single(result.title, table.column(result.name), drawn, title, path)
