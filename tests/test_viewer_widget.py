"""`om.view` without a notebook: what users set and get, and what notebooks are given to show."""

import io
import json
import sys
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_array_equal

import octomarch as om
from octomarch.viewer import widget

ipywidgets = pytest.importorskip("ipywidgets")
pytest.importorskip("anywidget")

BALL, CAMERA = om.sphere(1.0), om.Camera((0, 0, 4), (0, 0, 0))
WIDGET = "application/vnd.jupyter.widget-view+json"


@pytest.fixture
def viewer() -> om.Viewer:
    return om.view(BALL, CAMERA, (64, 48), samples=4)


def test_a_viewer_says_what_it_shows(viewer: om.Viewer):
    assert repr(viewer) == "<Viewer 64×48: color>"
    assert (viewer.scene, viewer.camera, viewer.size) == (BALL, CAMERA, (64, 48))
    assert (viewer.march, viewer.shading, viewer.plane) == (om.March(), om.Shading(), "color")
    assert viewer.picked is None


def test_without_a_camera_the_scene_is_framed(viewer: om.Viewer):
    viewer.camera = None
    assert viewer.camera == om.view(BALL).camera != CAMERA


def test_all_but_the_picture_can_be_set(viewer: om.Viewer):
    viewer.scene = scene = om.Scene(om.box(1.0))
    viewer.camera = camera = om.OrthographicCamera((0, 0, 4), (0, 0, 0))
    viewer.size = (32, 24)
    viewer.march = march = om.March(max_steps=8)
    viewer.shading = shading = om.Shading(shadows="hard")
    viewer.plane = "status"
    assert (viewer.scene, viewer.camera, viewer.size) == (scene, camera, (32, 24))
    assert (viewer.march, viewer.shading, viewer.plane) == (march, shading, "status")
    viewer.march = viewer.shading = None
    assert (viewer.march, viewer.shading) == (om.March(), om.Shading())
    expected = om.render(scene, camera, (32, 24), samples=4, planes=("color", "status"))
    assert_array_equal(viewer.image.color, expected.color)
    assert_array_equal(viewer.image.status, expected.status)


def test_bad_arguments_are_refused(viewer: om.Viewer):
    with pytest.raises(TypeError, match=r"scene must be an om.Shape or om.Scene, got 'ball.json'"):
        viewer.scene = "ball.json"  # type: ignore[assignment]
    with pytest.raises(ValueError, match=r"plane must be one of .*got 'colour'; did you mean 'color'\?"):
        viewer.plane = "colour"  # type: ignore[assignment]
    with pytest.raises(ValueError, match=r"samples must lie in \[1, 64\], got 65"):
        om.view(BALL, samples=65)
    with pytest.raises(TypeError, match=r"camera must be an om.Camera, .*got 3"):
        om.view(BALL, 3)  # type: ignore[arg-type]


def test_notebooks_are_given_the_widget_and_a_picture(viewer: om.Viewer):
    data, _ = viewer._repr_mimebundle_()
    assert data[WIDGET]["model_id"] == viewer.widget.model_id
    assert data["text/plain"] == repr(viewer)
    picture = np.asarray(PIL.Image.open(io.BytesIO(data["image/png"])))
    assert_array_equal(picture, om.render(BALL, CAMERA, (64, 48)).to_srgb())


def test_the_picture_is_of_what_is_seen_now(viewer: om.Viewer):
    viewer.plane = "depth"
    image = om.render(BALL, CAMERA, (64, 48), planes=("depth",))
    assert viewer._repr_mimebundle_()[0]["image/png"] == image._repr_png_()
    assert viewer.widget.picture == image._repr_png_()  # for pages without a kernel, and until it answers
    viewer.plane, viewer.scene = "error", om.box(1.0)
    picture = np.asarray(PIL.Image.open(io.BytesIO(viewer._repr_mimebundle_()[0]["image/png"])))
    assert_array_equal(picture, om.render(om.box(1.0), CAMERA, (64, 48)).to_srgb())


def test_the_widget_goes_into_boxes(viewer: om.Viewer):
    assert viewer.widget in ipywidgets.HBox([viewer.widget]).children


def test_messages_reach_the_engine_and_are_answered(viewer: om.Viewer, monkeypatch: pytest.MonkeyPatch):
    sent = []
    monkeypatch.setattr(viewer.widget, "send", lambda message, buffers: sent.append((message, buffers)))
    viewer.widget._handle_custom_msg({"kind": "input", "client": "a", "number": 1, "zoom": 0}, [])
    ((message, buffers),) = sent
    assert message["text"] == "ValueError: zoom must be > 0, got 0"
    assert buffers is None
    json.dumps(message)


def test_a_closed_viewer_still_answers_python(viewer: om.Viewer):
    viewer.close()
    viewer.close()
    viewer.plane = "depth"
    assert viewer.image.size == (64, 48)


def test_without_anywidget_one_is_told_what_to_install(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    widget._widget_class.cache_clear()
    try:
        with pytest.raises(ImportError, match=r"pip install 'octomarch\[notebook\]'"):
            om.view(BALL)
    finally:
        widget._widget_class.cache_clear()


def test_the_front_end_is_part_of_the_package():
    for name in ("viewer.js", "viewer.css"):
        assert (Path(widget.__file__).parent / name).stat().st_size > 1000
