"""Turns what users pass into what the native module takes: floats, 3-tuples, contiguous arrays.

Comes before every other module of the package but `_spelling`. A wrong type is a `TypeError`, a value outside its
domain a `ValueError`; both name the argument and show the value. Numbers that native builders check are only converted
here.
"""

from __future__ import annotations

import math
import numbers
import os
from collections.abc import Iterable, Sequence
from typing import Any, Literal, TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from octomarch._spelling import nearest

Vec2: TypeAlias = tuple[float, float]
Vec3: TypeAlias = tuple[float, float, float]
VectorLike: TypeAlias = Sequence[float] | NDArray[Any]
ColorLike: TypeAlias = float | VectorLike
AxisLetter: TypeAlias = Literal["x", "y", "z"]
AxisLike: TypeAlias = AxisLetter | VectorLike
Precision: TypeAlias = Literal["float32", "float64"]
Name = TypeVar("Name", bound=str)

_AXES: dict[str, Vec3] = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}


def shown(value: object) -> str:
    """Return `value` as it appears in messages: one line, not longer than a line."""
    text = " ".join(repr(value).split())
    return text if len(text) <= 80 else text[:77] + "..."


def is_number(value: object) -> bool:
    """Tell whether `value` is one real number, and not an array or a truth value."""
    return isinstance(value, numbers.Real) and not isinstance(value, (bool, np.bool_))


def number(name: str, value: object) -> float:
    """Return a real number as float; NaN and infinities pass."""
    if type(value) is float:  # by far the most frequent, and asking an abstract class is slow
        return value
    if isinstance(value, np.ndarray) and value.ndim == 0:
        value = value[()]
    if is_number(value):
        try:
            return float(value)  # type: ignore[arg-type]
        except OverflowError:
            raise ValueError(f"{name} must fit a float, got {shown(value)}") from None
    raise TypeError(f"{name} must be a number, got {shown(value)}")


def finite(name: str, value: object) -> float:
    """Return a finite number."""
    result = number(name, value)
    if not math.isfinite(result):
        raise ValueError(f"{name} must be finite, got {shown(value)}")
    return result


def non_negative(name: str, value: object) -> float:
    """Return a finite number ≥ 0."""
    result = finite(name, value)
    if result < 0:
        raise ValueError(f"{name} must be ≥ 0, got {shown(value)}")
    return result


def positive(name: str, value: object) -> float:
    """Return a finite number > 0."""
    result = finite(name, value)
    if result <= 0:
        raise ValueError(f"{name} must be > 0, got {shown(value)}")
    return result


def fraction(name: str, value: object) -> float:
    """Return a number in [0, 1]."""
    result = number(name, value)
    if not 0 <= result <= 1:
        raise ValueError(f"{name} must lie in [0, 1], got {shown(value)}")
    return result


def integer(name: str, value: object, minimum: int, maximum: int = 2**31 - 1) -> int:
    """Return an integer in [minimum, maximum]."""
    if not isinstance(value, numbers.Integral) or isinstance(value, bool):
        raise TypeError(f"{name} must be an integer, got {shown(value)}")
    result = int(value)
    if not minimum <= result <= maximum:
        raise ValueError(f"{name} must lie in [{minimum}, {maximum}], got {shown(value)}")
    return result


def sequence(name: str, value: object, what: str) -> list[Any]:
    """Return the items of an iterable that is neither text, a mapping nor a set; `what` completes "must be"."""
    if isinstance(value, Iterable) and not isinstance(value, (str, bytes, dict, set, frozenset)):
        if not isinstance(value, np.ndarray) or value.ndim == 1:
            return list(value)
        if value.ndim > 1:
            raise ValueError(f"{name} must be {what}, got an array of shape {value.shape}")
    raise TypeError(f"{name} must be {what}, got {shown(value)}")


def vector(name: str, value: object) -> Vec3:
    """Return three numbers; NaN and infinities pass."""
    if type(value) is tuple and [type(item) for item in value] == [float, float, float]:
        return value
    if type(value) is np.ndarray and value.shape == (3,) and value.dtype == np.float64:  # as rows of arrays are
        x, y, z = value.tolist()
        return x, y, z
    items = sequence(name, value, "three numbers")
    if len(items) != 3:
        raise ValueError(f"{name} must be three numbers, got {shown(value)}")
    x, y, z = (number(f"{name}[{i}]", item) for i, item in enumerate(items))
    return x, y, z


def point(name: str, value: object) -> Vec3:
    """Return three finite numbers."""
    result = vector(name, value)
    if not all(map(math.isfinite, result)):
        raise ValueError(f"{name} must be finite, got {shown(value)}")
    return result


def pair(name: str, value: object) -> Vec2:
    """Return two finite numbers."""
    items = sequence(name, value, "two numbers")
    if len(items) != 2:
        raise ValueError(f"{name} must be two numbers, got {shown(value)}")
    x, y = (number(f"{name}[{i}]", item) for i, item in enumerate(items))
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"{name} must be finite, got {shown(value)}")
    return x, y


def corners(name: str, value: object) -> tuple[Vec3, Vec3]:
    """Return two points; NaN and infinities pass."""
    items = sequence(name, list(value) if isinstance(value, np.ndarray) and value.ndim == 2 else value, "two corners")
    if len(items) != 2:
        raise ValueError(f"{name} must be two corners, got {shown(value)}")
    return vector(f"{name}[0]", items[0]), vector(f"{name}[1]", items[1])


def direction(name: str, value: object) -> Vec3:
    """Return three finite numbers that are not all zero, scaled to unit length."""
    x, y, z = point(name, value)
    largest = max(abs(x), abs(y), abs(z))
    if largest == 0:
        raise ValueError(f"{name} must not be the zero vector, got {shown(value)}")
    x, y, z = x / largest, y / largest, z / largest
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def axis(name: str, value: object) -> Vec3:
    """Return the direction of "x", "y", "z" or of three numbers, which native builders check."""
    if isinstance(value, str):
        if value not in _AXES:
            raise ValueError(f"{name} must be 'x', 'y', 'z' or three numbers, got {shown(value)}")
        return _AXES[value]
    return vector(name, value)


def axis_numbers(name: str, value: object) -> list[int]:
    """Return 0, 1 and 2 for "x", "y" and "z", or for several in one word, each once."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be letters of 'xyz', got {shown(value)}")
    if not value or len(set(value)) < len(value) or set(value) - set(_AXES):
        raise ValueError(f"{name} must be letters of 'xyz', each once, got {shown(value)}")
    return ["xyz".index(letter) for letter in value]


def axis_number(name: str, value: object) -> int:
    """Return 0, 1 or 2 for "x", "y" or "z"."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be one of 'x', 'y', 'z', got {shown(value)}")
    return "xyz".index(choice(name, value, ("x", "y", "z")))


def color(name: str, value: object) -> Vec3:
    """Return a linear RGB colour with components ≥ 0; one number means grey."""
    if is_number(value):
        grey = non_negative(name, value)
        return grey, grey, grey
    result = point(name, value)
    if min(result) < 0:
        raise ValueError(f"{name} must have components ≥ 0, got {shown(value)}")
    return result


def flag(name: str, value: object) -> bool:
    """Return a truth value."""
    if not isinstance(value, (bool, np.bool_)):
        raise TypeError(f"{name} must be True or False, got {shown(value)}")
    return bool(value)


def text(name: str, value: object) -> str:
    """Return a text."""
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a text, got {shown(value)}")
    return value


def choice(name: str, value: object, options: Sequence[str | None]) -> Any:
    """Return `value` if it is one of `options`."""
    if value is not None and not isinstance(value, str):
        raise TypeError(f"{name} must be one of {_listed(options)}, got {shown(value)}")
    if value not in options:
        meant = nearest(str(value), [option for option in options if option is not None])
        hint = f"; did you mean {meant!r}?" if meant else ""
        raise ValueError(f"{name} must be one of {_listed(options)}, got {shown(value)}{hint}")
    return value


def path(name: str, value: object) -> str:
    """Return the text of a path."""
    text = os.fspath(value) if isinstance(value, (str, os.PathLike)) else None
    if not isinstance(text, str):
        raise TypeError(f"{name} must be a path, got {shown(value)}")
    return text


def planes(value: object, options: Sequence[Name]) -> list[Name]:
    """Return the distinct names of `planes`, in the order of `options`; a single string is one name."""
    names = [value] if isinstance(value, str) else sequence("planes", value, "names of planes")
    if not names:
        raise ValueError("planes must name at least one plane, got none")
    for name in names:
        choice("planes", name, options)
    return [name for name in options if name in names]


def points(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Return real numbers of shape (..., 3) as a contiguous float64 array; NaN and infinities pass."""
    array = _real_numbers(name, value, "(..., 3)")
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"{name} must have shape (..., 3), got {_shape(array)}{_turned(name, array)}")
    return np.ascontiguousarray(array, dtype=np.float64)


def rows(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Return real numbers of shape (n, 3), n ≥ 1, as a contiguous float64 array; NaN and infinities pass."""
    array = _real_numbers(name, value, "(n, 3)")
    if array.ndim != 2 or array.shape[1] != 3 or not len(array):
        raise ValueError(f"{name} must have shape (n, 3) with n ≥ 1, got {_shape(array)}{_turned(name, array)}")
    return np.ascontiguousarray(array, dtype=np.float64)


def _turned(name: str, array: NDArray[Any]) -> str:
    """Return what to add where only rows and columns were mixed up."""
    return f"; its transpose, {name}.T, would do" if array.ndim == 2 and array.shape[0] == 3 else ""


def volume(name: str, value: ArrayLike) -> NDArray[np.float32]:
    """Return real numbers of shape (nx, ny, nz) as a contiguous float32 array; NaN and infinities pass."""
    array = _real_numbers(name, value, "(nx, ny, nz)")
    if array.ndim != 3:
        raise ValueError(f"{name} must have shape (nx, ny, nz), got {_shape(array)}")
    with np.errstate(over="ignore"):  # what is too large becomes infinite
        return np.ascontiguousarray(array, dtype=np.float32)


def spread(name: str, value: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return real numbers, broadcast to `shape`, as a contiguous float64 array; NaN and infinities pass."""
    array = _real_numbers(name, value, str(shape))
    try:
        return np.ascontiguousarray(np.broadcast_to(array, shape), dtype=np.float64)
    except ValueError:
        raise ValueError(f"{name} must broadcast to shape {shape}, got shape {array.shape}") from None


def broadcastable(name: str, value: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return real numbers that broadcast against `shape`; NaN and infinities pass."""
    array = _real_numbers(name, value, str(shape))
    try:
        np.broadcast_shapes(array.shape, shape)
    except ValueError:
        raise ValueError(f"{name} must broadcast against shape {shape}, got shape {array.shape}") from None
    return array.astype(np.float64)


def matrices(name: str, value: ArrayLike) -> tuple[NDArray[np.float64], float]:
    """Return n ≥ 1 affine matrices as a contiguous float64 array (n, 3, 4), and how far they are rounded."""
    array = _real_numbers(name, value, "(n, 3, 4) or (n, 4, 4)")
    if array.ndim != 3 or array.shape[1:] not in ((3, 4), (4, 4)) or not len(array):
        raise ValueError(f"{name} must have shape (n, 3, 4) or (n, 4, 4) with n ≥ 1, got {_shape(array)}")
    last = array[:, 3:]
    wrong = np.flatnonzero((last != (0, 0, 0, 1)).any(axis=(1, 2)))
    if len(wrong):
        i = int(wrong[0])
        row = shown(tuple(last[i, 0].tolist()))
        raise ValueError(f"{name}[{i}] must end in the row (0, 0, 0, 1), got {row}")
    precision = array.dtype if array.dtype.kind == "f" else np.float64
    rounding = 4 * max(float(np.finfo(precision).eps), float(np.finfo(np.float64).eps))
    return np.ascontiguousarray(array[:, :3], dtype=np.float64), rounding


def _real_numbers(name: str, value: ArrayLike, shape: str) -> NDArray[Any]:
    """Return an array of real numbers; `shape` is what to say of one that is ragged."""
    try:
        array = np.asarray(value)
    except ValueError as error:  # a ragged nesting
        raise ValueError(f"{name} must have shape {shape}, got {shown(value)}") from error
    if array.dtype.kind not in "fiu":
        raise TypeError(f"{name} must be real numbers, got {shown_array(array, value)}")
    return array


def shown_array(array: NDArray[Any], value: object) -> str:
    """Return how the array made of `value` appears in messages: by its type, or, if it was no array, as it came."""
    return f"an array of dtype {array.dtype}" if isinstance(value, np.ndarray) else shown(value)


def _shape(array: NDArray[Any]) -> str:
    """Return how an array of a wrong shape appears in messages."""
    return f"shape {array.shape}" if array.ndim else shown(array.item())


def size(value: object) -> tuple[int, int]:
    """Return (width, height), at most 2²⁸ pixels together."""
    items = sequence("size", value, "(width, height)")
    if len(items) != 2:
        raise ValueError(f"size must be (width, height), got {shown(value)}")
    width, height = (integer(f"size[{i}]", item, 1) for i, item in enumerate(items))
    if width * height > 2**28:
        raise ValueError(f"size must hold at most 2**28 pixels, got {shown(value)}")
    return width, height


def crop(value: object, whole: tuple[int, int]) -> tuple[int, int, int, int]:
    """Return (x, y, width, height) inside a picture of the size `whole`; all of it for None."""
    if value is None:
        return 0, 0, *whole
    items = sequence("crop", value, "(x, y, width, height)")
    if len(items) != 4:
        raise ValueError(f"crop must be (x, y, width, height), got {shown(value)}")
    x, y = (integer(f"crop[{i}]", items[i], 0) for i in (0, 1))
    width, height = (integer(f"crop[{i}]", items[i], 1) for i in (2, 3))
    if x + width > whole[0] or y + height > whole[1]:
        raise ValueError(f"crop must lie within the size {whole}, got {shown(value)}")
    return x, y, width, height


def threads(value: object) -> int:
    """Return the number of threads, 0 for all cores (None)."""
    return 0 if value is None else integer("threads", value, 1, 4096)


def isa(value: object) -> str:
    """Return the name of an instruction set, "" for the best one (None); the native module checks the name."""
    if value is None:
        return ""
    if not isinstance(value, str):
        raise TypeError(f"isa must be a name or None, got {shown(value)}")
    if not value:
        raise ValueError("isa must be a name or None, got ''")
    return value


def precision(value: object) -> Precision:
    """Return "float32" or "float64"."""
    result: Precision = choice("precision", value, ("float32", "float64"))
    return result


def set_fields(instance: object, **fields: object) -> None:
    """Assign to fields of a frozen dataclass, from its own ``__init__``."""
    for name, value in fields.items():
        object.__setattr__(instance, name, value)


def _listed(options: Sequence[str | None]) -> str:
    return ", ".join(map(repr, options))
