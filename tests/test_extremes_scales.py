"""Random shapes at all scales, near the origin and far from it, seen from near and far: what every picture keeps to."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

import octomarch as om
from octomarch.planes import PLANES
from rounding import field_error, unit_roundoff
from strategies import Array, Sample, nested, vector

SIZE = 8
STEPS = 64

Camera = om.Camera | om.OrthographicCamera | om.PanoramicCamera


@dataclass(frozen=True)
class View:
    """A shape of size about `scale` at `offset`, and the camera that looks at it from `distance`."""

    sample: Sample
    scale: float
    offset: Array
    kind: str
    towards: Array
    distance: float

    @property
    def shape(self) -> om.Shape:
        return self.sample.shape.scale(self.scale).translate(*self.offset)

    @property
    def angle(self) -> float:
        """Of the view, in degrees: what is far is seen large."""
        return math.degrees(2 * math.atan2(2 * self.scale, max(self.distance, 5 * self.scale)))

    @property
    def eye(self) -> Array:
        return self.offset + self.distance * self.towards

    def camera(self) -> Camera:
        target = self.eye - self.scale * self.towards if self.distance == 0 else self.offset
        up = np.eye(3)[np.abs(self.towards).argmin()]
        if self.kind == "orthographic":
            return om.OrthographicCamera(self.eye, target, up, height=4 * self.scale)
        if self.kind == "panoramic":
            return om.PanoramicCamera(self.eye, target, up, fov=(self.angle, self.angle))
        return om.Camera(self.eye, target, up, fov=self.angle)

    def rays(self) -> tuple[Array, Array]:
        """Origins and directions (SIZE, SIZE, 3) as documented."""
        forward = -self.towards
        up = np.eye(3)[np.abs(self.towards).argmin()]
        right = np.cross(forward, up)
        right /= np.linalg.norm(right)
        above = np.cross(right, forward)
        s = ((2 * np.arange(SIZE) + 1) / SIZE - 1)[None, :, None]
        r = -s.reshape(SIZE, 1, 1)
        if self.kind == "orthographic":
            origins = self.eye + 2 * self.scale * (s * right + r * above)
            return origins, np.broadcast_to(forward, origins.shape)
        if self.kind == "panoramic":
            longitude, latitude = (np.radians(self.angle / 2) * part for part in (s, r))
            level = np.cos(longitude) * forward + np.sin(longitude) * right
            directions = np.cos(latitude) * level + np.sin(latitude) * above
        else:
            directions = forward + math.tan(math.radians(self.angle / 2)) * (s * right + r * above)
            directions = directions / np.linalg.norm(directions, axis=-1)[..., None]
        return np.broadcast_to(self.eye, directions.shape), directions

    def lead(self, program: om.Program) -> float:
        """How far rays are moved along in double, as documented."""
        lo, hi = np.array(program.bounds)
        away = np.maximum(np.maximum(lo - self.eye, self.eye - hi), 0)
        if self.kind == "orthographic":
            away = np.where(self.towards > 0, self.eye - hi, self.eye - lo) * self.towards
            away = [away.sum() if np.isfinite(away).all() else 0.0]
        length = float(np.linalg.norm(away))
        radius = program.size / 2
        return max(length - 2 * radius, 0.0) if program.focus and length > 16 * radius else 0.0

    def pixel_radius(self, t: Array) -> Array:
        if self.kind == "orthographic":
            return np.full_like(t, 2 * self.scale / SIZE)
        half = math.radians(self.angle / 2)
        return t * (half if self.kind == "panoramic" else math.tan(half)) / SIZE


@st.composite
def views(draw: st.DrawFn) -> View:
    sample = draw(nested())
    scale = draw(st.sampled_from([10.0**k for k in range(-6, 7)]) | st.floats(1e-6, 1e6))
    offset = scale * draw(st.sampled_from([0.0, 1.0, 1e3, 1e6])) * np.array(draw(vector))
    towards = np.array(draw(vector)) + np.array([0.1, 0.2, 0.3])
    if np.linalg.norm(towards) < 0.05:
        towards = np.array([1.0, 2.0, 3.0])
    towards /= np.linalg.norm(towards)
    distance = scale * draw(st.sampled_from([0.0, 0.5, 3.0, 10.0, 100.0, 1e4]))
    kind = draw(st.sampled_from(["perspective", "orthographic", "panoramic"]))
    return View(sample, scale, offset, kind, towards, distance)


@given(view=views())
def test_shapes_and_cameras_at_any_scale(isa: str, precision: str, view: View):
    """No plane holds a NaN, every status is right, and hits are as near to the surface as the documentation says."""
    reach = 2 * view.distance + 20 * view.scale
    march = om.March(epsilon=1e-5 * view.scale, max_distance=reach, max_steps=STEPS)
    options = {"march": march, "planes": tuple(PLANES), "precision": precision, "isa": isa}
    image = om.render(view.shape, view.camera(), (SIZE, SIZE), **options)
    for plane in PLANES:
        assert not np.isnan(getattr(image, plane)).any(), plane
    status, t = image.status, image.depth.astype(np.float64)
    assert_status_and_planes_agree(image)

    program = om.compile(view.shape)
    origins, directions = view.rays()
    end = np.minimum(t, reach)
    u = unit_roundoff(precision)
    lead = view.lead(program)
    # Kernels see what is left from there; doubles hold the rest.
    near = np.abs(origins + lead * directions - program.anchor).max(axis=-1) + end - np.minimum(lead, end)
    coarse = 16 * u * near + 64 * np.finfo(np.float64).eps * (np.abs(origins).max() + reach)

    inside, hit = status == om.Status.INSIDE, status == om.Status.HIT
    tolerance = np.maximum(np.maximum(march.epsilon, coarse), 0.1 * view.pixel_radius(end))

    def field(points: Array, which: Array, rounding: Array) -> tuple[Array, Array]:
        """Return the field at some of the points over its steepest slope, and what rounding may have added."""
        values = om.reference.distance(view.shape, points[which]) / program.lipschitz
        slack = view.scale * field_error(view.sample, (points[which] - view.offset) / view.scale, precision)
        return values, slack / program.lipschitz + view.sample.gain * rounding[which]

    for share in np.linspace(0, 0.999, 6):  # the finish may pass what is no deeper than epsilon
        values, slack = field(origins + (share * end)[..., None] * directions, ~inside, coarse + u * end)
        assert (values >= -slack - np.where(hit, tolerance, 0)[~inside]).all()
    position = image.position.astype(np.float64)
    values, slack = field(position, hit, coarse + u * np.abs(position).max(axis=-1))
    assert (np.abs(values) <= slack + tolerance[hit]).all()
    values, slack = field(origins, inside, coarse)
    assert (values <= slack + tolerance[inside]).all()
    assert (t[inside] == 0).all()


def assert_status_and_planes_agree(image: om.Image) -> None:
    status = image.status
    assert set(status.flat) <= {om.Status.HIT, om.Status.MISS, om.Status.STEP_LIMIT, om.Status.INSIDE}
    found = (status == om.Status.HIT) | (status == om.Status.STEP_LIMIT)
    assert_array_equal(np.isposinf(image.depth), status == om.Status.MISS)
    assert_allclose(np.linalg.norm(image.normal[found].astype(float), axis=-1), 1, rtol=1e-5)
    assert_array_equal(image.normal[~found], 0)
    assert_array_equal(image.object_id >= 0, found)
    assert_array_equal(image.material_id >= 0, found)
    assert_array_equal(image.steps[status == om.Status.STEP_LIMIT], STEPS)
    assert (image.steps <= STEPS).all()
    assert (image.color >= 0).all()
    assert np.isfinite(image.color).all()
    assert np.isfinite(image.position).all()


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
def test_pictures_are_the_same_at_every_scale(scale: float, isa: str, precision: str):
    """Settings follow the size of the scene: a picture in micrometres is that in megametres, but for rounding."""
    one, other = (
        om.render(
            (om.sphere(1.0).union(om.box(1.5, center=(0.9, 0.3, 0)), smooth=0.25)).scale(s),
            om.Camera(np.array([3, 2, 4]) * s, (0, 0, 0)),
            (24, 18),
            planes=("status", "depth", "normal"),
            precision=precision,
            isa=isa,
        )
        for s in (1.0, scale)
    )
    assert (one.status == other.status).mean() > 0.99
    both = (one.status == om.Status.HIT) & (other.status == om.Status.HIT)
    assert both.sum() > 80
    off = np.abs(other.depth[both] / scale - one.depth[both])
    assert np.quantile(off, 0.95) < 2e-5
    assert np.quantile(np.abs(other.normal[both] - one.normal[both]), 0.95) < 1e-4
