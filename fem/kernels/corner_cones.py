r"""Computes scalings, products and step lengths for second-order cones of three components, of which an interior-point
method has a hundred thousand (kernels).

For a slack s and a multiplier z inside the cone v0 >= |(v1, v2)|, the scaling of Nesterov & Todd (1997) is the
symmetric matrix W with W z = W⁻¹ s = λ. With J = diag(1, -1, -1) and a vector w such that wᵀ J w = 1 and w0 > 0, it is
W² = η² (2 w wᵀ - J). The product u ∘ v is [u·v, u0 v1 + v0 u1, u0 v2 + v0 u2], and λ \ d is the solution x of λ ∘ x =
d.
"""

import math

import numpy as np
from numba import njit


@njit(cache=True, nogil=True, error_model="numpy")
def scalings(s: np.ndarray, z: np.ndarray, axis: np.ndarray, size: np.ndarray, square: np.ndarray) -> bool:
    """Compute the scalings of slacks ``s`` and multipliers ``z``.

    Parameters
    ----------
    s, z (k, 3) : slack and multiplier of each cone
    axis (k, 3) : set to w
    size (k,) : set to η
    square (k, 3, 3) : set to W²

    Returns
    -------
    False if a slack or a multiplier lies outside its cone; the results are then incomplete.
    """
    for k in range(len(s)):
        s0, s1, s2, z0, z1, z2 = s[k, 0], s[k, 1], s[k, 2], z[k, 0], z[k, 1], z[k, 2]
        far_s, far_z = math.sqrt(s1 * s1 + s2 * s2), math.sqrt(z1 * z1 + z2 * z2)
        det_s, det_z = (s0 - far_s) * (s0 + far_s), (z0 - far_z) * (z0 + far_z)
        if not (det_s > 0.0 and det_z > 0.0 and s0 > 0.0 and z0 > 0.0):
            return False
        det_s, det_z = math.sqrt(det_s), math.sqrt(det_z)
        twice = 2.0 * math.sqrt(0.5 + 0.5 * (s0 * z0 + s1 * z1 + s2 * z2) / (det_s * det_z))
        w1, w2 = (s1 / det_s - z1 / det_z) / twice, (s2 / det_s - z2 / det_z) / twice
        w0 = math.sqrt(1.0 + w1 * w1 + w2 * w2)
        much = det_s / det_z
        axis[k, 0], axis[k, 1], axis[k, 2], size[k] = w0, w1, w2, math.sqrt(much)
        square[k, 0, 0], square[k, 1, 1] = much * (2.0 * w0 * w0 - 1.0), much * (2.0 * w1 * w1 + 1.0)
        square[k, 2, 2] = much * (2.0 * w2 * w2 + 1.0)
        square[k, 0, 1] = square[k, 1, 0] = much * 2.0 * w0 * w1
        square[k, 0, 2] = square[k, 2, 0] = much * 2.0 * w0 * w2
        square[k, 1, 2] = square[k, 2, 1] = much * 2.0 * w1 * w2
    return True


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _scaled(w: np.ndarray, size: float, v0: float, v1: float, v2: float, sign: float) -> tuple[float, float, float]:
    """Return W v if ``sign`` is 1, or W⁻¹ v if it is -1."""
    along = w[1] * v1 + w[2] * v2
    more = sign * v0 + along / (1.0 + w[0])
    much = size if sign > 0.0 else 1.0 / size
    return much * (w[0] * v0 + sign * along), much * (v1 + more * w[1]), much * (v2 + more * w[2])


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def _divided(l0: float, l1: float, l2: float, d0: float, d1: float, d2: float) -> tuple[float, float, float]:
    r"""Return the solution x of λ ∘ x = d, which is written λ \ d."""
    far = math.sqrt(l1 * l1 + l2 * l2)
    along = l1 * d1 + l2 * d2
    determinant = (l0 - far) * (l0 + far)
    x0, share = (l0 * d0 - along) / determinant, (along / l0 - d0) / determinant
    return x0, share * l1 + d1 / l0, share * l2 + d2 / l0


@njit(cache=True, nogil=True, error_model="numpy")
def corrections(
    axis: np.ndarray, size: np.ndarray, z: np.ndarray, ds: np.ndarray, dz: np.ndarray, aim: float, out: np.ndarray
) -> None:
    """Compute W (λ \\ (λ ∘ λ + (W⁻¹ ds) ∘ (W dz) - aim e)), the right-hand side of Mehrotra's corrector (1992).

    Parameters
    ----------
    axis (k, 3) : w of `scalings`
    size (k,) : η of `scalings`
    z (k, 3) : multipliers
    ds, dz (k, 3) : step of the predictor
    aim : target of the products s ∘ z
    out (k, 3) : set to the right-hand side
    """
    for k in range(len(z)):
        w, eta = axis[k], size[k]
        l0, l1, l2 = _scaled(w, eta, z[k, 0], z[k, 1], z[k, 2], 1.0)
        a0, a1, a2 = _scaled(w, eta, ds[k, 0], ds[k, 1], ds[k, 2], -1.0)
        b0, b1, b2 = _scaled(w, eta, dz[k, 0], dz[k, 1], dz[k, 2], 1.0)
        d0 = l0 * l0 + l1 * l1 + l2 * l2 + a0 * b0 + a1 * b1 + a2 * b2 - aim
        d1, d2 = 2.0 * l0 * l1 + a0 * b1 + b0 * a1, 2.0 * l0 * l2 + a0 * b2 + b0 * a2
        x0, x1, x2 = _divided(l0, l1, l2, d0, d1, d2)
        out[k, 0], out[k, 1], out[k, 2] = _scaled(w, eta, x0, x1, x2, 1.0)


@njit(cache=True, nogil=True, error_model="numpy")
def centrality(
    axis: np.ndarray, size: np.ndarray, z: np.ndarray, s_next: np.ndarray, z_next: np.ndarray,
    aim: float, low: float, high: float, out: np.ndarray,
) -> None:  # fmt: skip
    """Compute Gondzio's right-hand side W (λ \\ t), which centres the products after a longer step.

    The products are the eigenvalues of (W⁻¹ s) ∘ (W z). t moves them into the range ``low`` to ``high`` times the
    ``aim``,
    but reduces no product by more than ``high`` times the aim (Gondzio 1996).

    Parameters
    ----------
    axis (k, 3) : w of `scalings`
    size (k,) : η of `scalings`
    z (k, 3) : multipliers
    s_next, z_next (k, 3) : slacks and multipliers after the longer step
    aim : target of the products
    low, high : smallest and largest product over the aim
    out (k, 3) : set to the right-hand side
    """
    for k in range(len(z)):
        w, eta = axis[k], size[k]
        a0, a1, a2 = _scaled(w, eta, s_next[k, 0], s_next[k, 1], s_next[k, 2], -1.0)
        b0, b1, b2 = _scaled(w, eta, z_next[k, 0], z_next[k, 1], z_next[k, 2], 1.0)
        p0, p1, p2 = a0 * b0 + a1 * b1 + a2 * b2, a0 * b1 + b0 * a1, a0 * b2 + b0 * a2
        far = math.sqrt(p1 * p1 + p2 * p2)
        less = max(min(max(p0 - far, low * aim), high * aim) - (p0 - far), -high * aim)
        more = max(min(max(p0 + far, low * aim), high * aim) - (p0 + far), -high * aim)
        t0, share = 0.5 * (less + more), (0.5 * (more - less) / far if far > 0.0 else 0.0)
        l0, l1, l2 = _scaled(w, eta, z[k, 0], z[k, 1], z[k, 2], 1.0)
        x0, x1, x2 = _divided(l0, l1, l2, t0, share * p1, share * p2)
        out[k, 0], out[k, 1], out[k, 2] = _scaled(w, eta, x0, x1, x2, 1.0)


@njit(cache=True, nogil=True, error_model="numpy")
def longest_step(v: np.ndarray, dv: np.ndarray) -> float:
    """Return the largest step length a for which all v + a dv lie in their cones.

    Parameters
    ----------
    v (k, 3) : vectors inside their cones
    dv (k, 3) : their changes in a step of length 1

    Returns
    -------
    The step length (-); 1e30 if there is no limit.
    """
    best = 1e30
    for k in range(len(v)):
        v0, v1, v2, d0, d1, d2 = v[k, 0], v[k, 1], v[k, 2], dv[k, 0], dv[k, 1], dv[k, 2]
        far = math.sqrt(v1 * v1 + v2 * v2)
        a, b, c = d0 * d0 - d1 * d1 - d2 * d2, v0 * d0 - v1 * d1 - v2 * d2, (v0 - far) * (v0 + far)
        if d0 < 0.0:
            best = min(best, -v0 / d0)
        square = b * b - a * c  # a x² + 2 b x + c = 0 at the end of the cone
        if square >= 0.0:
            root = math.sqrt(square)
            q = -(b + root) if b >= 0.0 else root - b
            if a != 0.0 and 0.0 < q / a < best:
                best = q / a
            if q != 0.0 and 0.0 < c / q < best:
                best = c / q
    return best


@njit(cache=True, nogil=True, error_model="numpy")
def add_products(square: np.ndarray, v: np.ndarray, out: np.ndarray) -> None:
    """Add W² v to ``out``.

    Parameters
    ----------
    square (k, 3, 3) : W² of `scalings`
    v (k, 3) : vectors
    out (k, 3) : increased by the products
    """
    for k in range(len(v)):
        for i in range(3):
            out[k, i] += square[k, i, 0] * v[k, 0] + square[k, i, 1] * v[k, 1] + square[k, i, 2] * v[k, 2]
