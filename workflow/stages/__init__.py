"""Contains the stages of a run, one file for each, which ends with its STAGE. Heavy packages are only imported inside
functions.

The program therefore starts quickly, and each command needs only the packages that it uses. Work that is too long for
one file, or common to two stages, is in other files: bearing, calibrated_discs, liquefied_slides, random_packings,
sliding.
"""

# Names of the stages in the order in which they run: the help names them without importing the stages.
NAMES = (
    "triggering", "response", "mesh", "fem", "variants", "bounds", "slices", "faces", "residual", "liquefied", "mpm",
    "calibrate", "slide", "report",
)  # fmt: skip


def command_of(stage: str) -> str:
    """Return the command that runs a stage.

    Parameters
    ----------
    stage : name of the stage

    Returns
    -------
    Name of the command, such as "liquefaction" for "triggering"; the name of the stage where no other is known.
    """
    return {"triggering": "liquefaction", "mpm": "slide"}.get(stage, stage)
