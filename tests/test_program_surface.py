"""The program of what surfaces are made of, on every instruction set, against the reference."""

import pytest
from numpy.testing import assert_allclose

import octomarch as om
from painted import PAINTED, seen

ROUNDING = 1e-9  # of colours between two ways to the same point: marches end within 1e-9 of each other


@pytest.mark.parametrize("name", PAINTED)
def test_colours_are_those_of_the_reference(name: str, isa: str):
    shape, _ = PAINTED[name]
    truth = seen(shape, om.reference.render)
    found = seen(shape, om.render, isa=isa, precision="float64")
    same = (truth.status == found.status) & (truth.material_id == found.material_id)
    assert same.mean() > 0.99  # rays along edges may go either way
    assert_allclose(found.color[same], truth.color[same], rtol=0, atol=ROUNDING)
