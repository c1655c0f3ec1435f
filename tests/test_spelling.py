"""Misspelt arguments and words are answered with what was meant."""

import inspect
import pickle

import numpy as np
import pytest

import octomarch as om


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: om.render(om.sphere(1.0), sampels=4), r"render\(\) .* 'sampels'; did you mean 'samples'\?$"),
        (lambda: om.render(om.sphere(1.0), plane="depth"), "did you mean 'planes'"),
        (lambda: om.Camera(eye=(0, 0, 3), target=(0, 0, 0), fovy=40), r"^Camera\(\) .*did you mean 'fov'\?$"),
        (lambda: om.March(max_step=3), "did you mean 'max_steps'"),
        (lambda: om.Material(colour=0.5), "did you mean 'color'"),
        (lambda: om.sphere(radus=1.0), "did you mean 'radius'"),
        (lambda: om.sphere(1.0).raycast([0, 0, 3], direction=[0, 0, -1]), "did you mean 'directions'"),
        (lambda: om.sphere(1.0).union(om.box(1.0), smoth=0.1), "did you mean 'smooth'"),
        (lambda: om.reference.render(om.sphere(1.0), samplse=2), "did you mean 'samples'"),
        (lambda: om.Shot(om.Scene(om.sphere(1.0))).render(thread=2), "did you mean 'threads'"),
        (lambda: om.Shot.load(pth="a.json"), "did you mean 'path'"),
        (lambda: om.render_frames(om.sphere(1.0), output="{}.exr"), "did you mean 'out'"),
        (lambda: om.isas(best=True), "its arguments are none"),
        (lambda: om.box(1.0, wheels=4), "its arguments are size, center, form"),
    ],
)
def test_misspelt_arguments_are_answered_with_the_nearest(call, message: str):
    with pytest.raises(TypeError, match=message) as caught:
        call()
    assert "unexpected keyword argument" in str(caught.value)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: om.March("plian"), "got 'plian'; did you mean 'plain'"),
        (lambda: om.render(om.sphere(1.0), planes="normals"), "got 'normals'; did you mean 'normal'"),
        (lambda: om.render(om.sphere(1.0), precision="float23"), "did you mean 'float32'"),
        (lambda: om.Shading(shadows="smoth"), "got 'smoth'"),
    ],
)
def test_misspelt_words_are_answered_with_the_nearest(call, message: str):
    with pytest.raises(ValueError, match=message):
        call()


def test_other_errors_keep_their_message():
    with pytest.raises(TypeError, match=r"^radius must be a number, got 'one'$"):
        om.sphere("one")
    with pytest.raises(TypeError, match=r"missing 1 required positional argument: 'radius'$"):
        om.sphere()

    def of_the_user(**options):
        return om.sphere(1.0).distance(np.zeros(3), **options)

    with pytest.raises(TypeError, match="did you mean 'precision'"):
        of_the_user(precison="float32")

    def fails(done, total):
        dict_of_the_user = of_the_user
        dict_of_the_user(*(done, total))

    with pytest.raises(TypeError, match=r"of_the_user\(\) takes 0 positional arguments but 2 were given$"):
        om.render(om.sphere(1.0), progress=fails)


def test_functions_stay_what_they_are():
    assert list(inspect.signature(om.sphere).parameters) == ["radius", "center"]
    assert inspect.signature(om.Camera).parameters["fov"].default == 45.0
    assert pickle.loads(pickle.dumps(om.sphere)) is om.sphere
    assert pickle.loads(pickle.dumps(om.compile)) is om.compile
    assert om.render.__module__ == "octomarch.render"
    assert inspect.getsource(om.sphere).startswith("def sphere(")


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: om.sphere(1.0).distance(np.zeros((3, 7))),
            r"points must have shape \(\.\.\., 3\), got .*\(3, 7\)",
        ),
        (lambda: om.sphere(1.0).distance(np.zeros((3, 7))), r"its transpose, points\.T, would do"),
        (lambda: om.sphere(1.0).distance(np.zeros((2, 4))), r"got shape \(2, 4\)$"),
        (lambda: om.sphere(1.0).distance(3.0), r"points must have shape \(\.\.\., 3\), got 3\.0"),
        (lambda: om.sphere(1.0).raycast(np.zeros((4, 3)), np.zeros((5, 3))), r"\(4, 3\).*\(5, 3\)"),
        (
            lambda: om.spheres(np.zeros((3, 9)), 1.0),
            r"centers must have shape \(n, 3\).*\(3, 9\); .*centers\.T",
        ),
        (lambda: om.spheres(np.zeros((9, 3)), np.ones(8)), r"radii must broadcast to shape \(9,\), got shape \(8,\)"),
        (lambda: om.Image({"color": np.zeros((4, 5))}), r"color must have shape \(height, width, 3\), got \(4, 5\)"),
        (lambda: om.write_png("a.png", np.zeros((4, 5, 4))), r"colors must have shape .*got \(4, 5, 4\)"),
    ],
)
def test_wrong_shapes_say_what_came_and_what_is_wanted(call, message: str):
    with pytest.raises(ValueError, match=message):
        call()
