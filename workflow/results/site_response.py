"""Stores the response of the layers at a point to a record of the rock below in site_response.json."""

from typing import ClassVar

from pydantic import Field

from workflow.results.answer import Answer, Part, SectionLabel


class ResponseLayer(Part):
    """Holds a layer of the site response, and the peak values in it."""

    stratum: str = Field(description="name of the stratum")
    top_m: float = Field(description="depth of the top of the layer below the ground surface")
    bottom_m: float = Field(description="depth of the bottom of the layer below the ground surface")
    velocity_m_s: float = Field(description="shear wave velocity V_s at small strains")
    acceleration_gal: float = Field(description="peak acceleration at the top of the layer")
    strain: float = Field(description="peak shear strain in the middle of the layer")
    stress_kPa: float = Field(description="peak shear stress at the bottom of the layer")  # noqa: N815
    stiffness: float = Field(description="shear modulus G over that at small strains, at the last iteration")
    damping: float = Field(description="damping ratio at the last iteration")
    k_max: float = Field(
        description="peak of the average acceleration over g of all ground above the bottom of the layer"
    )


class SiteResponseAnswer(Answer):
    """Holds the results of the one-dimensional, equivalent linear site response."""

    FILE: ClassVar[str] = "site_response.json"

    section: SectionLabel = Field(description="section of the layers")
    x_m: float = Field(description="x of the column of layers")
    record: str = Field(description="name of the record of the rock")
    peak_rock_gal: float = Field(description="peak acceleration of the rock where it crops out")
    peak_surface_gal: float = Field(description="peak acceleration of the ground surface")
    rounds: int = Field(description="number of iterations until stiffness and damping no longer changed")
    change: float = Field(description="largest relative change of a stiffness or a damping by one more iteration")
    warning: str = Field(description="warning about large strains; empty if there is none")
    layers: tuple[ResponseLayer, ...] = Field(description="layers from the surface down; a thick stratum has several")
    source: str = Field(description="source of the method and of the curves of stiffness and damping")
    average_source: str = Field(description="source of the average acceleration")
