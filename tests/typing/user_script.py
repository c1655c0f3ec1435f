"""A user's script that uses all of the interface; test_typing.py has mypy check it, strictly."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import octomarch as om


def tower(storeys: int) -> om.Shape:
    windows = om.box((0.6, 0.8, 0.6)).repeat((1, 1.5, None), counts=(4, storeys, None))
    return om.box((4, 1.5 * storeys, 4)) - windows - om.cylinder(1.2, axis="y")


def lights() -> list[om.DirectionalLight | om.PointLight]:
    return [om.DirectionalLight(direction=(-1, -2, -1)), om.PointLight((2, 5, 2), color=20, decay=2)]


shape = om.union(tower(8), om.plane(), smooth=0.1) & ~om.sphere(1.0, center=np.zeros(3))
shape = shape.translate(0, 1, 0).translate((0, 1, 0)).rotate(30, axis=(1, 1, 0)).scale(2)
x, y, z = om.coordinates()
gear = om.star(12, 1.0, 0.8).round(0.02).extrude(0.2) - om.circle(0.2).extrude(1)
vase = om.polygon([(0, 0), (0.5, 0), (0.3, 1)]).revolve().shell(0.05).twist(20, axis="y").displace(0.01 * om.sin(9 * y))
tiles = om.cone(0.3, 0.6, center=(0.5, 0.3, 0.5)).tile((1, None, 1), scale=2, offset=0.25)
blob = om.metaballs(om.ellipsoid((1, 2, 1)), om.octahedron(1.0).bend(10), om.link(1, 0.5, 0.1), k=0.1)
walls = om.gyroid(1.0, 0.05) & om.box(2, form="maximum").mirror("xz").elongate((1, 0, 0)).stretch((1, 2, 1))
foam = om.spheres(np.zeros((4, 3)), [0.1, 0.2, 0.3, 0.4], smooth=0.1) | om.capsules([(0, 0, 0)], [(1, 0, 0)], 0.1)
city = om.boxes([(0, 0, 0), (2, 0, 0)], (1, 2, 1)) | om.sphere(1.0).instances(np.eye(4)[None], smooth=0.1)
scan = om.grid(np.zeros((4, 5, 6)), ((0, 0, 0), (1, 1, 1)), interpolation="cubic") | om.from_mesh(Path("part.stl"), 32)
frame = om.polygon([(0, 0), (1, 0), (0, 1)], holes=[[(0.1, 0.1), (0.2, 0.1), (0.1, 0.2)], np.zeros((3, 2))])
assert_type(scan | om.text("octomarch", size=0.5, align="left").extrude(0.1) | frame.extrude(1), om.Shape)
assert_type(foam | city, om.Shape)
assert_type(om.union(gear, vase, tiles, blob, walls), om.Shape)
assert_type(om.hexagonal_prism(1, 2, axis=(1, 1, 0)).translate((0, 1, 0)), om.Shape)
assert_type(shape | om.torus(2, 0.5).union(om.capsule((0, 0, 0), (0, 1, 0), 0.2), smooth=0.1), om.Shape)

red = om.Material(color=(0.8, 0.1, 0.1), roughness=0.4)
x, y, z = om.coordinates()
assert_type(2 * x**2 + abs(y) % 1, om.Expression)
assert_type((x < 1) & ~(y >= z), om.Expression)
assert_type(om.where(x < 0, om.sqrt(y), 1), om.Expression)
assert_type(om.mix((1, 0, 0), 0.5 * om.checker(0, 1), om.noise(x, y, z)), om.Texture)
assert_type(om.field(om.length(x, y, z) - 1, bounds=((-1, -1, -1), (1, 1, 1))), om.Shape)
painted = om.Material(om.image_texture(np.ones((2, 2, 3)), "triplanar"), roughness=om.clamp(x, 0, 1))
values: NDArray[np.floating] = x.evaluate([[1, 2, 3]])

scene = om.Scene(shape.paint(red), sky=om.Sky(base=0.5), ambient=(0.1, 0.1, 0.2), lights=lights())
assert_type(scene.ambient, tuple[float, float, float])
spot = om.SpotLight((0, 4, 0), target=(1, 0, 0), color=(40, 30, 20), angle=50)
for sky in (om.ConstantSky(0), om.GradientSky([(0, 0.5), (90, (0, 0, 1))]), om.EnvironmentMap(np.ones((2, 4, 3)))):
    scene = om.Scene(shape, sky=sky, lights=[spot, *lights()])
scene = om.Scene(shape, sky=om.CustomSky((x, y, 0.5)))

distances: NDArray[np.floating] = shape.distance(np.zeros((4, 3)), precision="float32")
hits = shape.raycast([0, 0, 9], [[0, 0, -1]], march=om.March(max_steps=64), t_max=50, planes=("t", "status"))
blocked = bool((hits.status == om.Status.HIT).any())
nearest = float(hits.t.min())


def report(done: int, total: int) -> None:
    print(done, total)


camera = om.Camera(eye=(3, 2, 4), target=(0, 0, 0), fov=45)
names = ["color", "depth", "material_id"]
image = om.render(
    scene, camera, size=(64, 48), shading=om.Shading("tetrahedron", shadows="hard", bounces=2), planes=names
)
image = om.render(
    shape, om.OrthographicCamera((0, 0, 9), (0, 0, 0)), (64, 48), progress=report, threads=1, isa="scalar"
)
assert_type(image.material_id, NDArray[np.int32])
mean: float = float(image.color.mean())
image.save(Path("tower.png"))
assert_type(om.read_exr("tower.exr"), om.Image)

work = om.Progress(report)
cameras = om.turntable(scene, 24, camera=om.OrthographicCamera((0, 0, 9), (0, 0, 0)))
with ThreadPoolExecutor() as pool:
    paths = om.render_frames([scene, shape], cameras[:2], out="f{:03d}.exr", executor=pool, planes=names, progress=work)
assert_type(paths, list[Path])
om.write_movie("tower.mp4", [image, *paths, np.zeros((48, 64, 3))], fps=12)
work.cancel()

program = om.compile(scene)
assert_type(program.lipschitz, float)
assert_type(om.isas(), list[str])
lo, hi = shape.bounds()
height: float = float(hi[1] - lo[1])

study: om.Study = om.study(scene, camera, size=(64, 48), groups=("series", "finish"), rounds=0)
row: om.StudyRow = study.table[0]
settings: list[str] = [row.name for row in study.front[1:]]
march: om.March = om.March.for_error(scene, camera, p95=1e-3)
found: om.Measured | None = march.measured
