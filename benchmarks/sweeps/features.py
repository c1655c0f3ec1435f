"""What each feature of a picture of scene A adds, one by one, and that it costs nothing where it is switched off."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

import octomarch as om
from scenes import MAX_DISTANCE, blend
from sweeps.plan import Case, Plan, Row, say, timed
from sweeps.views import evaluations

GREY = om.Material(color=0.8, specular=0.0)
MIRROR = replace(GREY, reflectivity=0.3)
GREY_SKY = om.ConstantSky(0.5)
UNSHADED = om.Shading(shadows="none", occlusion=0)
SUN = om.DirectionalLight((-1, -2, -1))
LAMP = om.PointLight((2, 3, 2), color=20.0)
PHOTO = np.random.default_rng(1).random((64, 128, 3), dtype=np.float32)
CHECKS = om.checker(0.2, 0.8, 0.5)


@dataclass(frozen=True)
class Setting:
    """A picture of scene A; as it comes here, of depth alone."""

    material: om.Material = GREY
    sky: Any = GREY_SKY
    lights: tuple[Any, ...] = ()
    shading: om.Shading = UNSHADED
    planes: tuple[str, ...] = ("depth",)
    samples: int = 1

    def shaded(self, **changes: Any) -> "Setting":
        return replace(self, shading=replace(self.shading, **changes))

    def painted(self, **changes: Any) -> "Setting":
        return replace(self, material=replace(self.material, **changes))

    def render(self, size: tuple[int, int]) -> om.Image:
        seen = blend()
        return om.render(
            om.Scene(seen.shape.paint(self.material), self.sky, 0.2, self.lights),
            seen.camera,
            size,
            march=om.March(max_distance=MAX_DISTANCE),
            shading=self.shading,
            planes=self.planes,
            samples=self.samples,
            threads=1,
        )


@dataclass(frozen=True)
class Feature:
    """A picture with something added to the one of the title `over`.

    `off` are pictures that have it all but switched on, each with one that never had it: their counts must be the same.
    """

    title: str
    over: str | None
    setting: Setting
    off: Sequence[tuple[Setting, Setting]] = ()


DEPTH = Setting()
AMBIENT = replace(DEPTH, planes=("color",))
LIT = replace(AMBIENT, lights=(SUN,))
EVERYTHING = Setting(
    replace(MIRROR, color=CHECKS, specular=0.3),
    om.EnvironmentMap(PHOTO),
    (SUN, LAMP),
    om.Shading(normals="central", bounces=2),
)


def _colored(title: str, **changes: Any) -> Feature:
    """Return a feature of colour alone, which is off where colours are not asked for."""
    setting = replace(AMBIENT, **changes)
    return Feature(title, "ambient light", setting, [(replace(setting, planes=("depth",)), DEPTH)])


def _texture(title: str, color: om.Texture) -> Feature:
    return _colored(title, material=replace(GREY, color=color))


def _lit(title: str, setting: Setting, *off: Setting) -> Feature:
    return Feature(title, "a directional light", setting, [(one, LIT) for one in off])


def _plane(name: str) -> Feature:
    return Feature(f"plane {name}", "depth", replace(DEPTH, planes=("depth", name)))


FEATURES = (
    Feature("depth", None, DEPTH),
    *map(_plane, ("position", "normal", "object_id", "steps")),
    Feature("ambient light", "depth", AMBIENT, [(EVERYTHING, DEPTH)]),
    _texture("checkers", CHECKS),
    _texture("noise", om.noise_texture(0.2, 0.8, size=0.5)),
    _texture("an image, planar", om.image_texture(PHOTO, size=2.0)),
    _texture("an image, triplanar", om.image_texture(PHOTO, "triplanar", size=2.0)),
    _colored("a sky of two colours", sky=om.Sky()),
    _colored("an environment map", sky=om.EnvironmentMap(PHOTO)),
    Feature(
        "ambient occlusion, 5 samples",
        "ambient light",
        AMBIENT.shaded(occlusion=5, occlusion_distance=0.5),
        [(AMBIENT.shaded(occlusion_distance=0.5), AMBIENT)],
    ),
    Feature("a point light", "ambient light", replace(AMBIENT, lights=(LAMP,))),
    Feature(
        "a directional light", "ambient light", LIT, [(AMBIENT.shaded(normals="central", shadows="soft"), AMBIENT)]
    ),
    _lit("central normals", LIT.shaded(normals="central"), LIT.shaded(normal_step=0.01)),
    _lit("tetrahedron normals", LIT.shaded(normals="tetrahedron"), LIT.shaded(normal_step=0.01)),
    _lit("highlights", LIT.painted(specular=0.3), LIT.painted(roughness=0.2)),
    _lit("hard shadows", LIT.shaded(shadows="hard"), LIT.shaded(shadow_k=8.0)),
    _lit("soft shadows", LIT.shaded(shadows="soft"), LIT.shaded(shadow_k=8.0)),
    _lit(
        "mirrors, one bounce",
        replace(LIT, material=MIRROR).shaded(bounces=1),
        replace(LIT, material=MIRROR),
        LIT.shaded(bounces=3),
    ),
    _lit("4 samples a pixel", replace(LIT, samples=4)),
)


def measure(plan: Plan) -> list[Row]:
    """Return a row for each feature: evaluations per ray, and counts and pixels that differ where it is off."""
    cases = [
        Case(
            feature.title,
            partial(feature.setting.render, plan.size),
            {"feature": feature.title, "over": feature.over, **_switched_off(feature, plan)},
        )
        for feature in FEATURES
    ]
    return timed(cases, plan, "features", lambda image: {"evaluations": evaluations(image)})


def _switched_off(feature: Feature, plan: Plan) -> Row:
    """Return over how many pairs of pictures, and how many counts and pixels differ between them."""
    say(f"features: {feature.title}, switched off")
    pairs = [(off.render(plan.size), never.render(plan.size)) for off, never in feature.off]
    return {
        "off_pairs": len(pairs),
        "different_counts": sum(different_counts(off.stats, never.stats) for off, never in pairs),
        "different_pixels": sum(different_pixels(off, never) for off, never in pairs),
    }


def different_counts(stats: dict[str, Any], others: dict[str, Any]) -> int:
    """Return in how many stages of two pictures the counts of work differ; seconds are none."""

    def counts(stage: dict[str, Any]) -> dict[str, int]:
        return {name: value for name, value in stage.items() if isinstance(value, int)}

    return sum(counts(stage) != counts(others["stages"][name]) for name, stage in stats["stages"].items())


def different_pixels(image: om.Image, other: om.Image) -> int:
    name = image.planes[0]
    differing = getattr(image, name) != getattr(other, name)
    return int(differing.any(axis=-1).sum() if differing.ndim == 3 else differing.sum())
