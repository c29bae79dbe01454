"""Reads the results of the stage `fem` for pictures and report."""

from dataclasses import dataclass, replace

import numpy as np

from fem.continuum.fields import FieldState
from meshes.quad_mesh import QuadMesh
from meshes.section.section import Section
from workflow.results.continuum import FemAnswer
from workflow.results.mesh_grids import StoredGrid
from workflow.results.stored_mesh import path_mesh
from workflow.run.store import Store

COLLECTION = "fem/fields.pvd"


def fields_file(number: int) -> str:
    """Return the file name of the fields of an equilibrium.

    Parameters
    ----------
    number : number of the state of equilibrium along the path, from 0

    Returns
    -------
    The name within the folder fem/.
    """
    return f"fields_{number}.vtu"


@dataclass(frozen=True)
class FemResults:
    """Holds the answer of the stage `fem` with the fields of its states.

    Attributes
    ----------
    mesh : mesh of the path, on which the fields are
    answer : content of fem/critical.json
    states : fields of each of the states of ``answer``, in their order; a state past equilibrium has those of the last
        state of the path
    """

    mesh: QuadMesh
    answer: FemAnswer
    states: list[FieldState]

    @classmethod
    def load(cls, section: Section, store: Store) -> "FemResults":
        """Read the results of the stage `fem` in a folder.

        Parameters
        ----------
        section : the ground
        store : the folder of the run

        Raises
        ------
        InputError
            If a file is missing, or its mesh is of another section.
        OtherVersionError
            If another version of the program wrote the answer.
        """
        answer = FemAnswer.read(store)
        states: list[FieldState] = []
        for state_part in answer.states:
            if state_part.past_equilibrium:  # the answer shows the last state of the path in its place
                last = next(state for state in reversed(states) if not state.past_equilibrium)
                states.append(replace(last, label=state_part.label, kh=state_part.kh, past_equilibrium=True))
            else:
                grid = StoredGrid(store.folder / "fem" / fields_file(len(states)))
                states.append(_state(grid, state_part.label, state_part.kh))
        return cls(path_mesh(section, store, answer.mesh.method), answer, states)

    def slip_surface(self, state: FieldState) -> np.ndarray:
        """Return points (n, 2) in m of the slip surface of one of the ``states``; none where the ground does not
        fail."""
        stored = next(stored for stored, loaded in zip(self.answer.states, self.states, strict=True) if loaded is state)
        return np.array(stored.slip_surface).reshape(-1, 2)


def _state(grid: StoredGrid, label: str, kh: float) -> FieldState:
    return FieldState(
        label,
        kh,
        grid.of_points("displacement_m")[:, :2],
        grid.of_cells("stress_xx_yy_zz_xy_Pa"),
        grid.of_cells("shear_strain"),
        grid.of_cells("plastic_shear_strain"),
        grid.of_cells("mobilised_strength"),
    )
