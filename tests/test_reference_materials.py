"""What surfaces are made of in the reference: paint through operators, blends across smooth ones, own coordinates."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from painted import BLUE, GREEN, PAINTED, RED, A, B, K, X, Y, a, b, hits, mixed, norm, paint, seen, share_of_b

NEAR = 1e-7  # of colours: hits lie up to 1e-9 off the surface, where normals of edges begin to turn


@pytest.mark.parametrize("name", PAINTED)
def test_surfaces_have_the_colour_of_their_paint(name: str):
    shape, expected = PAINTED[name]
    found = hits(seen(shape, om.reference.render))
    assert_allclose(found.color, expected(found), rtol=0, atol=NEAR)
    assert len(np.unique(found.color, axis=0)) > 1


def test_many_operands_blend_from_the_left():
    third = om.sphere(0.5, (0.2, 0.3, 0.8))
    shape = om.union(paint(A, RED), B, paint(third, GREEN), smooth=K)
    found = hits(seen(paint(shape, BLUE), om.reference.render))
    p = found.p
    first = np.minimum(a(p), b(p)) - np.maximum(K - np.abs(a(p) - b(p)), 0) ** 2 / (4 * K)
    c = norm(p - [0.2, 0.3, 0.8]) - 0.5
    expected = mixed(share_of_b(first, c, K), mixed(share_of_b(a(p), b(p), K), RED, BLUE), GREEN)
    assert_allclose(found.color, expected, rtol=0, atol=NEAR)


def test_the_material_id_is_that_of_the_larger_share():
    image = seen(paint(A, RED).union(paint(B, BLUE), smooth=K), om.reference.render)
    hit = image.status == om.Status.HIT
    assert_array_equal(image.material_id[hit] == 1, image.color[hit][:, 2] >= 0.5)
    assert set(image.material_id[hit]) == {0, 1}


def test_what_leaves_its_range_is_clamped_where_it_is_used():
    found = hits(seen(paint(om.sphere(1.0), (X, om.sqrt(X), 3 * om.exp(Y * Y))), om.reference.render))
    x = found.p[:, 0]
    assert (x < 0).any()
    assert_array_equal(found.color[x < 0, :2], 0)  # below 0, and no number
    assert_allclose(found.color[x > 0, 1], np.sqrt(x[x > 0]), rtol=1e-12)
    assert (found.color[:, 2] >= 3).all()
