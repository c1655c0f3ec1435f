"""The viewer without a browser: what a front end says, and what it is answered with."""

import io
import threading
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import PIL.Image
import pytest
from numpy.testing import assert_array_equal

import octomarch as om
from octomarch.looks import look
from octomarch.viewer import painting, pictures
from octomarch.viewer.engine import Engine
from octomarch.viewer.messages import Message
from octomarch.viewer.pace import Quality
from octomarch.viewer.pictures import View, take, view_of

PATIENCE = 60.0
"""Seconds that an answer may take on a machine that does much else."""
SIZE = (96, 72)
SAMPLES = 8
CAMERA = om.Camera((3, 2, 4), (0, 0, 0))
BLEND = om.sphere(1.0).union(om.box(1.5).translate(0.9, 0.3, 0.0), smooth=0.25) | om.plane((0, 1, 0), (0, -1, 0))
SCENE = om.Scene(BLEND, lights=[om.DirectionalLight((-1, -2, -1))])


class Front:
    """A front end that keeps what it is told."""

    def __init__(self, view: View, samples: int = SAMPLES) -> None:
        self.told: list[tuple[Message, bytes | None]] = []
        self.news = threading.Condition()
        self.number = 0
        self.engine = Engine(view, samples, self.take)

    def take(self, message: Message, data: bytes | None) -> None:
        with self.news:
            self.told.append((message, data))
            self.news.notify_all()

    def hello(self) -> None:
        self.engine.receive({"kind": "hello"})

    def input(self, **what: Any) -> int:
        self.number += 1
        self.engine.receive({"kind": "input", "client": "test", "number": self.number, **what})
        return self.number

    def wait(self, wanted: Callable[[Message], bool]) -> tuple[Message, bytes | None]:
        """Return the first message that is wanted, and forget all up to it."""
        with self.news:
            assert self.news.wait_for(lambda: any(wanted(message) for message, _ in self.told), PATIENCE), self.told
            place = next(i for i, (message, _) in enumerate(self.told) if wanted(message))
            found = self.told[place]
            del self.told[: place + 1]
            return found

    def frame(self, number: int = 0, *, last: bool = False) -> tuple[Message, bytes]:
        """Return the next picture that answers that input: the first, or the last one."""

        def wanted(message: Message) -> bool:
            is_answer = message["kind"] == "frame" and message["answers"].get("test", 0) >= number
            return is_answer and message["is_last"] >= last

        message, data = self.wait(wanted)
        assert data is not None
        return message, data


@pytest.fixture
def make() -> Iterator[Callable[..., Front]]:
    made: list[Front] = []

    def front(scene: Any = SCENE, samples: int = SAMPLES, **arguments: Any) -> Front:
        made.append(Front(view_of(scene, **{"camera": CAMERA, "size": SIZE, **arguments}), samples))
        return made[-1]

    yield front
    for each in made:
        each.engine.close()


def decoded(data: bytes) -> np.ndarray:
    return np.asarray(PIL.Image.open(io.BytesIO(data)))


def test_hello_is_answered_with_the_state_and_pictures(make: Callable[..., Front]):
    front = make()
    front.hello()
    state, _ = front.wait(lambda message: message["kind"] == "state")
    assert (state["size"], state["plane"], len(state["planes"])) == (SIZE, "color", 6)
    first, data = front.frame()
    assert (first["type"], first["is_lit"], first["size"]) == ("image/jpeg", False, (48, 36))
    assert decoded(data).shape == (36, 48, 3)
    samples = [front.frame()[0]["samples"] for _ in range(3)]
    assert samples == [1, 4, SAMPLES]


def test_the_last_picture_has_the_bits_of_render(make: Callable[..., Front]):
    shading = om.Shading(shadow_k=8, occlusion=3)
    front = make(shading=shading, march=om.March(pixel_tolerance=0.5))
    front.hello()
    message, data = front.frame(last=True)
    expected = om.render(
        SCENE, CAMERA, SIZE, march=om.March(pixel_tolerance=0.5), shading=shading, samples=SAMPLES, planes=("color",)
    )
    assert message["type"] == "image/png"
    assert_array_equal(decoded(data), expected.to_srgb())
    assert_array_equal(front.engine.image().color, expected.color)


def test_what_python_asks_for_is_rendered_if_nobody_looks():
    front = Front(view_of(BLEND, CAMERA, SIZE))
    image = front.engine.image()
    assert image is front.engine.image()
    assert_array_equal(image.color, om.render(BLEND, CAMERA, SIZE, samples=SAMPLES).color)
    assert front.told == []
    front.engine.change(plane="depth")
    assert image is front.engine.image()
    front.engine.change(march=om.March(max_steps=3))
    assert image is not front.engine.image()


def test_a_drag_moves_the_camera_and_the_picture(make: Callable[..., Front]):
    front = make()
    front.hello()
    _, before = front.frame(last=True)
    message, after = front.frame(front.input(orbit=[0.1, 0.05]), last=True)
    assert message["answers"] == {"test": 1}
    assert front.engine.view.camera.eye != CAMERA.eye
    assert np.abs(decoded(before).astype(int) - decoded(after)).mean() > 1
    front.input(home=True)
    assert front.engine.view.camera == CAMERA


def test_all_that_the_hand_does_is_added_up():
    front = Front(view_of(BLEND, CAMERA, SIZE))
    front.input(orbit=[0.1, 0.0], pan=[0.0, 0.2], zoom=2.0)
    front.engine.close()
    moved = front.engine.view.camera
    assert isinstance(moved, om.Camera)
    distance = np.linalg.norm(np.subtract(moved.eye, moved.target))
    assert distance == pytest.approx(2 * np.linalg.norm(CAMERA.eye))
    assert moved.target != CAMERA.target


def test_sliders_change_what_a_picture_costs(make: Callable[..., Front]):
    front = make(march=om.March("plain"))
    front.hello()
    before, _ = front.frame(last=True)
    after, _ = front.frame(front.input(march={"max_steps": 5, "pixel_tolerance": 2.0}), last=True)
    assert front.engine.view.march == om.March("plain", max_steps=5, pixel_tolerance=2.0)
    assert after["evaluations"] < before["evaluations"] / 2
    assert after["statuses"]["STEP_LIMIT"] > before["statuses"].get("STEP_LIMIT", 0)
    front.told.clear()
    front.input(march=None)
    state, _ = front.wait(lambda message: message["kind"] == "state")
    assert all(slider["is_default"] for slider in state["sliders"].values())
    assert front.engine.view.march == om.March("plain")


def test_errors_are_known_while_settings_change(make: Callable[..., Front]):
    front = make(BLEND, plane="depth", march=om.March(finish=None))
    front.hello()
    told, _ = front.wait(lambda message: message["kind"] == "errors" and message["errors"] is not None)
    assert told["errors"]["false_misses"] == 0
    message, _ = front.frame(front.input(march={"pixel_tolerance": 8.0}), last=True)
    assert message["errors"]["p95"] > 10 * told["errors"]["p95"]


def test_a_pick_is_what_the_picture_has_there(make: Callable[..., Front]):
    front = make()
    x, y = 53, 40
    front.input(pick=[(x + 0.5) / SIZE[0], (y + 0.5) / SIZE[1]])
    message, _ = front.wait(lambda message: message["kind"] == "picked")
    image = om.render(SCENE, CAMERA, SIZE, planes=("depth", "position", "normal", "object_id", "material_id", "steps"))
    assert message["pixel"] == (x, y)
    assert message["status"] == "HIT"
    assert message["t"] == float(image.depth[y, x])
    assert message["position"] == image.position[y, x].tolist()
    assert message["normal"] == image.normal[y, x].tolist()
    assert message["steps"] == image.steps[y, x]
    assert (message["object_id"], message["material_id"]) == (image.object_id[y, x], image.material_id[y, x])
    assert om.compile(SCENE).objects[message["object_id"]][0] == message["object"]
    assert front.engine.picked is not None
    assert front.engine.picked.t == message["t"]


def test_a_pick_of_nothing_says_so(make: Callable[..., Front]):
    front = make(om.sphere(1.0))
    front.input(pick=[0.0, 1.0])
    message, _ = front.wait(lambda message: message["kind"] == "picked")
    assert (message["pixel"], message["status"], message["t"]) == ((0, SIZE[1] - 1), "MISS", None)
    assert (message["object_id"], message["object"]) == (-1, "")


@pytest.mark.parametrize("plane", ["depth", "normal", "steps", "status"])
def test_planes_are_shown(make: Callable[..., Front], plane: Any):
    front = make(plane=plane)
    front.hello()
    message, data = front.frame(last=True)
    image = om.render(SCENE, CAMERA, SIZE, planes=(plane,))
    assert_array_equal(decoded(data), look(image, plane))
    assert (message["legend"] is None) == (plane == "normal")


def test_the_error_is_shown(make: Callable[..., Front]):
    front = make(BLEND, plane="error", march=om.March(max_steps=6))
    front.hello()
    message, data = front.frame(last=True)
    assert message["legend"]["labels"][-1] == "hit in only one"
    fine, coarse = (
        decoded(front.frame(front.input(march={"pixel_tolerance": tolerance, "max_steps": 256}), last=True)[1])
        for tolerance in (0.01, 10.0)
    )
    assert decoded(data).std() > 1
    assert coarse.astype(float).mean() > fine.astype(float).mean()  # errors grow from dark to light


def test_another_plane_of_a_refined_picture_is_not_rendered_again(
    make: Callable[..., Front], monkeypatch: pytest.MonkeyPatch
):
    front = make()
    front.hello()
    front.frame(last=True)
    monkeypatch.setattr(painting, "take", lambda *_, **__: pytest.fail("rendered"))
    for plane in ("depth", "normal", "color"):
        message, _ = front.frame(front.input(plane=plane))
        assert (message["plane"], message["samples"], message["is_last"]) == (plane, SAMPLES, True)


def test_who_brings_a_message_does_not_wait_and_the_latest_wins(
    make: Callable[..., Front], monkeypatch: pytest.MonkeyPatch
):
    taken: list[View] = []
    begun, go_on = threading.Event(), threading.Event()

    def slow(view: View, *arguments: Any, **options: Any) -> om.Image:
        taken.append(view)
        begun.set()
        assert go_on.wait(PATIENCE)
        return take(view, *arguments, **options)

    monkeypatch.setattr(painting, "take", slow)
    front = make()
    front.hello()
    assert begun.wait(PATIENCE)
    for _ in range(20):
        front.input(orbit=[0.01, 0.0])
    assert len(taken) == 1
    go_on.set()
    message, _ = front.frame(20)
    assert message["answers"]["test"] == 20
    assert taken[1] is front.engine.view  # none of the nineteen views in between was rendered


def test_new_input_ends_refinement(make: Callable[..., Front], monkeypatch: pytest.MonkeyPatch):
    refining, ended = threading.Event(), threading.Event()

    def watched(view: View, quality: Quality, *arguments: Any, **options: Any) -> om.Image:
        if quality.samples == 64:
            refining.set()
        try:
            return take(view, quality, *arguments, **options)
        except om.CancelledError:
            ended.set()
            raise

    monkeypatch.setattr(painting, "take", watched)
    front = make(samples=64, size=(1600, 1200))
    front.hello()
    assert refining.wait(PATIENCE)
    number = front.input(zoom=1.1)
    assert ended.wait(PATIENCE)
    front.frame(number)


def test_python_changes_what_is_shown(make: Callable[..., Front]):
    front = make()
    front.hello()
    front.frame(last=True)
    front.engine.change(scene=om.box(1.0), plane="status")
    state, _ = front.wait(lambda message: message["kind"] == "state")
    assert state["plane"] == "status"
    message, _ = front.frame()
    assert message["statuses"]["MISS"] > 0
    assert front.engine.view.camera == CAMERA
    front.engine.change(camera=None)
    assert front.engine.view.camera != CAMERA


def test_another_front_end_gets_pictures_too(make: Callable[..., Front]):
    front = make()
    front.hello()
    _, first = front.frame(last=True)
    front.hello()
    _, again = front.frame(last=True)
    assert again == first


@pytest.mark.parametrize(
    ("message", "told"),
    [
        ({"orbit": [0.1]}, "ValueError: orbit must be two numbers, got [0.1]"),
        ({"pan": "left"}, "TypeError: pan must be two numbers, got 'left'"),
        ({"zoom": float("nan")}, "ValueError: zoom must be finite, got nan"),
        ({"zoom": -1}, "ValueError: zoom must be > 0, got -1"),
        ({"pick": [0.1, None]}, "TypeError: pick[1] must be a number, got None"),
        (
            {"plane": "colour"},
            "ValueError: plane must be one of 'color', 'depth', 'normal', 'steps', 'status',",
        ),
        ({"march": {"max_steps": 0}}, "ValueError: max_steps must lie in [1, 2147483647], got 0"),
        ({"march": {"method": "plain"}}, "ValueError: march must be one of 'max_steps', 'epsilon', 'pixel_tolerance'"),
        ({"march": 3}, "TypeError: march must be settings by name, got 3"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_bad_input_is_answered_with_an_error_and_changes_nothing(message: Message, told: str):
    front = Front(view_of(BLEND, CAMERA, SIZE))
    before = front.engine.view
    number = front.input(**message)
    (answer, _), *others = front.told
    assert not others
    assert (answer["kind"], answer["answers"]) == ("error", {"test": number})
    assert answer["text"].startswith(told)
    assert front.engine.view is before


def test_input_without_client_or_number_is_refused():
    front = Front(view_of(BLEND, CAMERA, SIZE))
    front.engine.receive({"kind": "input", "client": "test", "orbit": [0, 1]})
    front.engine.receive({"kind": "input", "number": 1, "orbit": [0, 1]})
    assert [message["text"] for message, _ in front.told] == [
        "TypeError: number must be an integer, got None",
        "TypeError: client must be a text, got None",
    ]


def test_front_ends_are_answered_apart():
    front = Front(view_of(BLEND, CAMERA, SIZE))
    front.engine.receive({"kind": "input", "client": "another", "number": 70, "home": True})
    message, _ = front.frame()
    assert message["answers"] == {"another": 70}
    number = front.input(home=True)  # changes nothing
    message, _ = front.wait(lambda message: message["kind"] == "done")
    assert message["answers"] == {"another": 70, "test": number}
    front.engine.close()


def test_what_cannot_be_rendered_is_told_and_the_next_view_is_shown(make: Callable[..., Front]):
    x, _, _ = om.coordinates()
    front = make(om.sphere(1.0).displace(0.1 * om.exp(x), lipschitz=2) | om.sphere(0.5))
    front.engine.change(march=om.March("certified"))
    front.hello()
    message, _ = front.wait(lambda message: message["kind"] == "error")
    assert message["text"].startswith("ValueError")
    front.engine.change(march=om.March())
    front.frame(last=True)


@pytest.mark.parametrize(
    ("parts", "error", "told"),
    [
        ({"scene": 3}, TypeError, "scene must be an om.Shape or om.Scene, got 3"),
        ({"camera": "above"}, TypeError, "camera must be an om.Camera, .*got 'above'"),
        ({"size": (0, 4)}, ValueError, r"size\[0\] must lie in \[1, 2147483647\], got 0"),
        ({"march": "plain"}, TypeError, "march must be an om.March, got 'plain'"),
        ({"shading": 1}, TypeError, "shading must be an om.Shading, got 1"),
        ({"plane": "position"}, ValueError, "plane must be one of .*got 'position'"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_bad_changes_are_refused(parts: dict[str, Any], error: type[Exception], told: str):
    front = Front(view_of(BLEND, CAMERA, SIZE))
    before = front.engine.view
    with pytest.raises(error, match=told):
        front.engine.change(**parts)
    assert front.engine.view is before


def test_coarse_pictures_have_the_planes_that_are_shown_and_no_light():
    view = view_of(SCENE, CAMERA, SIZE)
    image = take(view, Quality(scale=2, is_lit=False))
    assert image.planes == ("color", *pictures.ALWAYS)
    assert (image.size, image.stats["stages"]["shadow"]["count"], image.stats["stages"]["occlusion"]["count"]) == (
        (48, 36),
        0,
        0,
    )
    assert take(view, Quality(), whole=True).stats["stages"]["shadow"]["count"] > 0
