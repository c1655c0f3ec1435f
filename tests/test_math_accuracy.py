"""The functions that expressions are made of, against mpmath.

docs/accuracy.md has what benchmarks/ulp.py found with far more arguments; tests/cpp/test_math.cpp has special ones.
"""

import numpy as np
import pytest

import octomarch as om
from math_cases import CASES, errors, evaluated

COUNT = 1000
"""Arguments of each kind; mpmath takes about 20 µs for one."""


@pytest.mark.parametrize("name", CASES)
def test_errors_are_within_what_is_documented(name: str, precision: str) -> None:
    case = CASES[name]
    arguments = case.arguments(np.random.default_rng(7), np.dtype(precision).type, COUNT)
    found = errors(case, arguments)
    worst = int(found.argmax())
    assert found[worst] < case.limit, f"{name} at {[operand[worst].item().hex() for operand in arguments]}"


def test_mod_is_its_formula(precision: str) -> None:
    rng = np.random.default_rng(7)
    x = rng.uniform(-100, 100, COUNT).astype(precision)
    y = rng.uniform(0.1, 10, COUNT).astype(precision)
    plain = np.maximum(x - y * np.floor(x / y), 0)
    found = evaluated(om.mod, (x, y))
    np.testing.assert_array_equal(found, np.where(plain >= y, 0, plain))
    np.testing.assert_array_equal(evaluated(om.mod, (-x, -y)), -found)


@pytest.mark.parametrize("name", CASES)
def test_functions_give_the_same_bits_on_every_isa(name: str, precision: str, isa: str) -> None:
    case = CASES[name]
    arguments = case.arguments(np.random.default_rng(7), np.dtype(precision).type, COUNT)
    unsigned = {"float32": np.uint32, "float64": np.uint64}[precision]
    found, scalar = (evaluated(case.ours, arguments, which).view(unsigned) for which in (isa, "scalar"))
    np.testing.assert_array_equal(found, scalar)
