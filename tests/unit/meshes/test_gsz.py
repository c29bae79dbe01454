"""Models of GeoStudio as sections. The file is made here, in the form of theirs."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from meshes.errors import InputError
from meshes.models.gsz_file import read_gsz
from meshes.section.section import Section
from tests.support.command_line import run

POINTS = {1: (0, 0), 2: (60, 0), 3: (60, 10), 4: (40, 10), 5: (20, 20), 6: (0, 20), 7: (0, 6), 8: (60, 6)}
DOCUMENT = """<GSIData>
<Coordinates><EngCoords UnitSystem="{system}"/></Coordinates>
<Analyses>
 <Analysis><ID>1</ID><Name>Flow</Name><Kind>SEEP/W</Kind><GeometryId>1</GeometryId></Analysis>
 <Analysis><ID>2</ID><Name>Slope</Name><Kind>SLOPE/W</Kind><GeometryId>1</GeometryId></Analysis>
 <Analysis><ID>3</ID><Name>Shaken</Name><Kind>SLOPE/W</Kind><GeometryId>1</GeometryId></Analysis>
</Analyses>
<Geometries><Geometry><Points>{points}</Points><Regions>
 <Region><ID>1</ID><PointIDs>7,8,3,4,5,6</PointIDs></Region>
 <Region><ID>2</ID><PointIDs>1,2,8,7</PointIDs></Region>
</Regions></Geometry></Geometries>
<Materials>
 <Material><ID>1</ID><Name>Fill</Name><SlopeModel>MohrCoulomb</SlopeModel>
  <StressStrain><UnitWeight>20</UnitWeight><CohesionPrime>5</CohesionPrime><PhiPrime>30</PhiPrime></StressStrain></Material>
 <Material><ID>2</ID><Name>Clay</Name><SlopeModel>UndrainedPhiZero</SlopeModel>
  <StressStrain><UnitWeight>18</UnitWeight><Cohesion>40</Cohesion></StressStrain></Material>
</Materials>
<Contexts><Context><AnalysisID>2</AnalysisID><GeometryUsesMaterials>
 <GeometryUsesMaterial ID="Regions-1" Entry="1"/><GeometryUsesMaterial ID="Regions-2" Entry="2"/>
</GeometryUsesMaterials></Context></Contexts>
<StabilityItems><StabilityItem><AnalysisID>2</AnalysisID><Entry>
 <Seismic Horizontal="0.15"/>
 <DataPoints><DataPoint Number="1" X="0" Y="14"/><DataPoint Number="2" X="60" Y="9"/></DataPoints>
 <PiezometricSurfaces><PiezometricSurface><ID>1</ID><DataPoints><DataPoint>1</DataPoint><DataPoint>2</DataPoint></DataPoints>
 </PiezometricSurface></PiezometricSurfaces>
 <MaterialUsesPiezs><MaterialUsesPiez ID="1" UsesID="1"/></MaterialUsesPiezs>
 <TensionCrack><TensionOption>Surface</TensionOption></TensionCrack>
</Entry></StabilityItem></StabilityItems>
</GSIData>"""


def written(folder: Path, system: str = "metric", change: tuple[str, str] = ("", "")) -> Path:
    points = "".join(f'<Point ID="{k}" X="{x}" Y="{y}"/>' for k, (x, y) in POINTS.items()) + '<Point ID="9"/>'
    path = folder / "slope.gsz"
    with zipfile.ZipFile(path, "w") as archive:
        text = DOCUMENT.format(system=system, points=points).replace(*change)
        archive.writestr("slope.xml", text.replace("<UnitWeight>", "<UnitWeight>1") if system == "imperial" else text)
        archive.writestr("Slope/001/slope.xml", "<Copy/>")
    return path


def test_a_slope_is_a_section(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("section", written(tmp_path), "-o", tmp_path / "slope.toml") == 0
    out = capsys.readouterr().out
    for text in ("It is sound.", 'analysis "Slope"', "analyses Shaken", "tension crack", "Kh = 0.15", "stiffness"):
        assert text in out
    section = Section.read(tmp_path / "slope.toml")
    fill, _, clay = section.strata
    assert (fill.name, fill.cohesion, clay.name, clay.cohesion, clay.friction_angle) == ("Fill", 5e3, "Clay", 40e3, 0.0)
    assert section.layering.areas().sum() == pytest.approx(60.0 * 10.0 + 10.0 * 20.0 + 0.5 * 10.0 * 20.0)
    at = np.array([[30.0, 8.0], [30.0, 3.0]])  # the clay has no water of its own
    pressure = section.water_pressure.at_rest(at, at, section.stratum_at(*at.T))
    np.testing.assert_allclose(pressure, [9807.0 * 3.5, 0.0])


def test_feet_and_pounds(tmp_path: Path) -> None:
    imported_section = read_gsz(written(tmp_path, "imperial"), "slope")
    (tmp_path / "slope.toml").write_text(imported_section.text)
    section = Section.read(tmp_path / "slope.toml")
    assert section.ground[0, 1] == pytest.approx(20 * 0.3048)
    assert section.strata[0].cohesion == pytest.approx(5 * 47.88026)


def test_bad_models_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r'"Rain": expected an analysis of .*, one of Slope, Shaken'):
        read_gsz(written(tmp_path), "slope", "Rain")
    with pytest.raises(InputError, match=r"or have another form \(no StabilityItem of analysis 3\)"):
        read_gsz(written(tmp_path), "slope", "Shaken")  # no context
    with pytest.raises(InputError, match="a point whose coordinates are not numbers"):
        read_gsz(written(tmp_path, change=('ID="1" X="0"', 'ID="1" X="nan"')), "slope")
    with pytest.raises(InputError, match=r"the analyses in it are of SEEP/W$"):
        read_gsz(written(tmp_path, change=("SLOPE/W", "SEEP/W")), "slope")
    path = written(tmp_path)
    path.write_bytes(path.read_bytes().replace(b"<GSIData>", b"<GSIDeta>"))
    with pytest.raises(InputError, match="cannot be read: Bad CRC-32"):
        read_gsz(path, "slope")
    path = tmp_path / "none.gsz"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("a.xml", '<!DOCTYPE a [<!ENTITY b "c">]><GSIData/>')
    with pytest.raises(InputError, match="defines entities"):
        read_gsz(path, "slope")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("<Name>Clay", "<Name>Fill"), "It is sound."),
        (('ID="Regions-2" Entry="2"', ""), "not read: region 2, which has no material"),
        (("UndrainedPhiZero", "SFnDepth"), "cohesion: expected a cohesion"),
    ],
)
def test_what_a_model_has_otherwise(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], change: tuple[str, str], message: str
) -> None:
    """Materials of one name keep what they have, regions without material and strength by functions are told."""
    assert run("section", written(tmp_path, change=change), "-o", tmp_path / "slope.toml") == 0
    assert message in capsys.readouterr().out
    if change[1] == "<Name>Fill":
        section = Section.read(tmp_path / "slope.toml")
        assert {(s.density_ordinary, s.cohesion) for s in section.strata} == {
            (20e3 / 9.80665, 5e3),
            (18e3 / 9.80665, 40e3),
        }


def test_what_an_analysis_has_beside_what_is_read_is_listed(tmp_path: Path) -> None:
    """The vertical coefficient of an earthquake was dropped without a word, and so was every part that is not known."""
    change = ('<Seismic Horizontal="0.15"/>', '<Seismic Horizontal="" Vertical="0.07"/><PressureLines Len="1"/>')
    notices = read_gsz(written(tmp_path, change=change), "slope").notices
    assert any(text.startswith("not taken: the vertical earthquake, Kv = 0.07") for text in notices)
    assert "not read: PressureLines of the analysis" in notices
