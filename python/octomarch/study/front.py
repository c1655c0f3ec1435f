"""The Pareto front: what nothing else beats in one respect without being worse in another."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def pareto_front(costs: ArrayLike) -> NDArray[np.intp]:
    """Return the indices of the rows of `costs` that no other row dominates, by rising first column.

    A row dominates another if it is no more in any column, and less in one. Of equal rows the first stands for all;
    rows with NaN are never part of it.

    Parameters
    ----------
    costs : array_like of float, shape (n, k)
        Less is better in each of the k columns; +inf is worst.

    Returns
    -------
    ndarray of int

    Examples
    --------
    >>> pareto_front([[3, 1], [1, 3], [2, 2], [3, 3], [2, 2]]).tolist()
    [1, 2, 0]
    """
    rows = np.asarray(costs, dtype=np.float64)
    order = np.lexsort(rows.T[::-1])  # what comes later is never better in all columns
    kept: list[int] = []
    for index in order.tolist():
        row = rows[index]
        if not np.isnan(row).any() and not (rows[kept] <= row).all(axis=1).any():
            kept.append(index)
    return np.array(kept, dtype=np.intp)
