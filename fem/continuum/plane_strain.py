"""Models elastoplastic plane strain of a meshed section: its state, its internal forces, its tangent stiffness.

Stress is positive in tension; components [xx, yy, zz, xy], y upwards; Pa, m, N per metre out of plane.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fem.continuum.discretisation import Discretisation, discretise, periodic_discretisation
from fem.continuum.linear_solver import Exchange, LinearSolver
from fem.continuum.strength import is_associated, strength_of
from fem.kernels import assembly, mohr_coulomb, viscoplastic
from fem.settings import DavisForm, Element, FlowSetting
from meshes.errors import InputError
from meshes.quad_mesh import QuadMesh
from meshes.section.alike_sides import has_alike_sides
from meshes.section.section import Section, Stratum

# Share of the elastic stiffness that is added to the matrix, but not to the forces, so that the matrix is regular where
# a mechanism has formed.
ELASTIC_SHARE = 1e-6
# Share of the elastic stiffness that resists hourglass strain; it acts on a step's increment and does not add up, so
# that steps of some elastic displacements feel less than 1 % of the strength.
HOURGLASS_SHARE = 1e-5


@dataclass(frozen=True, eq=False)
class PartialProblem:
    """Holds some cells of a section, with their accepted state, as a problem of their own.

    Components and cells are numbered from 0 within this part.

    Attributes
    ----------
    components (k,) : numbers of the displacement components of these cells among the components that this rank owns
    dofs (nc, nd) : numbers of the components of every cell among the k components of this part
    matrix, weights, hourglass : strain-displacement matrix B (1/m), areas of the quadrature points (m²), and stiffness
        against hourglass modes, for the cells of this part
    stress (points, 4) : accepted stress [xx, yy, zz, xy], tension positive (Pa)
    material (points,) : numbers of the soils in ``table``, for every quadrature point
    table : constants of the soils, as ``mohr_coulomb.table`` returns them
    regularisation (points, 4, 4) : small stiffness (Pa) that is added to the tangent, so that the stiffness matrix is
        not singular
    """

    components: np.ndarray
    dofs: np.ndarray
    matrix: np.ndarray
    weights: np.ndarray
    hourglass: np.ndarray
    stress: np.ndarray
    material: np.ndarray
    table: np.ndarray
    regularisation: np.ndarray


class PlaneStrain:
    """Holds a discretised section in plane strain, with its last accepted state of equilibrium.

    Vectors (dofs,) contain the displacement components that this rank owns, x and y of a node in turn.

    Attributes
    ----------
    strata : tuple of Stratum
        The strata; ``material`` (points,) contains the number of the stratum of each quadrature point.
    flow, form : FlowSetting, DavisForm
        The flow rule of the analysis, see ``strength.py``.
    strength : StrataStrength
        Cohesion, friction and dilation angle of the strata in this analysis.
    grid : Discretisation
        The elements.
    exchange : Exchange
        Sums and copies of displacement components between ranks.
    displacement : ndarray (dofs,)
        Accepted displacement (m).
    stress : ndarray (points, 4)
        Accepted stress (Pa).
    strain, plastic_strain : ndarray (points, 4)
        Accepted strain, engineering shear (-).
    region : ndarray (points,)
        Number of the part of the yield surface on which the stress of every point lies, by the codes of
        ``return_mapping``.
    repeats : bool
        Whether the sides are periodic.
    free : ndarray (dofs,)
        Mask of the displacement components that are not fixed.
    overstress : float
        Weight b of the elastic stress in the next stress update, see ``viscoplastic`` (-).
    """

    def __init__(
        self,
        mesh: QuadMesh,
        strata: Sequence[Stratum],
        element: Element,
        comm: Any = None,
        threads: int = 1,
        flow: FlowSetting = "non-associated",
        form: DavisForm = "B",
    ) -> None:
        """Discretise ``mesh`` of ``strata`` with finite elements of type ``element`` on the ranks of ``comm``, with
        ``threads`` threads on each rank.

        ``flow`` is the flow rule, and ``form`` the form of Davis's estimate, see ``strength.py``.
        """
        self.strata = tuple(strata)
        self.threads, self.flow, self.form = threads, flow, form
        self._elastic = self.elastic_stiffness()
        self._take(discretise(mesh, element, comm))
        self.material = np.repeat(self.grid.stratum, self.grid.points_per_cell).astype(np.int64)
        self.use_strength(1.0)
        points = self.grid.weights.size
        self.displacement = np.zeros(self.exchange.end_owned - self.exchange.first_owned)
        self.stress = np.zeros((points, 4))
        self.strain = np.zeros((points, 4))
        self.plastic_strain = np.zeros((points, 4))
        self.region = np.zeros(points, dtype=np.int8)
        self._trial = np.zeros((points, 4))
        self._tangent = np.zeros((points, 4, 4))
        self._plastic = np.zeros((points, 4))
        self._strain = np.zeros((points, 4))
        self.overstress = 0.0
        self._passive = np.zeros(0, dtype=np.int64)
        self.repeats = False
        self.hold({})

    def _take(self, grid: Discretisation) -> None:
        """Set up the solver and the work arrays for a discretisation."""
        self.grid = grid
        self.exchange = Exchange(grid)
        self._solver: LinearSolver | None = None  # limit analysis needs none
        self._forces = np.zeros(len(grid.global_dofs))
        shear = self._elastic[:, 3, 3]
        self._hourglass = HOURGLASS_SHARE * shear[grid.stratum[: len(grid.hourglass)], None, None] * grid.hourglass

    def use_strength(self, factor: float) -> None:
        """Divide cohesion and tan φ of every stratum by ``factor``, as ``strength_of`` does."""
        self.strength = strength = strength_of(self.strata, self.flow, factor, self.form)
        self.table = mohr_coulomb.table(
            young=[s.youngs_modulus for s in self.strata],
            poisson=[s.poissons_ratio for s in self.strata],
            cohesion=strength.cohesion,
            friction=strength.friction,
            dilation=strength.dilation,
            tension=strength.tension,
        )

    @property
    def associated(self) -> bool:
        """Return whether the flow rule is associated everywhere."""
        return is_associated(self.strata, self.flow)

    def points(self) -> np.ndarray:
        """Return coordinates (points, 2) of the quadrature points (m)."""
        corners = self.grid.node_points[self.grid.global_dofs[self.grid.dofs[:, 0::2]] // 2]
        return np.einsum("qn,cni->cqi", self.grid.shapes, corners).reshape(-1, 2)

    def hold(self, components: dict[str, str]) -> None:
        """Fix displacement components on boundaries, such as {"base": "xy", "left": "x"}."""
        fixed = np.zeros(self.grid.size, dtype=bool)
        fixed[2 * self._passive] = fixed[2 * self._passive + 1] = True
        for name, axes in components.items():
            for axis in axes:
                fixed[2 * self.grid.sides[name] + "xy".index(axis)] = True
        self.fix_components(fixed)

    def fix_components(self, fixed: np.ndarray) -> None:
        """Fix the components marked in ``fixed`` (all components, the same on every rank)."""
        self.free = ~self.exchange.owned_part(fixed)
        self._free_local = ~fixed[self.grid.global_dofs]
        self._fixed_owned = self.exchange.first_owned + np.flatnonzero(~self.free)

    def tie(self, first: str, second: str, section: Section) -> None:
        """Make the nodes of boundary ``second`` move like those of boundary ``first``, with the base fixed.

        Raises InputError unless both boundaries have the same layers at the same heights, up to a shift.
        """
        grid = self.grid
        masters, slaves = (
            nodes[np.argsort(grid.node_points[nodes, 1])] for nodes in (grid.sides[first], grid.sides[second])
        )
        master_heights, slave_heights = (
            grid.node_points[nodes, 1] - grid.node_points[nodes[0], 1] for nodes in (masters, slaves)
        )
        if len(masters) != len(slaves) or not np.allclose(
            master_heights, slave_heights, atol=1e-6 * master_heights[-1], rtol=0.0
        ):
            alike = (
                "the same points of the mesh"
                if has_alike_sides(section.strata, section.layering)
                else "layers of the same thickness"
            )
            remedy = f'expected {alike} at both; use sides = "smooth", "free-field" or "fixed"'
            raise InputError(
                section.name, [f'fem, sides = "periodic": the {first} and {second} sides differ; {remedy}']
            )
        self.tie_nodes(masters, slaves)
        self.repeats = True
        self.hold({"base": "xy"})

    def tie_nodes(self, masters: np.ndarray, slaves: np.ndarray) -> None:
        """Make nodes (global numbers) move like other nodes; call ``hold`` again afterwards."""
        self._take(periodic_discretisation(self.grid, masters, slaves))
        self._passive = np.concatenate([self._passive, slaves])

    def body_force(self, density: Sequence[float], acceleration: tuple[float, float]) -> np.ndarray:
        """Return the nodal forces (N/m) of an acceleration (m/s²) on the densities (kg/m³) of the strata."""
        per_area = np.asarray(density, dtype=float)[self.material].reshape(self.grid.weights.shape)
        nodal = np.einsum("cq,qn->cn", per_area * self.grid.weights, self.grid.shapes)
        local = np.zeros(len(self.grid.global_dofs))
        for axis, value in enumerate(acceleration):
            np.add.at(local, self.grid.dofs[:, axis::2], value * nodal)
        return self.exchange.sum_to_owned(local)

    def internal_force(self, increment: np.ndarray, tangent: bool = True) -> np.ndarray:
        """Return the nodal forces of the stress after a displacement increment from the accepted state.

        The stress after the increment, and with ``tangent`` its tangent stiffness, is stored until the next call or
        ``accept``.
        """
        local = self.exchange.to_local(increment)
        assembly.strains(self.grid.matrix, self.grid.dofs, local, self._strain)
        mohr_coulomb.update(
            self._strain, self.stress, self.material, self.table, self._trial,
            tangent=self._tangent if tangent else None,
            plastic_strain_increment=self._plastic, region=self.region, threads=self.threads,
        )  # fmt: skip
        if self.overstress > 0.0:
            viscoplastic.add_overstress(
                self.overstress, self._strain, self.stress, self.material, self._elastic,
                self._trial, self._tangent if tangent else self._tangent[:0], self._plastic,
            )  # fmt: skip
        self._assemble(self._trial)
        assembly.add_forces(self._hourglass, self.grid.dofs, local, self._forces)
        return self.exchange.sum_to_owned(self._forces)

    def forces_of(self, stress: np.ndarray) -> np.ndarray:
        """Return the nodal forces (N/m) of a stress (points, 4)."""
        self._assemble(stress)
        return self.exchange.sum_to_owned(self._forces)

    def _assemble(self, stress: np.ndarray) -> None:
        assembly.internal_forces(self.grid.matrix, self.grid.weights, self.grid.dofs, stress, self._forces)

    def factorise(self) -> None:
        """Factorise the stiffness of the last ``internal_force``. Raises SingularMatrixError."""
        if self.overstress < ELASTIC_SHARE:
            self._tangent += ELASTIC_SHARE * self._elastic[self.material]
        if self._solver is None:
            self._solver = LinearSolver(self.grid, self.exchange, symmetric=self.flow != "non-associated")
        self._solver.factorise(self._tangent, self._hourglass, self._free_local, self._fixed_owned)

    def solve(self, force: np.ndarray) -> np.ndarray:
        """Return the displacement under nodal forces by the last factorised stiffness; fixed components are zero."""
        assert self._solver is not None
        return self._solver.solve(np.where(self.free, force, 0.0))

    def part(self, cells: np.ndarray) -> PartialProblem:
        """Return some of the cells, given by their numbers, as a problem of their own; on one rank only."""
        grid, points = self.grid, self.grid.points_per_cell
        own_points = (cells[:, None] * points + np.arange(points)).ravel()
        components, dofs = np.unique(grid.global_dofs[grid.dofs[cells]], return_inverse=True)
        shape = len(cells), grid.dofs.shape[1]
        return PartialProblem(
            components=components,
            dofs=dofs.reshape(shape).astype(np.int32),
            matrix=grid.matrix[cells],
            weights=grid.weights[cells],
            hourglass=self._hourglass[cells] if len(self._hourglass) else np.zeros((*shape, shape[1])),
            stress=self.stress[own_points],
            material=self.material[own_points],
            table=self.table,
            regularisation=ELASTIC_SHARE * self._elastic[self.material[own_points]],
        )

    def elastic_stiffness(self) -> np.ndarray:
        """Return Hooke's law (strata, 4, 4) in plane strain with the out-of-plane stress (Pa)."""
        laws = np.zeros((len(self.strata), 4, 4))
        for law, s in zip(laws, self.strata, strict=True):
            shear = s.youngs_modulus / (2.0 * (1.0 + s.poissons_ratio))
            law[:3, :3] = 2.0 * shear * s.poissons_ratio / (1.0 - 2.0 * s.poissons_ratio)
            law[range(4), range(4)] += [2.0 * shear] * 3 + [shear]
        return laws

    def accept(self, increment: np.ndarray) -> None:
        """Accept the state of the last ``internal_force``. The next displacement increment starts from the accepted
        state."""
        self.displacement = self.displacement + increment
        self.stress[:] = self._trial
        self.strain += self._strain
        self.plastic_strain += self._plastic

    def state(self) -> tuple[np.ndarray, ...]:
        """Return a copy of the accepted state, for ``restore``."""
        return tuple(a.copy() for a in (self.displacement, self.stress, self.strain, self.plastic_strain))

    def restore(self, state: tuple[np.ndarray, ...]) -> None:
        """Restore an accepted state that ``state`` returned."""
        self.displacement = state[0].copy()
        self.stress[:], self.strain[:], self.plastic_strain[:] = state[1:]

    def use_elastic_tangent(self) -> None:
        """Make Hooke's law the tangent of the next ``factorise``."""
        self._tangent[:] = self._elastic[self.material]

    def plastic_share(self) -> float:
        """Return the share of quadrature points that were at yield in the last stress update."""
        count = self.grid.comm.allreduce(np.array([np.count_nonzero(self.region), self.region.size], dtype=float))
        return float(count[0] / count[1])
