"""The discs: the same question, then the slide.

What a script needs stands here, and is imported when it is asked for, and not before: kernels take a while.
"""

import importlib
from typing import TYPE_CHECKING, Any

from dem.errors import DemError
from dem.settings import Case, DemSettings, SlideSettings
from meshes.compiled import keep_compiled_kernels

if TYPE_CHECKING:
    from dem.engine.engine import Engine
    from dem.ground import Ground, ground_of, springs_of
    from dem.laboratory.soil_layers import soil_layers
    from dem.model import DiscModel
    from dem.search.calibration import Calibrator, calibrate
    from dem.search.critical import critical_kh
    from dem.search.deposit import deposit
    from dem.search.equilibrium import settle
    from dem.slides.liquefaction import Slider

keep_compiled_kernels()

__all__ = [
    "Calibrator",
    "Case",
    "DemError",
    "DemSettings",
    "DiscModel",
    "Engine",
    "Ground",
    "SlideSettings",
    "Slider",
    "calibrate",
    "critical_kh",
    "deposit",
    "ground_of",
    "settle",
    "soil_layers",
    "springs_of",
]

_HOME = {
    "Engine": "dem.engine.engine",
    "Ground": "dem.ground",
    "ground_of": "dem.ground",
    "springs_of": "dem.ground",
    "soil_layers": "dem.laboratory.soil_layers",
    "DiscModel": "dem.model",
    "Calibrator": "dem.search.calibration",
    "calibrate": "dem.search.calibration",
    "critical_kh": "dem.search.critical",
    "deposit": "dem.search.deposit",
    "settle": "dem.search.equilibrium",
    "Slider": "dem.slides.liquefaction",
}


def __getattr__(name: str) -> Any:
    """Import what was asked for from its own file (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'dem' has no attribute '{name}'")
    return getattr(importlib.import_module(_HOME[name]), name)
