"""The stages of a run, each from the input to the files it leaves behind."""

import math
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from meshes.errors import InputError
from meshes.quadrilaterals import QuadMesh, check, generate, read
from meshes.section import Section
from workflow import figures
from workflow.settings import Input
from workflow.store import Store


def check_stage(run: Input, store: Store) -> None:
    """Draw the section as it was read."""
    with store.writing("figures/section.png") as path:
        figures.draw_section(run, path)


def mesh_stage(run: Input, store: Store) -> QuadMesh:
    """Mesh the section; leaves section.toml, mesh/section.msh and mesh/section.vtu.

    Raises InputError if the settings do not fit, BadMeshError if there is no usable mesh.
    """
    with store.writing("mesh/section.msh") as path:
        mesh = generate(run, run.mesh, path)
    store.write_text("section.toml", run.to_toml())
    grid = figures.unstructured(mesh)
    figures.add_texts(grid, "section", [run.title or run.name])
    if run.reconstruction:
        figures.add_texts(grid, "reconstruction", [run.reconstruction_note])
    store.write_grid("mesh/section.vtu", grid)
    return mesh


def given_mesh(run: Input, path: Path) -> QuadMesh:
    """A mesh made elsewhere, its strata in the order of the section; raises InputError if its groups do not fit."""
    mesh = read(path)
    names = [stratum.name for stratum in run.strata]
    problems = [f'there is no surface group "{name}"' for name in names if name not in mesh.strata]
    problems += [f'the surface group "{name}" is no stratum of {run.name}' for name in mesh.strata if name not in names]
    if problems:
        raise InputError(str(path), problems)
    place = np.array([names.index(name) for name in mesh.strata])
    given = replace(mesh, stratum=place[mesh.stratum], strata=tuple(names), method="given")
    check(given)
    return given


def mesh_figures(run: Input, mesh: QuadMesh, store: Store) -> None:
    """Draw the section and its mesh."""
    check_stage(run, store)
    with store.writing("figures/mesh.png") as path:
        figures.draw_mesh(run, mesh, path)


def strata_rows(section: Section) -> Iterator[list[str]]:
    """Every stratum as a person reads it: name, area, thickness, reach, and its parameters."""
    layers = section.layering
    at_left, at_right = layers.thickness()
    for k, (stratum, area) in enumerate(zip(section.strata, layers.areas(), strict=True)):
        here = layers.present()[:, k]
        ends = [*at_left[here, k], *at_right[here, k]]
        start, end = layers.x[:-1][here].min(), layers.x[1:][here].max()
        yield [
            stratum.name,
            f"{area:.1f}",
            f"{min(ends):.1f}-{max(ends):.1f}",
            f"{start:.4g}-{end:.4g}",
            f"{stratum.youngs_modulus / 1e6:.4g}",
            f"{stratum.poissons_ratio:g}",
            f"{stratum.density_ordinary / 1e3:.4g}/{stratum.density_seismic / 1e3:.4g}",
            f"{stratum.cohesion / 1e3:.4g}",
            f"{math.degrees(stratum.friction_angle):.3g}/{math.degrees(stratum.dilation_angle):.3g}",
        ]
