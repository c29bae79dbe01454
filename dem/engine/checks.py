"""Checks the discs during a run; the message of each error names the disc and the place."""

import numpy as np

from dem.engine.energy_balance import EnergyBalance
from dem.errors import EnergyBalanceError, EscapeError, NotFiniteError, OverlapError, SpeedError
from dem.kernels.contact import ALLOWED
from dem.kernels.motion import all_finite, first_behind
from dem.model import DiscModel

BALANCE = 1e-3  # of the total energy exchanged
LARGEST_DISPLACEMENT = 0.25  # of a radius, in one step


def _name_of(model: DiscModel, disc: int) -> str:
    return (
        f"disc {disc} at x = {model.x[disc]:.4g} m, z = {model.z[disc]:.4g} m, "
        f"t = {model.time:.6g} s (step {model.steps})"
    )


def check_finite(model: DiscModel) -> None:
    """Raise NotFiniteError if a position or velocity is not a finite number."""
    if all_finite(model.x, model.z, model.vx, model.vz, model.vr):
        return
    fine = np.isfinite(model.x) & np.isfinite(model.z) & np.isfinite(model.vx) & np.isfinite(model.vz)
    fine &= np.isfinite(model.vr)
    raise NotFiniteError(
        f"{_name_of(model, int(np.argmin(fine)))} has a position or velocity that is no number; {int((~fine).sum())} "
        f"discs have such values. Check the input of this disc, or use a smaller step."
    )


def step_at_speed(model: DiscModel) -> tuple[float, int]:
    """Return the time step (s) in which the fastest disc moves by `LARGEST_DISPLACEMENT`, and this disc; (inf, -1) for
    discs at rest."""
    speed = np.hypot(model.vx_half, model.vz_half)
    disc = int(np.argmax(speed))
    if speed[disc] == 0.0:
        return np.inf, -1
    return LARGEST_DISPLACEMENT * float(model.radius.min()) / float(speed[disc]), disc


def check_speed(model: DiscModel, dt: float) -> None:
    """Raise SpeedError if a disc moves more than a quarter of the smallest radius in one step."""
    longest, disc = step_at_speed(model)
    if dt > longest:
        speed = np.hypot(model.vx_half[disc], model.vz_half[disc])
        raise SpeedError(
            f"{_name_of(model, disc)} moves at {speed:.4g} m/s, {LARGEST_DISPLACEMENT * dt / longest:.2g} of the "
            f"smallest radius in one step: it could pass through another disc. Use dt <= {longest:.3g} s, or find the "
            f"cause of this speed."
        )


def check_overlap(model: DiscModel) -> None:
    """Raise OverlapError if two discs overlap by more than their layers allow."""
    i, j = model.pair_i, model.pair_j
    mean = 0.5 * (model.radius[i] + model.radius[j])
    share = (2.0 * mean - model.distance()) / mean
    allowed = 2.0 * model.springs.pairs[ALLOWED, model.kind(i, j)]
    if len(share) and np.any(share > allowed):
        c = int(np.argmax(share - allowed))
        raise OverlapError(
            f"{_name_of(model, int(i[c]))} and disc {j[c]} overlap by {share[c]:.3g} of their mean radius, "
            f"allowed is {allowed[c]:.3g}. Stiffen their layers, or allow more with `allowed_overlap`."
        )
    before, _ = line_gaps(model)
    share = -before / model.radius[model.line_disc]
    allowed = 2.0 * model.springs.lines[ALLOWED, model.line_kind]
    if len(share) and np.any(share > allowed):
        c = int(np.argmax(share - allowed))
        raise OverlapError(
            f"{_name_of(model, int(model.line_disc[c]))} overlaps rigid line {model.line_id[c]} by {share[c]:.3g} "
            f"of its radius, allowed is {allowed[c]:.3g}. Find the cause, or allow more with `allowed_overlap`."
        )


def line_gaps(model: DiscModel) -> tuple[np.ndarray, np.ndarray]:
    """Return the gap (m) between rigid lines and the circumference of nearby discs, and the position (m) of each disc
    along the line.
    """
    line = model.lines[model.line_id]
    px, pz = model.x[model.line_disc] - line[:, 0], model.z[model.line_disc] - line[:, 1]
    gap = px * line[:, 2] + pz * line[:, 3] - model.radius[model.line_disc]
    along = pz * line[:, 2] - px * line[:, 3]
    gap[(along < line[:, 4]) | (along > line[:, 5])] = np.inf
    return gap, along


def check_escape(model: DiscModel) -> None:
    """Raise EscapeError if the centre of a disc has passed a rigid line by a radius or more."""
    line, disc = first_behind(model.x, model.z, model.radius, model.fixed, model.lines)
    if disc >= 0:
        raise EscapeError(
            f"{_name_of(model, disc)} has passed rigid line {line}. The boundary did not stop it: use a smaller step, "
            f"or stiffer springs in the adjacent layer."
        )


def check_balance(model: DiscModel, energies: EnergyBalance, tolerance: float) -> None:
    """Raise EnergyBalanceError if more than `tolerance` of the total energy exchanged is unaccounted for.

    model: model of the discs; energies: balance since the start.
    """
    if not abs(energies.gap) <= tolerance * energies.turnover:
        speed = np.hypot(model.vx, model.vz) * np.sqrt(model.mass) * ~model.fixed
        disc = int(np.argmax(speed))
        raise EnergyBalanceError(
            f"the energy balance has a gap of {energies.gap:.4g} J/m, of {energies.turnover:.4g} J/m exchanged "
            f"(allowed share {tolerance:g}); {_name_of(model, disc)} has the largest kinetic energy. Take a smaller "
            f"step, or allow more with `balance`."
        )
