"""`octomarch view`: the viewer on a page of its own, for nobody but who knows the address."""

import http.client
import json
import re
import signal
import struct
import subprocess
import sys
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import jupyter_lab
import octomarch as om
from octomarch.cli import main
from octomarch.viewer.pictures import view_of
from octomarch.viewer.server import Server

PATIENCE = 60.0
"""Seconds that an answer may take on a machine that does much else."""
RED = om.Scene(om.sphere(1.0).paint(om.Material((0.8, 0.1, 0.1))), ambient=1.0)
CAMERA = om.Camera((0, 0, 4), (0, 0, 0))


@pytest.fixture
def server() -> Iterator[Server]:
    with Server(view_of(RED, CAMERA, (96, 72)), samples=4) as running:
        yield running


class Page:
    """What a page does, over plain HTTP."""

    def __init__(self, address: str) -> None:
        self.where = urllib.parse.urlsplit(address)
        self.stream = self.connection()
        self.stream.request("GET", f"{self.where.path}hear")
        self.answer = self.stream.getresponse()

    def connection(self) -> http.client.HTTPConnection:
        return http.client.HTTPConnection(self.where.hostname or "", self.where.port, timeout=PATIENCE)

    def say(self, body: bytes, path: str = "say") -> int:
        connection = self.connection()
        connection.request("POST", self.where.path + path, body)
        status = connection.getresponse().status
        connection.close()
        return status

    def input(self, number: int, **what: Any) -> None:
        message = {"kind": "input", "client": "test", "number": number, **what}
        assert self.say(json.dumps(message).encode()) == 204

    def hear(self, kind: str) -> tuple[dict[str, Any], bytes]:
        """Return the next message of a kind."""
        while True:
            text, rest = struct.unpack(">II", self.answer.read(8))
            message, data = json.loads(self.answer.read(text)), self.answer.read(rest)
            if message["kind"] == kind:
                return message, data

    def close(self) -> None:
        self.answer.close()
        self.stream.close()


def test_a_page_is_told_what_happens(server: Server):
    page = Page(server.address)
    assert page.say(b'{"kind": "hello"}') == 204
    assert page.hear("state")[0]["size"] == [96, 72]
    message, data = page.hear("frame")
    assert data[:2] == b"\xff\xd8"
    while not message["is_last"]:
        message, data = page.hear("frame")
    assert (message["samples"], data[1:4]) == (4, b"PNG")
    page.input(1, orbit=[0.1, 0.0])
    message, _ = page.hear("frame")
    assert message["answers"] == {"test": 1}
    assert server.engine.view.camera != CAMERA
    page.close()


def test_two_pages_are_told_the_same(server: Server):
    first, second = Page(server.address), Page(server.address)
    first.say(b'{"kind": "hello"}')
    assert first.hear("frame") == second.hear("frame")
    first.close()
    first_left_a_thread_that_ends = Page(server.address)
    second.say(b'{"kind": "hello"}')
    assert first_left_a_thread_that_ends.hear("frame")[0] == second.hear("frame")[0]
    second.close()
    first_left_a_thread_that_ends.close()


@pytest.mark.parametrize("name", ["", "viewer.js", "viewer.css"])
def test_files_of_the_page_are_served(server: Server, name: str):
    with urllib.request.urlopen(server.address + name) as answer:
        assert answer.headers["Content-Type"].startswith("text/")
        assert "octomarch" in answer.read().decode()


@pytest.mark.parametrize("path", ["/", "/viewer.js", "/wrong/viewer.js", "/ö/", "/../../etc/passwd"])
def test_without_the_secret_there_is_nothing(server: Server, path: str):
    port = urllib.parse.urlsplit(server.address).port
    with pytest.raises(urllib.error.HTTPError, match="404") as refused:
        urllib.request.urlopen(f"http://127.0.0.1:{port}{urllib.parse.quote(path)}")
    refused.value.close()


def test_with_it_there_is_nothing_but_the_page(server: Server):
    for name in ("server.py", "../looks.py", "%2e%2e/looks.py"):
        with pytest.raises(urllib.error.HTTPError, match="404") as refused:
            urllib.request.urlopen(server.address + name)
        refused.value.close()


def test_bad_messages_are_refused(server: Server):
    page = Page(server.address)
    assert page.say(b"not JSON") == 400
    assert page.say(b"[1, 2]") == 400
    assert page.say(b"{}", "hear") == 404
    assert page.say(b"x" * 70000) == 413
    page.input(1, zoom=-1)
    assert page.hear("error")[0]["text"] == "ValueError: zoom must be > 0, got -1"
    page.close()


def test_what_is_told_elsewhere_reaches_the_page(server: Server):
    page = Page(server.address)
    server.engine.fail(ValueError("the file is wrong"))
    assert page.hear("error")[0] == {"kind": "error", "text": "ValueError: the file is wrong", "answers": {}}
    page.close()


def test_a_port_that_is_taken_is_told():
    with Server(view_of(RED, CAMERA), 1) as first:
        port = urllib.parse.urlsplit(first.address).port
        with pytest.raises(OSError, match="in use"):
            Server(view_of(RED, CAMERA), 1, port)


@pytest.mark.skipif(jupyter_lab.BROWSER is None, reason="needs Debian's chromium")
def test_a_browser_shows_it(server: Server):
    pytest.importorskip("playwright")
    complaints: list[str] = []
    last = "document.querySelector('canvas')?.dataset.last === 'true'"
    colour = """() => {
        const canvas = document.querySelector("canvas");
        const at = (x, y) => [...canvas.getContext("2d").getImageData(x, y, 1, 1).data];
        return [at(48, 36), at(2, 2)];
    }"""
    with jupyter_lab.browser_page(complaints) as page:
        page.goto(server.address)
        page.wait_for_function(last)
        middle, corner = page.evaluate(colour)
        assert middle[0] > 2 * middle[1]
        assert not corner[0] > 2 * corner[1]
        page.locator("canvas").dblclick()
        page.locator(".picked").wait_for()
        page.locator("canvas").hover()
        page.mouse.wheel(0, 300)
        page.wait_for_function("!document.querySelector('.picked').checkVisibility()")
        server.__exit__()
        page.get_by_text("octomarch has ended").wait_for()
    assert complaints == []


def test_the_command_follows_its_file_until_interrupted(tmp_path: Path):
    script = tmp_path / "scene.py"
    script.write_text("import octomarch as om\nscene = om.sphere(1.0)\n")
    command = [sys.executable, "-m", "octomarch", "view", str(script), "--no-browser", "--size", "64x48"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        address = re.match(r"(http://127\.0\.0\.1:\d+/\S+/) \(Ctrl-C ends\)", running.stdout.readline())
        assert address is not None
        page = Page(address[1])
        page.say(b'{"kind": "hello"}')
        page.hear("frame")
        script.write_text("import octomarch as om\nscene = om.box(")
        assert "SyntaxError" in page.hear("error")[0]["text"]
        time.sleep(0.01)
        script.write_text("import octomarch as om\nscene = om.box(1.0)\n")
        assert "SyntaxError" in running.stdout.readline()
        assert running.stdout.readline() == "shown anew\n"
        page.hear("frame")
        page.close()
        running.send_signal(signal.SIGINT)
        output, errors = running.communicate(timeout=PATIENCE)
    assert (running.returncode, output, errors) == (0, "\n", "")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--samples", "65"], "--samples must lie in [1, 64], got 65"),
        (["--port", "65536"], "--port must lie in [0, 65535], got 65536"),
        (["--set", "march.max_step=3"], "did you mean"),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else "",
)
def test_bad_options_are_told(arguments: list[str], told: str, capsys: pytest.CaptureFixture[str]):
    assert main(["view", "blend", "--no-browser", *arguments]) == 1
    assert told in capsys.readouterr().err
