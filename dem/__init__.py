"""Computes ground as discs (discrete element method): the critical seismic coefficient, and slides after liquefaction.
Soil discs (law "soil") have contacts fitted to the strength and stiffness of the soil. Discs with the law "paper" are
those of the paper on the section S-13 (docs/theory/paper.md), in which springs stand for contacts, and breakable
springs for pore water. Names are imported when they are first used, since kernels take a while to load.
"""

from typing import TYPE_CHECKING

from meshes.compiled import keep_compiled_kernels
from meshes.exports import exports

if TYPE_CHECKING:
    from dem.assembly import DiscBoundary, DiscGeometry, DiscMaterials
    from dem.case import Case
    from dem.engine.engine import Engine
    from dem.errors import DemError
    from dem.ground import Ground, ground_of, springs_of
    from dem.laboratory.soil_contacts import SoilContacts, soil_contacts, soil_layers
    from dem.model import DiscModel
    from dem.search.calibration import calibrate
    from dem.search.calibrator import Calibrator
    from dem.search.critical import critical_kh
    from dem.search.deposit import deposit
    from dem.search.equilibrium import settle
    from dem.settings import DemSettings, SlideSettings
    from dem.slides.column import SoilColumn
    from dem.slides.liquefaction import Slider
    from dem.slides.runout import RunOut, connected_ground, deposit_profile, loose_share, mass_quantile, run_out
    from dem.slides.until_rest import UntilRest, run_until_rest
    from dem.springs import SMOOTH, Strength, soil_discs

keep_compiled_kernels()
__all__, __getattr__ = exports(__name__, __file__)
