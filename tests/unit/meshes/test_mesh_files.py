"""Files of meshes: what others read in them, and what is refused by its place."""

from pathlib import Path
from typing import Any

import gmsh
import meshio
import numpy as np
import pytest

from meshes import gmsh_model
from meshes.errors import InputError
from meshes.executor import SERIAL
from meshes.gmsh_model import generate
from meshes.quad_mesh import BadMeshError, QuadMesh, check, read, save
from meshes.quality import corner_angles
from meshes.section.naming import BOUNDARIES
from meshes.section.section import Section
from meshes.settings import MeshSettings
from tests.support.meshes import SHIPPED, free, grid, s13
from tests.support.sections import assert_conforming, layer, slope
from workflow.results.stored_mesh import given_mesh


@pytest.mark.parametrize("file", SHIPPED, ids=lambda path: path.stem)
def test_meshio_finds_the_same_groups(file: Path, tmp_path: Path) -> None:
    section = Section.read(file)
    mesh = generate(section, path=tmp_path / "section.msh")
    raw = meshio.read(tmp_path / "section.msh")
    assert set(raw.field_data) == {*mesh.strata, *BOUNDARIES}
    again = read(tmp_path / "section.msh")
    assert again.strata == mesh.strata
    assert set(again.boundaries) == set(mesh.boundaries) == set(BOUNDARIES)
    np.testing.assert_allclose(again.stratum_areas(), mesh.stratum_areas(), rtol=1e-12)
    for name, edges in mesh.boundaries.items():
        ends = [sorted(mesh.points[edge].tolist()) for edge in edges]
        again_ends = [sorted(again.points[edge].tolist()) for edge in again.boundaries[name]]
        np.testing.assert_allclose(sorted(again_ends), sorted(ends), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("writer", ["generate", "save"])
def test_reading_gives_what_was_written_exactly(tmp_path: Path, writer: str) -> None:
    mesh = generate(s13(), grid(), tmp_path / "section.msh")
    if writer == "save":
        save(mesh, tmp_path / "section.msh")
    again = read(tmp_path / "section.msh")
    assert (again.strata, len(again.cells)) == (mesh.strata, len(mesh.cells))
    corners, written = (np.sort(item.points[item.cells].mean(axis=1), axis=0) for item in (mesh, again))
    np.testing.assert_allclose(written, corners, rtol=1e-14, atol=1e-12)
    np.testing.assert_allclose(again.stratum_areas(), mesh.stratum_areas(), rtol=1e-12)
    assert {name: len(ends) for name, ends in again.boundaries.items()} == {
        name: len(ends) for name, ends in mesh.boundaries.items()
    }


def test_a_dam_that_thins_out_on_its_base_is_read_again_without_a_right_side(tmp_path: Path) -> None:
    surface = [[0.0, 10.0], [10.0, 10.0], [40.0, 0.0], [50.0, 0.0]]
    dam = layer("dam", cohesion="15 kPa", friction_angle="30 deg")
    section = Section.parse({"name": "dam", "surface": surface, "base": {"elevation": 0.0}, "strata": [dam]})
    mesh = generate(section, MeshSettings(), tmp_path / "section.msh")
    save(mesh, tmp_path / "saved.msh")
    again = read(tmp_path / "saved.msh")
    assert again.boundaries["right"].shape == (0, 2)
    assert {name: len(ends) for name, ends in again.boundaries.items()} == {
        name: len(ends) for name, ends in mesh.boundaries.items()
    }


def test_gmsh_opens_its_file_again(tmp_path: Path) -> None:
    mesh = generate(s13(), grid(), tmp_path / "section.msh")
    with gmsh_model.session("again"):
        gmsh.merge(str(tmp_path / "section.msh"))
        names = {gmsh.model.getPhysicalName(dimension, tag) for dimension, tag in gmsh.model.getPhysicalGroups()}
        assert names == {*mesh.strata, *BOUNDARIES}
        assert len(gmsh.model.mesh.getElementsByType(3)[0]) == 611


def test_dolfinx_reads_the_file(tmp_path: Path) -> None:
    pytest.importorskip("dolfinx", exc_type=ImportError)
    from mpi4py import MPI

    try:
        from dolfinx.io import gmsh as reader
    except ImportError:
        from dolfinx.io import gmshio as reader
    generate(s13(), grid(), tmp_path / "section.msh")
    with gmsh_model.session("again"):
        gmsh.merge(str(tmp_path / "section.msh"))
        result = reader.model_to_mesh(gmsh.model, MPI.COMM_SELF, 0, gdim=2)
    # Three things as a tuple until dolfinx 0.9, more and by name later.
    domain, cell_tags, facet_tags = result[:3] if isinstance(result, tuple) else (
        result.mesh, result.cell_tags, result.facet_tags
    )  # fmt: skip
    assert domain.topology.index_map(2).size_local == 611
    assert sorted(set(cell_tags.values.tolist())) == list(range(1, 11))
    assert sorted(set(facet_tags.values.tolist())) == [11, 12, 13, 14]


def test_the_file_says_that_it_is_a_reconstruction(tmp_path: Path) -> None:
    data = {**slope(), "reconstruction": True, "reconstruction_note": "Drawn from memory.\n$EndComments\nTwice."}
    generate(Section.parse(data), path=tmp_path / "section.msh")
    text = (tmp_path / "section.msh").read_text()
    assert "$Comments\nReconstruction. Drawn from memory. EndComments Twice.\n$EndComments\n" in text
    assert read(tmp_path / "section.msh").strata == ("upper", "lower")


def test_names_in_any_script(tmp_path: Path) -> None:
    data = slope()
    data["strata"][0]["name"], data["strata"][1]["name"] = "4 シルト", "$x_{ 'é' # [red]"
    mesh = generate(Section.parse(data), path=tmp_path / "section.msh")
    assert read(tmp_path / "section.msh").strata == mesh.strata == ("4 シルト", "$x_{ 'é' # [red]")


@pytest.mark.parametrize(
    "names",
    [
        ["CLAY, grey, " + 12 * "slightly sandy, " + end for end in ("soft", "stiff")],  # gmsh keeps 127 bytes
        [20 * "礫混り砂", "Sand 'A'"],
        ["a \\ b", "a\\"],
        ["stratum 2", 30 * "long " + "clay"],
    ],
)
@pytest.mark.parametrize("method", ["mapped", "free"])
def test_a_run_finds_its_strata_again_whatever_they_are_called(names: list[str], method: str, tmp_path: Path) -> None:
    data = slope()
    for stratum, name in zip(data["strata"], names, strict=False):
        stratum["name"] = name
    section = Section.parse(data)
    mesh = generate(section, MeshSettings(method=method), path=tmp_path / "section.msh")
    assert mesh.strata[: len(names)] == tuple(names)
    save(mesh, tmp_path / "saved.msh")
    for file in ("section.msh", "saved.msh"):
        again = given_mesh(section, tmp_path / file)
        assert again.strata == mesh.strata
        np.testing.assert_allclose(again.stratum_areas(), mesh.stratum_areas(), rtol=1e-12)


def test_a_folded_cell_is_refused_by_its_place() -> None:
    points = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 1.0], [1.0, 1.0], [2.0, 1.0]])
    cells = np.array([[0, 1, 4, 3], [1, 2, 5, 4]])
    check(QuadMesh(points, cells, np.array([0, 1]), ("clay", "sand"), {}))
    points[5] = [1.4, 0.4]  # on the diagonal of the right-hand cell's other corners, or below it
    with pytest.raises(BadMeshError) as caught:
        check(QuadMesh(points, cells, np.array([0, 1]), ("clay", "sand"), {}))
    assert str(caught.value).startswith("1 of 2 cells is folded, the worst near x = 1.35 m, z = 0.35 m")
    assert 'in stratum "sand"' in str(caught.value)


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Lets gmsh make free meshes in this process."""
    monkeypatch.setattr(gmsh_model, "_in_fresh_processes", SERIAL)
    return monkeypatch


def test_of_several_free_meshes_the_best_is_written_and_no_other_file(here: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """As if all had a narrow corner, so that four are made."""
    angles: list[float] = []

    def narrowest(mesh: QuadMesh) -> float:
        angles.append(float(corner_angles(mesh.points, mesh.cells).min()))
        return angles[-1]

    here.setattr(gmsh_model, "NARROW_ANGLE", 180.0)
    here.setattr(gmsh_model, "_narrowest", narrowest)
    mesh = generate(Section.parse(slope()), MeshSettings(method="free", size=2.0), tmp_path / "section.msh")
    assert len(set(angles)) > 1
    assert corner_angles(mesh.points, mesh.cells).min() == max(angles)
    again = read(tmp_path / "section.msh")
    corners, written = (np.sort(item.points[item.cells].mean(axis=1), axis=0) for item in (mesh, again))
    np.testing.assert_allclose(written, corners, rtol=1e-14, atol=1e-12)
    assert [file.name for file in tmp_path.iterdir()] == ["section.msh"]


def test_a_triangle_is_refused_by_its_place(here: pytest.MonkeyPatch) -> None:
    def leave_triangles(section: Section, *_: object) -> None:
        corners = [gmsh.model.geo.addPoint(x, z, 0.0) for x, z in ((7.0, 3.0), (8.0, 3.0), (7.0, 4.0))]
        lines = [gmsh.model.geo.addLine(corners[a], corners[(a + 1) % 3]) for a in range(3)]
        gmsh.model.geo.addPlaneSurface([gmsh.model.geo.addCurveLoop(lines)])
        gmsh.model.geo.synchronize()
        gmsh.model.mesh.generate(2)

    here.setattr(gmsh_model, "build_free", leave_triangles)
    with pytest.raises(BadMeshError, match=r"gmsh made a Triangle 3 near x = [78]\.\d+ m, z = [34]\.\d+ m"):
        generate(Section.parse(slope()), MeshSettings(method="free"))


def test_what_gmsh_itself_refuses_is_no_traceback(here: pytest.MonkeyPatch) -> None:
    def fail(*_: object) -> None:
        raise Exception("Could not recover boundary")  # gmsh raises nothing more precise

    here.setattr(gmsh_model, "build_free", fail)
    with pytest.raises(BadMeshError, match="gmsh gave up: Could not recover boundary; try another size"):
        generate(Section.parse(slope()), MeshSettings(method="free"))


def test_another_algorithm_takes_over(here: pytest.MonkeyPatch) -> None:
    tried: list[int] = []
    build = gmsh_model.build_free

    def fail_once(*arguments: Any) -> None:
        tried.append(arguments[-1])
        if len(tried) == 1:
            raise BadMeshError("folded")
        build(*arguments)

    here.setattr(gmsh_model, "build_free", fail_once)
    section = Section.parse(slope())
    assert_conforming(generate(section, free(section)), section, free(section))
    assert tried == list(gmsh_model.ALGORITHMS[:2])


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "there is no such file"),
        ("not a mesh", "is not a gmsh file that can be read"),
        ("$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", "is not a gmsh file that can be read"),
    ],
)
def test_reading_what_is_no_mesh(tmp_path: Path, content: str | None, said: str) -> None:
    path = tmp_path / "section.msh"
    if content is not None:
        path.write_text(content)
    with pytest.raises(InputError, match="1 problem") as caught:
        read(path)
    assert said in caught.value.problems[0]


def test_reading_a_mesh_without_groups_says_which_are_missing(tmp_path: Path) -> None:
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    triangle = meshio.Mesh(points, [("triangle", np.array([[0, 1, 2]]))])
    meshio.write(tmp_path / "section.msh", triangle, file_format="gmsh")
    with pytest.raises(InputError) as caught:
        read(tmp_path / "section.msh")
    assert [text.partition(";")[0] for text in caught.value.problems] == [
        *(f'there is no boundary group "{name}"' for name in BOUNDARIES),
        "there is no surface group",
        "there are cells of type triangle",
    ]
