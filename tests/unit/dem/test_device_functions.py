"""Functions that kernels alone may call."""

import pytest
from numba import config

from dem.kernels.contact import spring


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="all functions are Python's own without the JIT")
def test_python_is_refused_by_a_function_of_the_kernels() -> None:
    with pytest.raises(TypeError, match="only for other kernels"):
        spring(1.0, 2.0, 0.0)
