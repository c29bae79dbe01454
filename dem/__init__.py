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
    from dem.laboratory.soil_contacts import SoilContacts, soil_contacts
    from dem.laboratory.soil_layers import soil_layers
    from dem.model import DiscModel
    from dem.problems.column import SoilColumn
    from dem.problems.uniform_slope import UniformSlope
    from dem.search.calibration import Calibrator, calibrate
    from dem.search.critical import critical_kh
    from dem.search.deposit import deposit
    from dem.search.equilibrium import settle
    from dem.slides.liquefaction import Slider
    from dem.slides.runout import RunOut, connected_ground, deposit_profile, loose_share, mass_quantile, run_out
    from dem.slides.until_rest import UntilRest, run_until_rest
    from dem.springs import SMOOTH, Strength, soil_discs

keep_compiled_kernels()

__all__ = [
    "SMOOTH",
    "Calibrator",
    "Case",
    "DemError",
    "DemSettings",
    "DiscModel",
    "Engine",
    "Ground",
    "RunOut",
    "SlideSettings",
    "Slider",
    "SoilColumn",
    "SoilContacts",
    "Strength",
    "UniformSlope",
    "UntilRest",
    "calibrate",
    "connected_ground",
    "critical_kh",
    "deposit",
    "deposit_profile",
    "ground_of",
    "loose_share",
    "mass_quantile",
    "run_out",
    "run_until_rest",
    "settle",
    "soil_contacts",
    "soil_discs",
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
    "SoilContacts": "dem.laboratory.soil_contacts",
    "soil_contacts": "dem.laboratory.soil_contacts",
    "SoilColumn": "dem.problems.column",
    "UniformSlope": "dem.problems.uniform_slope",
    "RunOut": "dem.slides.runout",
    "connected_ground": "dem.slides.runout",
    "deposit_profile": "dem.slides.runout",
    "loose_share": "dem.slides.runout",
    "mass_quantile": "dem.slides.runout",
    "run_out": "dem.slides.runout",
    "UntilRest": "dem.slides.until_rest",
    "run_until_rest": "dem.slides.until_rest",
    "SMOOTH": "dem.springs",
    "Strength": "dem.springs",
    "soil_discs": "dem.springs",
}


def __getattr__(name: str) -> Any:
    """Import what was asked for from its own file (PEP 562)."""
    if name not in _HOME:
        raise AttributeError(f"module 'dem' has no attribute '{name}'")
    return getattr(importlib.import_module(_HOME[name]), name)
