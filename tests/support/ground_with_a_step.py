"""A step in gentle ground that liquefies between free-field sides: its slide does not depend on where the sides are."""

from workflow.config import Config


def ground_with_a_step(width: float, **settings: object) -> Config:
    """A step 2 m high in ground that falls by 1 % for ``width`` metres on both sides of it, under Kh = 0.08 for 3 s.

    ``settings``: further tables of the file.
    """
    soil = {
        "density": "1.9 t/m^3", "youngs_modulus": "30 MPa", "poissons_ratio": 0.33, "cohesion": "3 kPa",
        "friction_angle": "35 deg",
    }  # fmt: skip
    left, right, fall = -width, 4.0 + width, 0.01 * width
    return Config.parse({
        "name": "step",
        "surface": [[left, fall], [0.0, 0.0], [4.0, -2.0], [right, -2.0 - fall]],
        "base": {"elevation": [[left, fall - 8.0], [right, -8.0 - fall]]},
        "strata": [
            soil | {"name": "crust", "bottom": {"elevation": [[left, fall - 3.5], [right, -4.5 - fall]]}},
            soil
            | {
                "name": "loose", "bottom": {"elevation": [[left, fall - 6.0], [right, -6.0 - fall]]},
                "liquefies_in": [1],
            },
            soil | {"name": "firm"},
        ],
        "fem": {"sides": "free-field"},
        "slide": {"kh": 0.08, "kh_seconds": 3.0, "duration": 60.0, "cases": [{"residual_strength": "6 kPa"}]},
        **settings,
    })  # fmt: skip
