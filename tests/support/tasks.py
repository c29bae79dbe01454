"""Provides tasks with known answers; workers import them from here."""

import math
import os
import signal
import time
from pathlib import Path

from pydantic import BaseModel

from meshes.errors import NoAnswerError


class Numbers(BaseModel):
    """Holds some numbers, and a folder for traces of the computation."""

    values: tuple[float, ...]
    folder: str = ""


class Number(BaseModel):
    """Holds one number."""

    value: float


def total(inputs: Numbers) -> Number:
    """Return the sum of the numbers; raise an error if one is negative."""
    if min(inputs.values) < 0.0:
        raise NoAnswerError("a number is negative", "take its absolute value")
    return Number(value=sum(inputs.values))


def ishigami(inputs: Numbers) -> Number:
    """Return the function of Ishigami and Homma (1990): sin x1 + 7 sin² x2 + 0.1 x3⁴ sin x1."""
    x1, x2, x3 = inputs.values
    return Number(value=math.sin(x1) + 7.0 * math.sin(x2) ** 2 + 0.1 * x3**4 * math.sin(x1))


def slow_total(inputs: Numbers) -> Number:
    """Return the sum after a twentieth of a second; write a line at every start."""
    with (Path(inputs.folder) / f"{inputs.values}").open("a") as file:
        file.write("begun\n")
    time.sleep(0.05)
    return total(inputs)


def waiting_total(inputs: Numbers) -> Number:
    """Return the sum as `slow_total` does; sums of 20 and more wait for a file `go`."""
    while inputs.values[0] >= 20.0 and not (Path(inputs.folder) / "go").exists():
        time.sleep(0.01)
    return slow_total(inputs)


def dies_once(inputs: Numbers) -> Number:
    """Return the sum; the first worker that tries is killed."""
    return _dies(inputs, times=1)


def dies_always(inputs: Numbers) -> Number:
    """Kill every process that tries."""
    return _dies(inputs, times=1000)


def _dies(inputs: Numbers, times: int) -> Number:
    traces = Path(inputs.folder) / "tries"
    traces.mkdir(exist_ok=True)
    tried = len(list(traces.iterdir()))
    (traces / str(tried)).touch()
    if tried < times:
        os.kill(os.getpid(), signal.SIGKILL)
    return total(inputs)


def breaks(inputs: Numbers) -> Number:
    """Raise an error of the program."""
    raise ZeroDivisionError("what no one expected")


def infinite_slope(inputs: Numbers) -> Number:
    """Return the critical Kh of a dry infinite slope of 20 degrees, 5 m deep, 18 kN/m³; values are c (kPa) and φ
    (degrees).

    By limit equilibrium on a plane parallel to the ground, kc = (c / (γ z cos² β) + tan φ - tan β) / (1 + tan β tan φ).
    """
    cohesion, friction = inputs.values
    slope, strength = math.tan(math.radians(20.0)), math.tan(math.radians(friction))
    fixed = cohesion / (18.0 * 5.0 * math.cos(math.radians(20.0)) ** 2)
    return Number(value=(fixed + strength - slope) / (1.0 + slope * strength))
