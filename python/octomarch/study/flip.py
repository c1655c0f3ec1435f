"""How different two pictures look: FLIP, by the package of its authors, which is an extra.

.. [1] P. Andersson et al., "FLIP: A difference evaluator for alternating images", Proc. ACM Comput. Graph. Interact.
   Tech. 3(2), 2020. doi:10.1145/3406183
"""

from __future__ import annotations

import importlib.util
from typing import Any

import numpy as np
from numpy.typing import NDArray

INSTALL = "FLIP needs the package flip-evaluator: pip install 'octomarch[study]'"


def available() -> bool:
    """Tell whether FLIP is installed.

    Examples
    --------
    >>> isinstance(available(), bool)
    True
    """
    return importlib.util.find_spec("flip_evaluator") is not None


def flip_map(reference: NDArray[np.uint8], picture: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Return how different two pictures of sRGB bytes look at each pixel, from 0 to 1.

    They are taken to be flipped in place, 67 pixels to a degree of the view: 0.7 m from a 4K screen 0.7 m wide.

    Raises
    ------
    ImportError
        Saying what to install, if FLIP is not.

    Examples
    --------
    >>> import numpy as np
    >>> grey = np.full((8, 8, 3), 128, np.uint8)
    >>> bool(flip_map(grey, grey).any()) if available() else False
    False
    """
    try:
        import flip_evaluator  # here, since it is an extra
    except ImportError as error:
        raise ImportError(INSTALL) from error
    evaluator: Any = flip_evaluator
    pictures = (np.divide(levels, 255, dtype=np.float32) for levels in (reference, picture))
    differences, _, _ = evaluator.evaluate(*pictures, "LDR", applyMagma=False, computeMeanError=False)
    return np.asarray(differences, dtype=np.float32)[..., 0]
