"""Pictures that show nothing say why, once, where the user called, and others say nothing."""

import re
import warnings
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import octomarch as om
from octomarch import empty
from octomarch.cli import main
from octomarch.planes import PLANES

BALL, FLOOR = om.sphere(1.0), om.plane(point=(0, -1, 0))
FRONT = om.Camera((0, 0, 4), (0, 0, 0))
SIZE = (64, 48)
x, y, z = om.coordinates()

EMPTY: dict[str, tuple[tuple[Any, ...], dict[str, Any], str]] = {
    "eye inside": (
        (om.sphere(5.0), FRONT),
        {},
        r"100% of the rays begin inside the solid .*about the eye \(0, 0, 4\): move the camera's eye out",
    ),
    "eye inside, parallel rays": (
        (om.box(9.0), om.OrthographicCamera((0, 0, 4), (0, 0, 0), height=2)),
        {},
        "100% of the rays begin inside the solid",
    ),
    "beyond max_distance": (
        (BALL, FRONT),
        {"march": om.March(max_distance=2)},
        r"everything lies beyond max_distance=2: the nearest is 3 from the eye \(0, 0, 4\); give om.March a larger",
    ),
    "nearer than min_distance": (
        (BALL, FRONT),
        {"march": om.March(min_distance=9, max_distance=20)},
        "everything lies nearer than min_distance=9: the farthest is",
    ),
    "all steps spent": (
        (BALL | FLOOR, om.Camera((0, 0, 4), (0, -0.5, 0))),
        {"march": om.March("plain", max_steps=3)},
        r"% of the rays spent all of max_steps=3 before .*: give om.March a larger max_steps$",
    ),
    "steep field": (
        (om.field(om.sin(40 * x) + y, lipschitz=41), om.Camera((0, 9, 4), (0, 0, 0))),
        {"march": om.March("plain", max_steps=20)},
        "spent all of max_steps=20 .*Lipschitz bound is 41",
    ),
    "fixed steps": (
        (om.solid(x * x + y * y + z * z <= 1), FRONT),
        {"march": om.March("fixed", step=0.001, max_steps=30)},
        "larger max_steps, or a step longer than 0.001",
    ),
    "no numbers": (
        (om.field(om.sqrt(-1 - x * x), lipschitz=1), FRONT),
        {},
        "100% of the rays met no number .*NaN",
    ),
    "looking past": (
        (BALL, om.Camera((0, 0, 4), (0, 9, 4), up=(0, 0, 1))),
        {},
        r"the camera looks past the scene, which lies about \(0, 0, 0\): aim its target there",
    ),
    "looking past, parallel rays": (
        (BALL, om.OrthographicCamera((9, 0, 4), (9, 0, 0), height=2)),
        {},
        "the camera looks past the scene",
    ),
    "looking away": (
        (FLOOR, om.Camera((0, 0, 4), (0, 9, 4), up=(0, 0, 1))),
        {},
        "no ray meets a surface: it lies elsewhere than the camera looks",
    ),
    "nothing left": ((BALL - om.sphere(1.5), FRONT), {}, "no ray meets a surface: .*nothing is left of it"),
    "apart": ((BALL & om.sphere(1.0).translate(5, 0, 0), FRONT), {}, "nothing"),
}
FULL: dict[str, tuple[tuple[Any, ...], dict[str, Any]]] = {
    "a ball": ((BALL, FRONT), {}),
    "a ball, framed": ((BALL,), {}),
    "a ball in a corner": ((om.sphere(0.03).translate(1.5, 1.2, 0), FRONT), {}),
    "a floor below the sky": ((FLOOR, om.Camera((0, 0, 4), (0, 1, 0))), {}),
    "some steps spent": ((BALL, FRONT), {"march": om.March(max_steps=9)}),
    "a hollow ball from within": ((om.sphere(5.0).shell(0.1), FRONT), {}),
    "a room from all sides": ((~om.box(9.0), om.PanoramicCamera((0, 0, 4), (0, 0, 0))), {}),
    "a solid": ((om.solid(x * x + y * y + z * z <= 1), FRONT), {}),
}


def render_quietly(*arguments: Any, **options: Any) -> list[warnings.WarningMessage]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        om.render(*arguments, size=SIZE, **options)
    return caught


@pytest.mark.parametrize("name", EMPTY)
@pytest.mark.parametrize("planes", [("color",), ("depth", "steps"), ("object_id",), ("position",), tuple(PLANES)])
def test_pictures_of_nothing_say_why(name: str, planes: tuple[str, ...], isa: str):
    arguments, options, message = EMPTY[name]
    with pytest.warns(om.RenderWarning, match=f"^nothing to be seen: .*{message}") as caught:
        om.render(*arguments, size=SIZE, planes=planes, isa=isa, **options)
    assert len(caught) == 1
    assert Path(caught[0].filename) == Path(__file__)


@pytest.mark.parametrize("name", FULL)
@pytest.mark.parametrize("planes", [("color",), ("depth",), ("position",), ("material_id",), tuple(PLANES)])
def test_other_pictures_say_nothing(name: str, planes: tuple[str, ...]):
    arguments, options = FULL[name]
    assert not render_quietly(*arguments, planes=planes, **options)


def test_several_samples_and_shots_say_why_too():
    with pytest.warns(om.RenderWarning, match="begin inside the solid"):
        om.render(om.sphere(5.0), FRONT, SIZE, samples=4)
    with pytest.warns(om.RenderWarning, match="begin inside the solid") as caught:
        om.Shot(om.Scene(om.sphere(5.0)), FRONT, SIZE).render()
    assert Path(caught[0].filename) == Path(__file__)


def test_crops_say_nothing():
    """Parts of a picture may well be empty."""
    assert not render_quietly(om.sphere(5.0), FRONT, crop=(0, 0, 9, 9))


def test_full_pictures_are_not_looked_at_twice(monkeypatch: pytest.MonkeyPatch):
    looked: list[object] = []
    monkeypatch.setattr(empty, "_reason", lambda *arguments: looked.append(arguments))
    for arguments, options in FULL.values():
        om.render(*arguments, size=SIZE, **options)
    assert looked == []


def test_a_small_thing_in_a_large_picture_is_something():
    """Of 2048² pixels it covers a few, which the look at 128² does not see."""
    tiny = om.sphere(0.002).translate(0.511, 0.317, 0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        image = om.render(tiny, FRONT, (2048, 2048), planes="depth")
    assert 0 < np.isfinite(image.depth).sum() < 100


def test_reasons_hold_where_pixels_are_few_and_many():
    """The look at few pixels marches to the epsilon of the many: else rays would end before their steps do."""
    grazing = om.Camera((0, 0.01, 4), (0, -0.01, 0), fov=1)
    march = om.March("plain", max_steps=60, pixel_tolerance=0.5)
    with pytest.warns(om.RenderWarning, match="spent all of max_steps=60"):
        image = om.render(om.plane(), grazing, (2000, 1500), planes=("status",), march=march)
    with pytest.warns(om.RenderWarning, match="spent all of max_steps=60"):
        om.render(om.plane(), grazing, (2000, 1500), planes=("depth",), march=march)
    assert (image.status == om.Status.STEP_LIMIT).mean() > 0.5


# Long work -----------------------------------------------------------------------------------------------------------


class StoppedError(Exception):
    pass


def stop(*_: int) -> None:
    raise StoppedError


INSIDE = om.Camera((0, 0, 0.01), (0, 0, 0))


def test_large_pictures_are_told_before_they_are_rendered(tmp_path: Path):
    with pytest.warns(om.RenderWarning, match="begin inside the solid") as caught, pytest.raises(StoppedError):
        om.render_file(om.sphere(1.0), INSIDE, (16384, 16384), out=tmp_path / "a.exr", progress=stop)
    assert [each.filename for each in caught] == [__file__]


def test_frames_are_told_here_when_others_render_them(tmp_path: Path):
    with (
        ThreadPoolExecutor(1) as pool,
        pytest.warns(om.RenderWarning, match="begin inside the solid") as caught,
        pytest.raises(StoppedError),
    ):
        om.render_frames(om.sphere(1.0), [INSIDE] * 2, (16, 12), out=tmp_path / "{}.exr", executor=pool, progress=stop)
    assert caught[0].filename == __file__


def test_the_command_tells_in_a_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    om.Shot(om.Scene(om.sphere(1.0)), INSIDE, (16, 12)).save(tmp_path / "a.json")
    with warnings.catch_warnings():
        warnings.simplefilter("always")
        assert main(["render", str(tmp_path / "a.json"), "-o", str(tmp_path / "a.png"), "-q"]) == 0
    assert re.fullmatch(r"octomarch: warning: nothing to be seen: .*\n", capsys.readouterr().err)
