"""Walls along triply periodic surfaces, which divide space into two labyrinths: gyroid, Schwarz P, diamond.

Each is the shell of a `fields.field` f(k p) of period 2π in each coordinate, k = 2π / period, whose slope is at most
k √3; divided by that bound it is a lower bound of the distance. They fill all space: cut them with ``&``.

The bound √3, with s and c for sine and cosine of a coordinate:

- gyroid: ∂f/∂x = cx cy - sx sz, and so on in turn. By Cauchy and Schwarz (cx cy - sx sz)² ≤ (cx² + sx²)(cy² + sz²) =
  cy² + sz². The three together are at most (cy² + sz²) + (cz² + sx²) + (cx² + sy²) = 3.
- Schwarz P: |∇f|² = sx² + sy² + sz² ≤ 3.
- diamond: f = sz cos(x - y) + cz sin(x + y). With a = sin²(x - y), b = sin²(x + y), u = sz², the squares of ∂f/∂x and
  ∂f/∂y are together 2 u a + 2 (1 - u)(1 - b); that of ∂f/∂z is at most (1 - a) + b, as above. The sum is linear in each
  of a, b, u, so greatest in a corner of their unit cube, where it is at most 3.

All three reach √3, at points of their surfaces.
"""

from __future__ import annotations

import math

from octomarch import _validate as check
from octomarch.expressions import Expression, coordinates
from octomarch.fields import field
from octomarch.functions import cos, sin
from octomarch.shapes import Shape


def gyroid(period: float, thickness: float) -> Shape:
    """Return a wall along the gyroid, which repeats along x, y and z [1]_.

    The surface is ``sin x cos y + sin y cos z + sin z cos x = 0``, with x, y, z in turns of a period.
    The field is a lower bound: near the surface between 0.82 and 1 of the distance, so that walls are up to 1.22 times
    as thick as asked for.

    Parameters
    ----------
    period : float
        After which the surface repeats along x, y and z, > 0.
    thickness : float
        Of the wall where it is thinnest, at least 0. From ``0.276 period`` on nothing is left free.

    Returns
    -------
    Shape
        Endless.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, not finite or outside its range.

    References
    ----------
    .. [1] A. H. Schoen, "Infinite periodic minimal surfaces without self-intersections", NASA TN D-5541, 1970.

    Examples
    --------
    >>> import octomarch as om
    >>> sponge = om.gyroid(1.0, 0.06) & om.sphere(1.5)
    >>> round(float(sponge.distance([0, 0, 0])), 6)
    -0.03
    """
    x, y, z = _phases(period)
    return _wall(sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x), period, thickness)


def schwarz_p(period: float, thickness: float) -> Shape:
    """Return a wall along Schwarz' P surface, which repeats along x, y and z [1]_.

    The surface is ``cos x + cos y + cos z = 0``, with x, y, z in turns of a period.
    The field is a lower bound: near the surface between 0.57 and 1 of the distance, so that walls are up to 1.74 times
    as thick as asked for.

    Parameters
    ----------
    period : float
        After which the surface repeats along x, y and z, > 0.
    thickness : float
        Of the wall where it is thinnest, at least 0. From ``0.552 period`` on nothing is left free.

    Returns
    -------
    Shape
        Endless.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, not finite or outside its range.

    References
    ----------
    .. [1] A. H. Schoen, "Infinite periodic minimal surfaces without self-intersections", NASA TN D-5541, 1970.

    Examples
    --------
    >>> import octomarch as om
    >>> sponge = om.schwarz_p(1.0, 0.06) & om.box(2.0)
    >>> round(float(sponge.distance([0.25, 0.25, 0.25])), 6)
    -0.03
    """
    x, y, z = _phases(period)
    return _wall(cos(x) + cos(y) + cos(z), period, thickness)


def diamond(period: float, thickness: float) -> Shape:
    """Return a wall along Schwarz' diamond surface, which repeats along x, y and z [1]_.

    The surface is ``sin z cos(x - y) + cos z sin(x + y) = 0``, with x, y, z in turns of a period.
    The field is a lower bound: near the surface between 0.82 and 1 of the distance, so that walls are up to 1.22 times
    as thick as asked for.

    Parameters
    ----------
    period : float
        After which the surface repeats along x, y and z, > 0.
    thickness : float
        Of the wall where it is thinnest, at least 0. From ``0.26 period`` on nothing is left free.

    Returns
    -------
    Shape
        Endless.

    Raises
    ------
    TypeError, ValueError
        If an argument is no number, not finite or outside its range.

    References
    ----------
    .. [1] A. H. Schoen, "Infinite periodic minimal surfaces without self-intersections", NASA TN D-5541, 1970.

    Examples
    --------
    >>> import octomarch as om
    >>> sponge = om.diamond(1.0, 0.06) & om.box(2.0)
    >>> round(float(sponge.distance([0, 0, 0])), 6)
    -0.03
    """
    x, y, z = _phases(period)
    return _wall(sin(z) * cos(x - y) + cos(z) * sin(x + y), period, thickness)


def _phases(period: float) -> list[Expression]:
    """Return the coordinates as angles: a full turn every period."""
    turns = 2 * math.pi / check.positive("period", period)
    if not math.isfinite(turns):
        raise ValueError(f"period must be large enough for its inverse to be finite, got {period!r}")
    return [turns * coordinate for coordinate in coordinates()]


def _wall(level: Expression, period: float, thickness: float) -> Shape:
    """Return the shell of a function of phases whose slope is at most √3 per unit of phase."""
    unit = period / (2 * math.pi * math.sqrt(3))
    return field(unit * level, lipschitz=1.0).shell(check.non_negative("thickness", thickness))
