"""site_response.json: response of the layers at a point to a record of the rock below."""

from typing import ClassVar

from pydantic import Field

from workflow.results.answer import Answer, Part, SectionLabel


class ResponseLayer(Part):
    """Holds a layer of the site response, and the peak values in it."""

    stratum: str
    top_m: float
    bottom_m: float
    velocity_m_s: float = Field(description="V_s at small strains")
    acceleration_gal: float = Field(description="at its top")
    strain: float = Field(description="shear strain in its middle")
    stress_kPa: float = Field(description="shear stress at its bottom")  # noqa: N815
    stiffness: float = Field(description="G over that of small strains")
    damping: float
    k_max: float = Field(description="average acceleration over g of all that lies above its bottom")


class SiteResponseAnswer(Answer):
    """Holds the results of the one-dimensional, equivalent linear site response."""

    FILE: ClassVar[str] = "site_response.json"

    section: SectionLabel
    x_m: float
    record: str
    peak_rock_gal: float
    peak_surface_gal: float
    rounds: int = Field(description="in which stiffness and damping came to rest")
    change: float = Field(description="largest change of a stiffness or a damping that one more round would make")
    warning: str = Field(description="what is to be doubted of it by its strains; empty where nothing is")
    layers: tuple[ResponseLayer, ...]
    source: str
    average_source: str = Field(description="of the average acceleration")
