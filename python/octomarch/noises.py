"""Random numbers that are smooth in space, as expressions: `octomarch.noise` and sums of it.

`expressions` comes before it, `textures` makes colours of them.
"""

from __future__ import annotations

from octomarch import _core
from octomarch import _validate as check
from octomarch.expressions import Expression, ExpressionLike, operand


def noise(x: ExpressionLike, y: ExpressionLike, z: ExpressionLike, *, seed: int = 0) -> Expression:
    """Return gradient noise: a smooth random number, 0 at whole coordinates and within about ±1 between them.

    The same seed gives the same noise on every machine [1]_ [2]_. It repeats after 289 units along each axis.

    Parameters
    ----------
    x, y, z : Expression or float
        The point; scaled coordinates make coarser or finer noise.
    seed : int
        At least 0; 289 of them differ.

    Returns
    -------
    Expression

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type, or the seed negative.

    References
    ----------
    .. [1] K. Perlin, "Improving noise", SIGGRAPH 2002. doi:10.1145/566654.566636
    .. [2] I. McEwan, D. Sheets, S. Gustavson, M. Richardson, "Efficient computational noise in GLSL", 2012.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> float(om.noise(x, y, z).evaluate([3, 1, -2]))
    0.0
    >>> bool(abs(om.noise(4 * x, 4 * y, 4 * z, seed=7).evaluate([0.1, 0.2, 0.3])) <= 1)
    True
    """
    point = (operand("x", x), operand("y", y), operand("z", z))
    # a seed moves the lattice along z: far, so that seeds next to each other have nothing in common
    return Expression(_core.noise(*point, check.integer("seed", seed, 0) * 179 % 289))


def fractal_noise(
    x: ExpressionLike, y: ExpressionLike, z: ExpressionLike, *, octaves: int = 4, seed: int = 0
) -> Expression:
    """Return a sum of noises, each of half the size and half the height of the one before.

    Parameters
    ----------
    x, y, z : Expression or float
        The point, as for `noise`.
    octaves : int
        Number of noises, 1 to 16; their seeds count up from `seed`.
    seed : int
        At least 0.

    Returns
    -------
    Expression
        ``Σ noise(2**i * point, seed + i) / 2**i`` over i from 0 to octaves - 1.

    Raises
    ------
    TypeError, ValueError
        If an argument is of a wrong type or outside its range.

    Examples
    --------
    >>> import octomarch as om
    >>> x, y, z = om.coordinates()
    >>> om.fractal_noise(x, y, z, octaves=1) == om.noise(x, y, z)
    True
    """
    count, first = check.integer("octaves", octaves, 1, 16), check.integer("seed", seed, 0, 2**31 - 16)
    u, v, w = (Expression(operand(name, value)) for name, value in (("x", x), ("y", y), ("z", z)))
    total = noise(u, v, w, seed=first)
    for i in range(1, count):
        total = total + 2.0**-i * noise(2.0**i * u, 2.0**i * v, 2.0**i * w, seed=first + i)
    return total
