"""What the compiler makes of a shape, read off the listing: shared parts once, transforms folded, registers reused.

That the program still means the shape is for test_ops_distance.py to say.
"""

import threading
from collections.abc import Callable

import pytest

import octomarch as om

BOX = om.box((1, 2, 3))
BALL = om.sphere(0.5)
MANY = 100_000


def mnemonics(shape: om.Shape) -> list[str]:
    """Return the operations of a shape's program in order."""
    lines = str(om.compile(shape)).splitlines()
    return [line.split(" = ")[1].split()[0] for line in lines if line[0].isdigit()]


# Instructions ---------------------------------------------------------------------------------------------------------


def test_listing_is_legible():
    shape = (om.sphere(1.0) | om.box(1.5, center=(2, 0, 0))) - om.cylinder(0.25)
    assert str(om.compile(shape)).splitlines() == [
        "distance program: 5 instructions, 4 registers; r0 r1 r2 = x y z, result in r0",
        "0    r3          = origin_sphere       r0 r1 r2        1",
        "1    r1          = box                 r0 r1 r2        2, 0, 0, 0.75, 0.75, 0.75",
        "2    r1          = union               r3 r1",
        "3    r0          = origin_cylinder     r0 r2           0.25",
        "4    r0          = difference          r1 r0",
        "bounds (-1, -1, -1) .. (2.75, 1, 1)",
        "lipschitz 1",
    ]


def test_listing_says_when_neighbouring_cells_are_looked_at():
    note = "repeats look at the neighbouring cell along"
    lopsided = om.capsule((0, 0, 0), (0.3, 0.2, 0), 0.1)
    assert note not in str(om.compile(om.sphere(0.3).repeat(1)))
    assert f"{note} 1 coordinate:" in str(om.compile(lopsided.repeat((1, None, 1))))
    assert f"{note} 2 coordinates:" in str(om.compile(lopsided.repeat(1)))


FOLDED = {
    "moved": (BOX.translate(1, 2, 3), ["box"]),
    "scaled": (BOX.scale(2), ["origin_box"]),
    "quarter turn": (BOX.rotate(90, "z"), ["origin_box"]),
    "half turn": (BOX.translate(1, 0, 0).rotate(180, "y"), ["box"]),
    "painted": (BOX.paint(om.Material(0.5)), ["origin_box"]),
    "all of these": (BOX.translate(1, 0, 0).scale(3).rotate(-90, "x").translate(0, 1, 0).rotate(270, "y"), ["box"]),
    "turned about and back": (BOX.translate(1, 0, 0).translate(-1, 0, 0), ["origin_box"]),
    "ball turned": (BALL.translate(1, 0, 0).rotate(33, (1, 2, 3)), ["sphere"]),
    "plane turned": (om.plane().rotate(33, (1, 2, 3)), ["plane"]),
    "capsule turned": (om.capsule((1, 0, 0), (0, 1, 0), 0.5).rotate(33), ["capsule"]),
    "cylinder laid down": (om.cylinder(1.0).rotate(90, "x"), ["origin_cylinder"]),
    "cylinder moved along itself": (om.cylinder(1.0).translate(0, 5, 0), ["origin_cylinder"]),
    "torus moved": (om.torus(1, 0.25, axis="z", center=(0, 1, 0)), ["torus"]),
    "plane along an axis": (om.plane((0, 0, 2), (0, 0, 1)), ["axis_plane"]),
    "box turned": (BOX.rotate(33), ["rotate", "origin_box"]),
    "two turned together": ((BOX | om.cylinder(1, 1)).rotate(33), ["rotate", "origin_box", "capped_cylinder", "union"]),
    "turned twice": (BOX.rotate(20).rotate(30, "x"), ["rotate", "origin_box"]),
    "endless along all axes": (BALL.repeat(2), ["repeat", "origin_sphere"]),
    "endless along one axis": (BALL.repeat((2, None, None)), ["repeat_axis", "origin_sphere"]),
    "counted along one axis": (BALL.repeat((2, None, None), 3), ["repeat_counted", "origin_sphere"]),
    "one copy": (BALL.repeat(2, 1), ["origin_sphere"]),
    "grid moved": (BALL.repeat((2, None, None)).translate(1, 0, 0), ["repeat_axis", "sphere"]),
}


@pytest.mark.parametrize("name", FOLDED)
def test_transforms_are_folded(name: str):
    shape, expected = FOLDED[name]
    assert mnemonics(shape) == expected


SIMPLER = {
    "union with itself": (BOX | BOX, ["origin_box"]),
    "equal parts built apart": (om.union(BOX, om.box((1, 2, 3)), BOX), ["origin_box"]),
    "intersection with itself": (BOX & BOX, ["origin_box"]),
    "two complements": (~~BOX, ["origin_box"]),
    "two complements apart": (~(~BOX).translate(1, 0, 0), ["box"]),
    "intersection with a complement": (BOX & ~BALL, ["origin_box", "origin_sphere", "difference"]),
    "difference from a complement": (BOX - ~BALL, ["origin_box", "origin_sphere", "intersection"]),
    "blend of no width": (BOX.union(BALL, smooth=0), ["origin_box", "origin_sphere", "union"]),
}


@pytest.mark.parametrize("name", SIMPLER)
def test_what_needs_no_instruction_has_none(name: str):
    shape, expected = SIMPLER[name]
    assert sorted(mnemonics(shape)) == sorted(expected)


def test_shared_parts_are_computed_once():
    part = BOX.union(BALL.translate(1, 0, 0), smooth=0.25)
    shape = (part | om.torus(1, 0.25)) - (part & om.cylinder(1.0))
    names = mnemonics(shape)
    assert names.count("origin_box") == names.count("sphere") == names.count("smooth_union") == 1
    assert len(names) == 8


def test_equal_places_reached_in_different_ways_are_one():
    """A half turn takes the box onto itself: only the union's two operands differ."""
    pair = BOX | BOX.translate(2, 0, 0)
    assert mnemonics(pair & pair.rotate(180, "y")).count("origin_box") == 1
    assert mnemonics(BALL.translate(2, 0, 0) | BALL.scale(0.5).translate(1, 0, 0).scale(2)) == ["sphere"]


def test_one_part_in_two_places_is_computed_twice():
    assert mnemonics(BALL | BALL.translate(1, 0, 0)) == ["origin_sphere", "sphere", "union"]


def test_smooth_widths_and_sizes_are_scaled():
    scaled = BALL.union(BOX, smooth=0.25).scale(4)
    assert scaled.distance([0, 0, 0]) == 4 * BALL.union(BOX, smooth=0.25).distance([0, 0, 0])
    assert "smooth_union        r3 r0           1, 0.25" in str(om.compile(scaled))


def test_content_without_symmetry_is_looked_at_in_the_next_cells_too():
    assert mnemonics(BALL.repeat(2)).count("origin_sphere") == 1
    leaning = BALL.translate(0.25, 0, 0)
    assert mnemonics(leaning.repeat((2, None, None))) == [
        "repeat_axis",
        "sphere",
        "repeat_neighbour",
        "sphere",
        "union",
    ]
    assert mnemonics(leaning.repeat(2)).count("sphere") == 2  # y and z are mirrored
    assert mnemonics(om.box(0.5, center=(0.1, 0.1, 0.1)).repeat(2)).count("box") == 8
    assert mnemonics(om.box(0.5).rotate(30).repeat(2)).count("origin_box") == 4
    turned_ball = om.sphere(0.5).rotate(30)
    assert mnemonics(turned_ball.repeat(2)) == ["repeat", "origin_sphere"]


# Size ----------------------------------------------------------------------------------------------------------------


def chain(link: Callable[[om.Shape, int], om.Shape]) -> om.Shape:
    shape = om.sphere(0.25)
    for i in range(MANY):
        shape = link(shape, i)
    return shape


def pairwise(shapes: list[om.Shape]) -> om.Shape:
    while len(shapes) > 1:
        shapes = [a | b for a, b in zip(shapes[::2], shapes[1::2], strict=True)]
    return shapes[0]


def ball(i: int) -> om.Shape:
    return om.sphere(0.5, center=(i, 0, 0))


GRAPHS = {  # shape, instructions, registers at the most
    "wide": (lambda: om.union(*map(ball, range(MANY)), smooth=0.1), 2 * MANY - 1, 5),
    "deep to the left": (lambda: chain(lambda shape, i: shape | ball(i)), 2 * MANY + 1, 5),
    "deep to the right": (lambda: chain(lambda shape, i: ball(i) | shape), 2 * MANY + 1, 5),
    "balanced": (lambda: pairwise([ball(i) for i in range(2**16)]), 2**17 - 1, 3 + 17),
    "moved again and again": (lambda: chain(lambda shape, _: ~(~shape).translate(0, 1, 0)), 1, 3),
    "turned again and again": (lambda: chain(lambda shape, _: (shape | BOX).rotate(90)), None, 5),
}


@pytest.mark.parametrize("name", GRAPHS)
def test_size_of_a_graph_is_no_limit(name: str):
    """Built, compiled and dropped on a stack that the graph would overflow if anything descended it by calls."""
    build, instructions, registers = GRAPHS[name]
    programs: list[om.Program] = []
    before = threading.stack_size(256 * 1024)
    try:
        thread = threading.Thread(target=lambda: programs.append(om.compile(build())))
        thread.start()
    finally:
        threading.stack_size(before)
    thread.join()
    (program,) = programs
    assert program.instructions == instructions or instructions is None
    assert program.instructions <= 2 * MANY + 1
    assert program.registers <= registers


def test_work_grows_with_what_is_shared_and_not_with_what_it_unfolds_to():
    shape = BALL
    for _ in range(200):  # unfolds to 3**200 balls
        shape = shape.union(~shape, smooth=0.01) | shape
    assert om.compile(shape).instructions == 1 + 3 * 200
    moved = BALL
    for i in range(14):  # 2**14 places, all different
        moved = moved | moved.translate(2.0**i, 0, 0)
    assert om.compile(moved).instructions == 2 * 2**14 - 1


def test_too_many_values_at_once_are_refused():
    """Every ball is kept until the second half reads it, each time in another company."""
    balls = [ball(i) for i in range(70_000)]
    first, second = balls[0], balls[-1]
    for one, other in zip(balls, reversed(balls), strict=True):
        first, second = first | one, second & other
    with pytest.raises(om.SceneError, match="more than 65535 registers"):
        om.compile(first - second)
    assert om.compile(first | om.sphere(1.0)).registers <= 5


# Who else holds nodes ------------------------------------------------------------------------------------------------


def test_programs_do_not_depend_on_who_holds_their_parts():
    """Walks remember only nodes with several owners: whether somebody keeps a part must not show."""

    def built() -> tuple[om.Shape, list[om.Shape]]:
        parts = [om.sphere(0.3 + i / 10, center=(i, 0, 0)) for i in range(3)]
        parts += [om.regular_polygon(5, 0.3).extrude(0.2).translate(0, i, 0) for i in range(3)]
        parts += [parts[0] - parts[3], parts[3].repeat((2, None, None)), parts[1].paint(om.Material(0.5))]
        return om.union(*parts, smooth=0.1), parts

    shape, kept = built()
    with_owners = str(om.compile(shape)), om.compile(shape).objects, repr(shape)
    del shape, kept
    shape = built()[0]
    assert (str(om.compile(shape)), om.compile(shape).objects, repr(shape)) == with_owners


def test_parts_below_paints_are_compiled_once():
    """Each level places the one before twice, and the paints of that make the two places one again."""
    red, blue = om.Material((1, 0, 0)), om.Material((0, 0, 1))
    shape = om.box(1.0)
    for _ in range(60):
        shape = shape.paint(red).round(0.001) | shape.paint(blue).translate(0, 0, 0)
    program = om.compile(shape)
    assert program.objects == [("box", 0), ("box", 1)]  # the innermost paints, of the first level
    assert program.instructions < 200


def test_flat_parts_are_compiled_once_however_they_are_extruded():
    slabs = om.union(*(om.regular_polygon(300, 1.0).extrude(0.5).translate(0, 0, i) for i in range(100)))
    assert mnemonics(slabs).count("polygon_edge") == 300
