"""Provides meshes, soils and paths for the tests of the finite elements."""

import math

import numpy as np
from mpi4py import MPI

from fem.continuum.plane_strain import PlaneStrain
from fem.path.equilibrium_path import EquilibriumPath, PathSettings
from fem.path.newton import NewtonSettings, ProportionalLoad
from fem.path.plateau import PlateauRule, find_limit_load
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section, Stratum

ELEMENTS = ("bilinear", "quadratic", "reduced")


def soil(name="soil", E=1e7, nu=0.3, c=1e4, phi=30.0, psi=None, ordinary=2000.0, seismic=2000.0, bottom=None):
    """Return a stratum; angles in degrees, psi = phi by default."""
    return Stratum(
        name=name,
        bottom=bottom,
        youngs_modulus=E,
        poissons_ratio=nu,
        density_ordinary=ordinary,
        density_seismic=seismic,
        cohesion=c,
        friction_angle=math.radians(phi),
        dilation_angle=math.radians(phi if psi is None else psi),
    )


def section(surface, depth, *strata, name="test", **more):
    """Return a section of strata down to a depth below the surface."""
    return Section(name=name, surface=surface, base={"depth": depth}, strata=strata, **more)


# A bank whose bed is sand without cohesion, which bears hardly any stress at the toe.
BANK_OF_SAND = section(
    [[0.0, 4.0], [10.0, 4.0], [22.0, 0.0], [36.0, 0.0]], 6.0,
    soil("fill", c=2e3, phi=30.0, psi=0.0, bottom={"elevation": [[0.0, 2.0], [16.0, 2.0]]}),
    soil("bare sand", c=0.0, phi=33.0, psi=0.0),
)  # fmt: skip


def grid(x, y, move=lambda x, y: (x, y), stratum=lambda x, y: np.zeros(len(x), int), names=("soil",)):
    """Return rectangles between the increasing lines x and y, then moved; ``stratum`` depends on the middle of a
    rectangle."""
    x, y = np.asarray(x, float), np.asarray(y, float)
    columns, rows = len(x) - 1, len(y) - 1
    node = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    cells = np.stack([node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]], axis=-1).reshape(-1, 4)
    X, Y = (a.ravel() for a in np.meshgrid(x, y))
    sides = {"surface": node[-1], "base": node[0], "left": node[:, 0], "right": node[:, -1]}
    points = np.column_stack([X, Y])
    middle = points[cells].mean(axis=1)
    return QuadMesh(
        points=np.column_stack(move(X, Y)),
        cells=cells,
        stratum=stratum(*middle.T),
        strata=names,
        boundaries={name: np.column_stack([line[:-1], line[1:]]) for name, line in sides.items()},
    )


def graded(start, end, first, growth):
    """Return increasing or decreasing numbers from start to end, whose steps grow from about ``first``."""
    length = abs(end - start)
    n = max(1, round(math.log1p(length / first * (growth - 1.0)) / math.log(growth)))
    places = (growth ** np.arange(n + 1) - 1.0) / (growth**n - 1.0)
    return start + (end - start) * places


def path_of(problem, fixed, load, control, first=0.1, tolerance=1e-6, largest=0.5, relaxation=0.0):
    """Return the path of a growing load; its displacement is in units of the elastic displacement under the given
    load."""
    problem.use_elastic_tangent()
    problem.factorise()
    elastic = problem.exchange.dot(control, problem.solve(load))
    settings = PathSettings(
        newton=NewtonSettings(tolerance=tolerance), first_step=first, largest_step=largest, relaxation=relaxation
    )
    scale = problem.exchange.norm(load)
    return EquilibriumPath(problem, ProportionalLoad(fixed, load), control, elastic, scale, settings)


def limit_load(problem, fixed, load, control, rule=None, **settings):
    """Return the load factor at which the displacement grows without limit, and the path."""
    path = path_of(problem, fixed, load, control, **settings)

    def ductility(path):
        return path.displacement / (path.factor * path.reference)

    return find_limit_load(path, ductility, math.inf, rule or PlateauRule(growth=0.001, latest=60.0)), path


def footing(element, phi, cells, surcharge=False, growth=1.15, psi=None, flow="non-associated", **settings):
    """Return the bearing capacity factor of a rough rigid footing on weightless ground (Nc, or Nq under a
    ``surcharge``), and the path.

    The ground dilates by ``psi`` (deg), by default by φ; ``flow`` is the flow rule for a smaller ψ. The mesh has half
    of the footing, 1 m wide, with ``cells`` cells below it, the finest at its edge. The nodes below it move like the
    node on the axis, which moves vertically only. The box contains Prandtl's mechanism.
    """
    spiral = math.exp(math.pi / 2 * math.tan(math.radians(phi)))
    half = math.radians(45.0 + phi / 2)
    reach = 2.0 / (2.0 * math.cos(half)) * spiral
    width = 1.0 + 1.1 * 2.0 * reach * math.sin(half)
    h = 0.5 / cells
    under = 1.0 - graded(0.0, 1.0, h, growth)[::-1]
    x = np.concatenate([under, graded(1.0, width, h, growth)[1:]])
    y = graded(0.0, -1.1 * reach, h, growth)[::-1]
    mesh = grid(x, y)
    top = mesh.boundaries["surface"]
    mesh.boundaries["footing"] = top[: len(under) - 1]
    Nq = spiral**2 * math.tan(half) ** 2
    exact = 2.0 + math.pi if phi == 0.0 else Nq - 1.0 if surcharge else (Nq - 1.0) / math.tan(math.radians(phi))
    c, q = (0.0, 1e5) if surcharge else (1e4, 0.0)
    law = soil(E=1e8, nu=0.3, c=c, phi=phi, psi=phi if psi is None else psi)
    problem = PlaneStrain(mesh, [law], element, MPI.COMM_SELF)
    problem.flow = flow
    problem.use_strength(1.0)
    below = problem.grid.sides["footing"]
    below = below[np.argsort(problem.grid.node_points[below, 0])]
    problem.tie_nodes(np.repeat(below[:1], len(below) - 1), below[1:])
    problem.hold({"base": "xy", "left": "x", "right": "x"})
    problem.stress[:, :3] = -q
    fixed = problem.forces_of(problem.stress)
    control = np.zeros(problem.grid.size)
    control[2 * below[0] + 1] = -1.0
    outcome, path = limit_load(problem, fixed, (c + q) * exact * control, control, **settings)
    return exact * outcome.in_equilibrium + (q > 0.0), outcome, path


def weight_limit(mesh, law, element, sides, **settings):
    """Return γH / c (H = 1 m) at which a body fails as its weight grows; gravity is the only load."""
    problem = PlaneStrain(mesh, [law], element, MPI.COMM_SELF)
    problem.hold(sides)
    load = problem.body_force([1.0], (0.0, -1.0))
    control = load / problem.exchange.norm(load)
    outcome, path = limit_load(problem, np.zeros_like(load), law.cohesion * load, control, **settings)
    return outcome.in_equilibrium, outcome, path


def points_of(problem):
    """Return the positions of the quadrature points (cells, points of a cell, 2) in m; for tied nodes only y."""
    d = problem.grid
    middle = d.node_points[d.global_dofs[d.dofs[:, 0::2]] // 2]
    return np.einsum("qn,cni->cqi", d.shapes, middle)
