"""A scenes folder with small volumes, and a real HTTP server on loopback that can misbehave."""
import hashlib
import http.server
import json
import sys
import threading
from pathlib import Path

import pytest

SCENES = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(SCENES))
import fetch  # noqa: E402
from fetching import download  # noqa: E402

DIMS = (40, 30, 50)
BODY = bytes((7 * i + i // 251) % 256 for i in range(40 * 30 * 50))
PATH = "/volumes/tree_40x30x50_uint8.raw"


class Site:
    """Files of a server; `script` holds what to do with the next requests instead of answering them well."""

    def __init__(self):
        self.files = {PATH: BODY}
        self.headers = {"ETag": '"one"', "Last-Modified": "Mon, 01 Jan 2024 00:00:00 GMT"}
        self.script = []
        self.requests = []  # (path, Range header or None)


class Handler(http.server.BaseHTTPRequestHandler):
    def do_GET(self):
        site = self.server.site
        site.requests.append((self.path, self.headers.get("Range")))
        behave = site.script.pop(0) if site.script else answer
        try:
            behave(self)
        except (BrokenPipeError, ConnectionResetError):
            pass  # the client has hung up

    def log_message(self, *arguments):
        pass

    def head(self, status, **headers):
        self.send_response(status)
        for name, value in {**self.server.site.headers, **headers}.items():
            self.send_header(name.replace("_", "-"), str(value))
        self.end_headers()

    @property
    def body(self):
        return self.server.site.files.get(self.path)


def answer(handler, limit=None):
    """As a good server does; sends at most `limit` bytes of the body."""
    body, asked = handler.body, handler.headers.get("Range")
    if body is None:
        return status(404)(handler)
    start = int(asked.removeprefix("bytes=").removesuffix("-")) if asked else 0
    if asked and start >= len(body):
        return status(416)(handler)
    piece = body[start:]
    more = {"Content_Range": f"bytes {start}-{len(body) - 1}/{len(body)}"} if asked else {}
    handler.head(206 if asked else 200, Content_Length=len(piece), **more)
    handler.wfile.write(piece[:limit])


def cut_after(count):
    """Announces all, sends a part and hangs up."""
    return lambda handler: answer(handler, count)


def status(code, **headers):
    return lambda handler: handler.head(code, Content_Length=0, **headers)


def ignore_range(handler):
    handler.head(200, Content_Length=len(handler.body))
    handler.wfile.write(handler.body)


def without_length(handler):
    handler.head(200)
    handler.wfile.write(handler.body)


@pytest.fixture
def site(monkeypatch):
    for name in ("http_proxy", "https_proxy", "all_proxy", "no_proxy"):
        monkeypatch.delenv(name, raising=False)
        monkeypatch.delenv(name.upper(), raising=False)
    monkeypatch.setattr(download, "PAUSES_SECONDS", (0, 0))
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    server.site = Site()
    server.site.server = server
    server.site.address = f"http://127.0.0.1:{server.server_port}"
    thread = threading.Thread(target=server.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
    thread.start()
    yield server.site
    server.shutdown()
    server.server_close()
    thread.join()


@pytest.fixture
def add_scene(tmp_path, monkeypatch):
    """Writes scene files into a folder that fetch.py takes for its own."""
    folder = tmp_path / "scenes"
    folder.mkdir()
    monkeypatch.setattr(fetch, "SCENES", folder)
    monkeypatch.delenv("VOLMARK_DATA", raising=False)

    def add(name, volume=None, **source):
        document = {"title": f"A {name}", "volume": volume or {"file": f"{name}.nrrd"}, "source": source}
        (folder / f"{name}.json").write_text(json.dumps(document))

    return add


@pytest.fixture
def tree(site, add_scene):
    """The scene whose volume is on the server."""
    add_scene("tree", url=site.address + PATH, sha512=hashlib.sha512(BODY).hexdigest(),
              raw={"dims": DIMS, "type": "uint8", "spacing_mm": [0.5, 1, 2]})
    return site


@pytest.fixture
def data(tmp_path):
    """Where the volumes are to be."""
    return tmp_path / "data"


@pytest.fixture
def run(capsys, data):
    """fetch.py with its volumes in `data`. Returns exit code, standard output and standard error."""

    def call(*arguments):
        code = fetch.main([*map(str, arguments), "--to", str(data)])
        output = capsys.readouterr()
        return code, output.out, output.err

    return call
