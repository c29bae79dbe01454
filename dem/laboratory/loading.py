"""Loads a patch quasi-statically: confinement, small strains, compression, shear.

In stress-controlled directions the strain rate is proportional to the error of the stress and its integral (servo
control). Pressures are positive (Pa); strains are the strains of the frame.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from dem.errors import ConfinementError, DemError
from dem.laboratory.patch import Patch, StrainControl, StressState
from dem.laboratory.plane_elastic import PlaneElastic, lattice_elastic

LoadingKind = Literal["biaxial", "simple shear"]

REST_TOLERANCE = 1e-3  # of the pressure, and of the mean contact force
LONGEST_SETTLING = 20_000.0  # time units in which a patch must come to rest
CONFINING_RATE = 1e-3  # strain per time unit while confined
# Approximate stress of a probe over the pressure: well above the remaining unbalanced stress, and without slip.
PROBE_STRESS = 1e-2
PROBE_TIME, HOLD_TIME = 20.0, 60.0  # time units
INTERVALS = 160  # of a test: the servo corrects as often
GROWTH = 40.0  # intervals until one is twice as long as the first: a stiff patch is strong early, a soft one late
AVERAGE = 2  # intervals in a record
PAST_PEAK = 2.0, 0.95  # a test ends at this multiple of the peak's strain, if no more than this share of it is left
LARGEST_LATERAL_RATE = 10.0  # times the prescribed rate, at most: a lattice of rigid discs spreads at three times it
REACTION, MEMORY = 1.2, 2.0  # intervals in which the servo takes back an error, and a steady one


@dataclass(frozen=True)
class Curve:
    """Holds the records of a test.

    Attributes
    ----------
    kind : kind of the test
    pressure : constant stress during the test (Pa, compression positive)
    strain (n,) : axial compression (natural strain), or shear strain gamma
    stress (n, 2, 2) : mean stress in the region (Pa, tension positive)
    volumetric (n,) : volumetric strain, positive for growth of the area (natural strain)
    unbalanced (n,) : mean unbalanced force over mean contact force
    cracked (n,) : share of the pore springs that are cracked
    rate : strain rate (1/s)
    stopped : reason why the test ended before the largest strain; empty if it reached the largest strain
    """

    kind: LoadingKind
    pressure: float
    strain: np.ndarray
    stress: np.ndarray
    volumetric: np.ndarray
    unbalanced: np.ndarray
    cracked: np.ndarray
    rate: float
    stopped: str

    @property
    def principal(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the major and the minor principal stress, compression positive (Pa)."""
        values = np.linalg.eigvalsh(-0.5 * (self.stress + self.stress.swapaxes(1, 2)))
        return values[:, 1], values[:, 0]

    @property
    def deviator(self) -> np.ndarray:
        """Return the difference of the principal stresses (Pa)."""
        major, minor = self.principal
        return major - minor

    @property
    def shear(self) -> np.ndarray:
        """Return the shear stress sigma_xz on the horizontal plane (Pa), positive in the direction in which the upper
        side moves.
        """
        return self.stress[:, 0, 1]

    @property
    def resistance(self) -> np.ndarray:
        """Return the resistance whose peak is the strength: the deviator, or the shear stress (Pa)."""
        return self.deviator if self.kind == "biaxial" else self.shear


def confine(patch: Patch, pressure: float) -> None:
    """Bring a patch to rest under a pressure that is equal on all sides, without shear stress.

    Raises ConfinementError if the patch does not come to rest, OverlapError if its discs are too soft.
    """
    modulus = lattice_elastic(patch.model.springs.layers[0], pores=False).M
    unit = patch.time_unit
    with StrainControl(patch) as press:
        for _ in range(int(LONGEST_SETTLING / 3.0)):
            now = patch.stress_state()
            error = 0.5 * (now.stress + now.stress.T) + pressure * np.eye(2)
            if np.abs(error).max() < REST_TOLERANCE * pressure and now.unbalanced < REST_TOLERANCE:
                break
            limit = CONFINING_RATE / unit
            press.strain(np.clip(-error / (3.0 * unit * modulus), -limit, limit), 3.0 * unit)
        else:
            raise ConfinementError(
                f"the patch does not come to rest at {pressure:g} Pa: largest error of its stress "
                f"{np.abs(error).max():.3g} Pa, unbalanced ratio {now.unbalanced:.3g}. Take another seed "
                "or a larger patch."
            )
        press.turn_to(np.zeros((2, 2)))


def probe(patch: Patch, pressure: float) -> tuple[PlaneElastic, float]:
    """Measure the tangent stiffness of a confined patch by three small strains, each constant until the patch is at
    rest. Also return M_xx / M_zz - 1.

    The response of a copy without strain is subtracted, since the state of rest is not perfect. Raises ConfinementError
    if the result is not the stiffness of a stable body, since then the patch still rearranges.
    """
    size = PROBE_STRESS * pressure / lattice_elastic(patch.model.springs.layers[0]).M
    directions = {"none": np.zeros((2, 2)), "x": np.diag([-1.0, 0.0]), "z": np.diag([0.0, -1.0])}
    directions["shear"] = np.array([[0.0, 0.5], [0.5, 0.0]])
    responses = {}
    for name, direction in directions.items():
        probed = patch.copy()
        unit = patch.time_unit
        with StrainControl(probed) as press:
            press.strain(direction * size / (PROBE_TIME * unit), PROBE_TIME * unit)
            press.strain(np.zeros((2, 2)), HOLD_TIME * unit)
        responses[name] = probed.stress_state().stress / size
    x, z, shear = (responses[name] - responses["none"] for name in ("x", "z", "shear"))
    stiffness = PlaneElastic(
        M=-0.5 * float(x[0, 0] + z[1, 1]), lame=-0.5 * float(x[1, 1] + z[0, 0]),
        G=0.5 * float(shear[0, 1] + shear[1, 0]),
    )  # fmt: skip
    if not (abs(stiffness.lame) < stiffness.M and stiffness.G > 0.0):
        raise ConfinementError(
            f"the patch still rearranges at {pressure:g} Pa and has no stiffness: M = {stiffness.M:.3g}, λ = "
            f"{stiffness.lame:.3g}, G = {stiffness.G:.3g} Pa. Take another seed or a larger patch."
        )
    return stiffness, float(x[0, 0] / z[1, 1]) - 1.0


def load(
    patch: Patch,
    kind: LoadingKind,
    pressure: float,
    strain: float,
    rate: float,
    stiffness: PlaneElastic,
    to_the_end: bool = False,
) -> Curve:
    """Load a confined patch up to `strain`, at `rate` (strain per time unit of the patch), and return the records.

    Biaxial: compression along z under constant lateral stress. Simple shear: no strain along x, constant vertical
    stress. A test ends well past its peak, or with `to_the_end` at the largest strain; if it cannot continue, `stopped`
    has the reason. kind: kind of the test; pressure: confining stress (Pa); stiffness: plane elastic constants of the
    confined patch.
    """
    per_second = rate / patch.time_unit
    lengths = 1.0 + np.arange(INTERVALS) / GROWTH
    lengths *= strain / per_second / lengths.sum()
    drive = np.diag([0.0, -per_second]) if kind == "biaxial" else np.array([[0.0, per_second], [0.0, 0.0]])
    lateral_axis = 0 if kind == "biaxial" else 1
    steady = per_second * stiffness.nu_2d if kind == "biaxial" else 0.0
    bonds = max(1, int((patch.model.pore_length != 0.0).sum()))
    rows: list[np.ndarray] = []
    stopped = ""
    with StrainControl(patch) as press:
        try:
            now = patch.stress_state()
            for interval in lengths:
                wanted = -(now.stress[lateral_axis, lateral_axis] + pressure) / (stiffness.M * REACTION * interval)
                steady += wanted / MEMORY
                drive[lateral_axis, lateral_axis] = np.clip(
                    wanted + steady, -LARGEST_LATERAL_RATE * per_second, LARGEST_LATERAL_RATE * per_second
                )
                press.strain(drive, interval)
                now = patch.stress_state()
                rows.append(_record(patch.deformation, kind, now, bonds))
                if not to_the_end and _is_over(rows, kind):
                    break
        except DemError as error:
            stopped = str(error)
    records = np.array(rows)[: len(rows) // AVERAGE * AVERAGE].reshape(-1, AVERAGE, 8).mean(axis=1)
    return Curve(
        kind, pressure, records[:, 0], records[:, 1:5].reshape(-1, 2, 2), records[:, 5], records[:, 6], records[:, 7],
        per_second, stopped,
    )  # fmt: skip


def _is_over(rows: list[np.ndarray], kind: LoadingKind) -> bool:
    """Return whether the last record is well past the peak."""
    if len(rows) % AVERAGE or len(rows) < INTERVALS // 4:
        return False
    means = np.array(rows).reshape(-1, AVERAGE, len(rows[0])).mean(axis=1)
    xx, xz, zx, zz = means[:, 1:5].T
    resistance = np.hypot(xx - zz, xz + zx) if kind == "biaxial" else xz
    at = int(np.argmax(resistance))
    strain, left = PAST_PEAK
    return bool(means[-1, 0] > strain * means[at, 0] and resistance[-1] < left * resistance[at])


def _record(f: np.ndarray, kind: LoadingKind, now: StressState, bonds: int) -> np.ndarray:
    strain = -np.log(f[1, 1]) if kind == "biaxial" else f[0, 1] / f[1, 1]
    return np.array([strain, *now.stress.ravel(), np.log(np.linalg.det(f)), now.unbalanced, now.cracked / bonds])
