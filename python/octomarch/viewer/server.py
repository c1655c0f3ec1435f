"""`Server`: an engine on a page of the browser, without a notebook. ``octomarch view`` starts one.

The page (`page.html`) runs the same ``viewer.js``. What it says comes as requests, what it is told goes as one long
answer: each message is the lengths of two parts, four bytes each, then JSON, then the bytes that belong to it.
"""

from __future__ import annotations

import json
import queue
import secrets
import struct
import threading
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, Self

from octomarch.viewer.engine import Engine
from octomarch.viewer.messages import Message
from octomarch.viewer.pictures import View

_HERE = Path(__file__).parent
_FILES = {
    "": ("page.html", "text/html"),
    "viewer.js": ("viewer.js", "text/javascript"),
    "viewer.css": ("viewer.css", "text/css"),
}
_LONGEST = 2**16  # bytes of a message from the page
_SILENCE = 10.0  # seconds after which a page is asked whether it is still there


class Server:
    """Serves one view to browsers of this machine, and to nobody who does not know its address.

    Parameters
    ----------
    view : View
        What to show first.
    samples : int
        Rays per pixel of the finest picture.
    port : int
        Of this machine; 0 for any that is free.

    Raises
    ------
    OSError
        If the port is taken.

    Examples
    --------
    >>> import octomarch as om, urllib.request
    >>> from octomarch.viewer.pictures import view_of
    >>> with Server(view_of(om.sphere(1.0)), samples=4) as server:
    ...     page = urllib.request.urlopen(server.address).read()
    >>> b"viewer.js" in page
    True
    """

    def __init__(self, view: View, samples: int, port: int = 0) -> None:
        self.engine = Engine(view, samples, self._tell)
        self._listeners: set[queue.SimpleQueue[bytes]] = set()
        self._secret = secrets.token_urlsafe(16)
        self._http = _Http(("127.0.0.1", port), _Request)
        self._http.server = self
        self._thread = threading.Thread(target=self._http.serve_forever, name="octomarch-server", daemon=True)

    @property
    def address(self) -> str:
        """Of the page; nobody guesses it."""
        return f"http://127.0.0.1:{self._http.server_port}/{self._secret}/"

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.engine.close()
        for listener in list(self._listeners):
            listener.put(b"")
        self._http.shutdown()
        self._thread.join()
        self._http.server_close()

    def place(self, path: str) -> str | None:
        """Return what is asked for below the secret, None if the secret is wrong."""
        _, secret, *rest = [*path.split("/", 2), ""]
        return rest[0] if secrets.compare_digest(secret.encode(), self._secret.encode()) else None

    def listen(self) -> queue.SimpleQueue[bytes]:
        """Return where all that is told from now on will be."""
        listener: queue.SimpleQueue[bytes] = queue.SimpleQueue()
        self._listeners.add(listener)
        return listener

    def leave(self, listener: queue.SimpleQueue[bytes]) -> None:
        """Forget somebody who listened."""
        self._listeners.discard(listener)

    def _tell(self, message: Message, data: bytes | None) -> None:
        text, rest = json.dumps(message).encode(), data or b""
        for listener in list(self._listeners):
            listener.put(struct.pack(">II", len(text), len(rest)) + text + rest)


class _Http(ThreadingHTTPServer):
    """The HTTP server, as requests know it."""

    daemon_threads = True
    block_on_close = False
    server: Server


class _Request(BaseHTTPRequestHandler):
    """One request of a page."""

    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # which would hold pictures back
    server: _Http

    def do_GET(self) -> None:
        """Give a file of the page, or tell it all that happens."""
        place = self.server.server.place(self.path)
        if place == "hear":
            self._tell_all()
        elif place in _FILES:
            name, kind = _FILES[place]
            self._answer(HTTPStatus.OK, (_HERE / name).read_bytes(), kind)
        else:
            self._answer(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        """Take a message."""
        length = self.headers.get("Content-Length", "")
        if self.server.server.place(self.path) != "say":
            self._end(HTTPStatus.NOT_FOUND)
        elif not length.isdecimal() or int(length) > _LONGEST:
            self._end(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
        else:
            try:
                message = json.loads(self.rfile.read(int(length)))
            except ValueError:
                message = None
            if not isinstance(message, dict):
                self._answer(HTTPStatus.BAD_REQUEST)
                return
            self.server.server.engine.receive(message)
            self._answer(HTTPStatus.NO_CONTENT)

    def log_message(self, *_: Any) -> None:
        """Keep silent about requests."""

    def _answer(self, status: HTTPStatus, body: bytes = b"", kind: str = "text/plain") -> None:
        self.send_response(status)
        if status != HTTPStatus.NO_CONTENT:
            self.send_header("Content-Type", f"{kind}; charset=utf-8")
            self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(body)

    def _end(self, status: HTTPStatus) -> None:
        """Refuse what has not been read, so that nothing can follow it."""
        self.close_connection = True
        self._answer(status)

    def _tell_all(self) -> None:
        server = self.server.server
        self.close_connection = True
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", "application/octet-stream")
        self.send_header("Cache-Control", "no-store")
        listener = server.listen()  # before the page knows, so that it misses nothing
        try:
            self.end_headers()
            while True:
                try:
                    told = listener.get(timeout=_SILENCE)
                except queue.Empty:
                    told = struct.pack(">II", 0, 0)
                if not told:
                    return
                self.wfile.write(told)
        except OSError:  # nobody listens any more
            pass
        finally:
            server.leave(listener)
