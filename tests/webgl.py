"""Fragment shaders run in a browser's WebGL 2: pictures of them, and values at points."""

from __future__ import annotations

import base64
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from chromium import Chromium

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

HEAD = "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
PICTURE = """uniform vec3 iResolution;
uniform float iTime;
uniform vec4 iMouse;
out vec4 pixel_color;

{shader}
void main() {{
  mainImage(pixel_color, gl_FragCoord.xy);
}}
"""
POINTS = """uniform sampler2D points;
uniform sampler2D normals;
out vec4 result;

{functions}
void main() {{
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec3 p = texelFetch(points, at, 0).xyz;
  vec3 n = texelFetch(normals, at, 0).xyz;
  result = {value};
}}
"""
WIDTH = 64
"""Points in a row of a texture."""

SCRIPT = """
({width, height, source, textures, isFloat}) => {
  const canvas = document.createElement("canvas");
  canvas.width = width;
  canvas.height = height;
  const gl = canvas.getContext("webgl2", {antialias: false, preserveDrawingBuffer: true});
  const compiled = (type, text) => {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  const program = gl.createProgram();
  gl.attachShader(program, compiled(gl.VERTEX_SHADER, `#version 300 es
    void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }`));
  gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, source));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const texture = (data) => {
    const made = gl.createTexture();
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, height, 0, gl.RGBA, gl.FLOAT, data);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    return made;
  };
  if (isFloat) {
    if (!gl.getExtension("EXT_color_buffer_float")) throw new Error("no float framebuffers");
    const target = texture(null);
    gl.bindFramebuffer(gl.FRAMEBUFFER, gl.createFramebuffer());
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, target, 0);
  }
  Object.entries(textures).forEach(([name, data], unit) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    texture(new Float32Array(bytes(data).buffer));
    gl.uniform1i(gl.getUniformLocation(program, name), unit);
  });
  gl.uniform3f(gl.getUniformLocation(program, "iResolution"), width, height, 1);
  gl.viewport(0, 0, width, height);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  const pixels = isFloat ? new Float32Array(4 * width * height) : new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, isFloat ? gl.FLOAT : gl.UNSIGNED_BYTE, pixels);
  if (gl.getError()) throw new Error("WebGL error");
  gl.getExtension("WEBGL_lose_context").loseContext();
  const raw = new Uint8Array(pixels.buffer);
  let text = "";
  for (let i = 0; i < raw.length; i += 8192) text += String.fromCharCode(...raw.subarray(i, i + 8192));
  return btoa(text);
}
"""


class WebGl:
    """A page that runs shaders."""

    def __init__(self, chromium: Chromium) -> None:
        self._chromium = chromium
        self._page: Page = chromium.run(lambda browser: browser.new_page())

    def picture(self, shader: str, size: tuple[int, int]) -> NDArray[np.uint8]:
        """Return the bytes of a ShaderToy shader's picture, shape (height, width, 3), row 0 at the top."""
        request = {"width": size[0], "height": size[1], "textures": {}, "isFloat": False}
        raw = self._run({**request, "source": HEAD + PICTURE.format(shader=shader)})
        return np.frombuffer(raw, np.uint8).reshape(size[1], size[0], 4)[::-1, :, :3]

    def values(
        self, functions: str, value: str, points: NDArray[Any], normals: NDArray[Any] | None = None
    ) -> NDArray[np.float32]:
        """Return vec4 `value` at points p with normals n, shape (count, 4)."""
        count = len(points)
        height = -(-count // WIDTH)
        textures = {"points": points, "normals": np.zeros_like(points) if normals is None else normals}
        packed = {name: _packed(array, height) for name, array in textures.items()}
        source = HEAD + POINTS.format(functions=functions, value=value)
        request = {"width": WIDTH, "height": height, "textures": packed, "isFloat": True, "source": source}
        return np.frombuffer(self._run(request), np.float32).reshape(-1, 4)[:count]

    def _run(self, request: dict[str, Any]) -> bytes:
        def work(_: Browser) -> str:
            return self._page.evaluate(SCRIPT, request)

        return base64.b64decode(self._chromium.run(work))


def _packed(array: NDArray[Any], height: int) -> str:
    texels = np.zeros((WIDTH * height, 4), np.float32)
    texels[: len(array), :3] = array
    return base64.b64encode(texels.tobytes()).decode()
