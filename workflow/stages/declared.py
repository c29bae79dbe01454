"""Lists the declarations of all stages, in the order in which they run."""

from workflow.run.stage import Stage
from workflow.stages import (
    bounds,
    calibrate,
    faces,
    fem,
    liquefied,
    mesh,
    mpm,
    report,
    residual,
    response,
    slices,
    slide,
    triggering,
    variants,
)

STAGES: tuple[Stage, ...] = (
    triggering.STAGE, response.STAGE, mesh.STAGE, fem.STAGE, variants.STAGE, bounds.STAGE, slices.STAGE, faces.STAGE,
    residual.STAGE, liquefied.STAGE, mpm.STAGE, calibrate.STAGE, slide.STAGE, report.STAGE,
)  # fmt: skip
