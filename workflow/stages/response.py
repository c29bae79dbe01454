"""Defines the stage `response`: response of the layers at a point to a record of the rock below."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from meshes.section.section import Section
from workflow.earthquake.attenuation import GAL
from workflow.earthquake.column import MAKDISI, ResponseColumn, column_of
from workflow.earthquake.site_response import SOURCE
from workflow.results.answer import SectionLabel
from workflow.results.site_response import ResponseLayer, SiteResponseAnswer
from workflow.run.stage import Job, Stage

PICTURE = "figures/site_response.png"


def work(job: Job) -> None:
    """Compute the equivalent linear site response; writes site_response.json. Raises InputError."""
    answer_of(job.config.section, column_of(job.config.section, job.config.site_response)).write(job.store)


def draw(job: Job) -> None:
    """Draw acceleration, strain, stress and the average acceleration with depth."""
    from workflow.figures import site_response

    job.store.save(PICTURE, site_response.draw(job.config.section, SiteResponseAnswer.read(job.store)))


def answer_of(section: Section, column: ResponseColumn) -> SiteResponseAnswer:
    """Return the site response of a column of layers with its largest strains and accelerations, as it is stored."""
    response = column.response
    layers = tuple(
        ResponseLayer.taken(
            layer,
            stratum=column.strata[j],
            top_m=float(response.depth[j]),
            bottom_m=float(response.depth[j + 1]),
            velocity_m_s=layer.velocity,
            acceleration_gal=float(response.acceleration[j]) / GAL,
            strain=float(response.strain[j]),
            stress_kPa=float(response.stress[j]) / 1e3,
            k_max=float(response.k_max[j]),
        )
        for j, layer in enumerate(response.layers)
    )
    return SiteResponseAnswer.taken(
        response,
        section=SectionLabel.of(section),
        x_m=column.x,
        record=column.record,
        peak_rock_gal=float(np.abs(column.outcrop).max()) / GAL,
        peak_surface_gal=layers[0].acceleration_gal,
        layers=layers,
        source=SOURCE,
        average_source=MAKDISI,
    )


def files(job: Job) -> Mapping[str, Path]:
    """Return the file of the record. The content of this file, not its path, decides whether the stage is out of
    date."""
    record = job.config.site_response.record
    return {"site_response, record": Path(record)} if record else {}


STAGE = Stage(
    name="response",
    description="layers under a record of the rock",
    work=work,
    draw=draw,
    drawn_after=True,
    reads=("site_response",),
    ignores=lambda config: ("site_response.record", "site_response.slip_depth"),
    files=files,
    results=(SiteResponseAnswer.FILE,),
    read=SiteResponseAnswer.read,
    pictures=(PICTURE,),
    unwanted=lambda config: (
        "" if config.site_response.record else "no record of the rock is given (site_response.record)"
    ),
)
