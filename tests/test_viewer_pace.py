"""Pictures of a moving view are as fine as is quick, and do not change to and fro."""

import pytest

from octomarch.viewer.pace import COARSE, Pace, Quality

LIT = Quality()


def settle(pace: Pace, dear: float, lit: float, pictures: int = 200) -> list[Quality]:
    """Take pictures that cost that many seconds without light and with it at full size; return their qualities."""
    taken = []
    for _ in range(pictures):
        quality = pace.quality
        taken.append(quality)
        pace.took(lit if quality.is_lit else dear / quality.scale**2)
    return taken


def test_the_first_picture_is_coarse():
    assert Pace().quality == Quality(scale=2, is_lit=False)


def test_quick_scenes_are_shown_in_full():
    assert settle(Pace(0.02), 0.002, 0.006)[-100:] == [LIT] * 100


def test_light_is_left_out_where_it_takes_too_long():
    taken = settle(Pace(0.02), 0.007, 0.05)
    assert taken[-1] == Quality(is_lit=False)
    assert sum(quality == LIT for quality in taken) <= 6 * 3  # tried now and then, never for long


@pytest.mark.parametrize("dear", [0.03, 0.1, 0.5, 2.0])
def test_dear_scenes_are_shown_as_fine_as_the_budget_allows(dear: float):
    taken = settle(Pace(0.02), dear, 3 * dear)
    assert len(set(taken[10:])) == 1
    scale = taken[-1].scale
    assert dear / scale**2 <= 0.02
    finer = max((quality.scale for quality in COARSE if quality.scale < scale), default=scale)
    assert dear / finer**2 > 0.8 * 0.02


def test_hopeless_scenes_are_shown_as_coarse_as_there_is():
    assert settle(Pace(0.02), 60.0, 200.0)[-1] == COARSE[-1]


def test_one_slow_picture_does_not_count():
    pace = Pace(0.02)
    settle(pace, 0.03, 0.1)
    before = pace.quality
    pace.took(1.0)
    assert pace.quality == before


def test_a_dear_view_is_noticed_and_forgotten():
    pace = Pace(0.02)
    settle(pace, 0.002, 0.006)
    settle(pace, 0.2, 0.6, 10)
    assert pace.quality.scale >= 4
    settle(pace, 0.002, 0.006)
    assert pace.quality == LIT


def test_sizes_cover_the_window():
    assert Quality(scale=7).size((48, 36)) == (7, 6)
    assert Quality(scale=16).size((3, 2)) == (1, 1)
