"""fetch.py against a real HTTP server on loopback that cuts, lies, fails and changes its files."""
import errno
import hashlib
import os
import shutil
import signal
import socket
import ssl
import subprocess
import sys
import time
from collections import namedtuple

import pytest
from conftest import BODY, PATH, SCENES, answer, cut_after, ignore_range, status, without_length

import fetch
from fetching import download
from fetching.part_file import PartFile
from fetching.progress import Progress

OTHER_BODY = bytes(len(BODY))


def names_in(folder):
    return sorted(path.name for path in folder.iterdir()) if folder.exists() else []


def is_whole(data):
    header, _, voxels = (data / "tree.nrrd").read_bytes().partition(b"\n\n")
    return voxels == BODY and names_in(data) == ["tree.nrrd"]


def ranges(site):
    return [asked for _, asked in site.requests]


def start_download(run, tree, count=1000):
    """Leaves a part of `count` bytes: the server hangs up at every attempt."""
    tree.script = [cut_after(count), *[cut_after(0)] * 2]
    code, _, errors = run("tree")
    assert code == 1 and "gave up after 3 attempts, the same command goes on" in errors
    tree.script, tree.requests = [], []


def error_line(errors):
    (line,) = [line for line in errors.splitlines() if line.startswith("fetch.py: ")]
    return line


def test_a_whole_file_becomes_an_nrrd(run, tree, data):
    code, output, _ = run("tree")
    assert code == 0 and "wrote" in output and str(data / "tree.nrrd") in output
    lines = (data / "tree.nrrd").read_bytes().partition(b"\n\n")[0].decode().splitlines()
    assert lines[0] == "NRRD0004"
    assert {"sizes: 40 30 50", "spacings: 0.5 1 2", "type: uint8", "endian: little", "encoding: raw"} <= set(lines)
    assert is_whole(data) and tree.requests == [(PATH, None)]
    assert run("tree")[0] == 0 and len(tree.requests) == 1, "what is here is not fetched again"


def test_a_cut_connection_goes_on_within_the_command(run, tree, data):
    tree.script = [cut_after(1000), cut_after(500)]
    code, _, errors = run("tree")
    assert code == 0 and is_whole(data)
    assert ranges(tree) == [None, "bytes=1000-", "bytes=1500-"]
    assert f"the connection ended after 1000 of {len(BODY)} bytes; trying again" in errors


def test_a_stopped_download_goes_on_with_the_next_command(run, tree, data):
    start_download(run, tree)
    assert names_in(data) == ["tree.nrrd.part", "tree.nrrd.part.from"]
    assert run("tree")[0] == 0 and is_whole(data)
    assert ranges(tree) == ["bytes=1000-"]


def test_a_part_that_only_lacked_its_check_needs_no_server(run, tree, data):
    start_download(run, tree, len(BODY) - 1)
    with open(data / "tree.nrrd.part", "ab") as part:
        part.write(BODY[-1:])
    assert run("tree")[0] == 0 and is_whole(data) and tree.requests == []


@pytest.mark.parametrize("changed", [{"ETag": '"two"'}, {"Last-Modified": "Tue, 02 Jan 2024 00:00:00 GMT"}, {}])
def test_another_version_is_started_over(run, tree, data, changed):
    # Without a word of the change only the checksum can tell, and the next command starts over.
    tree.files[PATH] = OTHER_BODY
    start_download(run, tree)
    tree.files[PATH] = BODY
    tree.headers.update(changed)
    code, _, errors = run("tree")
    if changed:
        assert code == 0 and ranges(tree) == ["bytes=1000-", None] and "starting over" in errors
    else:
        assert code == 1 and "SHA-512" in errors and names_in(data) == []
        assert run("tree")[0] == 0
    assert is_whole(data)


def wrong_place(handler):
    handler.head(206, Content_Length=10, Content_Range=f"bytes 500-509/{len(BODY)}")
    handler.wfile.write(BODY[500:510])


def unknown_length(handler):
    handler.head(206, Content_Length=len(BODY) - 1000, Content_Range=f"bytes 1000-{len(BODY) - 1}/*")
    handler.wfile.write(BODY[1000:])


@pytest.mark.parametrize(
    "behave, requests",
    [(ignore_range, 1), (status(416), 2), (wrong_place, 2), (unknown_length, 2), (status(206), 2)],
)
def test_servers_that_cannot_go_on_in_the_middle(run, tree, data, behave, requests):
    start_download(run, tree)
    tree.script = [behave]
    assert run("tree")[0] == 0 and is_whole(data)
    assert ranges(tree) == ["bytes=1000-", None][:requests]


def test_pieces_of_unknown_length_are_not_joined(run, tree, data):
    def cut_without_length(handler):
        handler.head(200)
        handler.wfile.write(BODY[:1000])

    tree.script = [cut_without_length, wrong_place]
    assert run("tree")[0] == 0 and is_whole(data) and ranges(tree) == [None, "bytes=1000-", None]


def test_a_part_of_unknown_origin_is_not_used(run, tree, data):
    start_download(run, tree)
    (data / "tree.nrrd.part.from").unlink()
    assert run("tree")[0] == 0 and is_whole(data) and ranges(tree) == [None]


def test_a_part_for_another_header_is_not_used(run, tree, data, add_scene):
    start_download(run, tree)
    add_scene("tree", url=tree.address + PATH, sha512=hashlib.sha512(BODY).hexdigest(),
              raw={"dims": [30, 40, 50], "type": "uint8"})
    assert run("tree")[0] == 0 and is_whole(data) and ranges(tree) == [None]
    assert b"\nsizes: 30 40 50\n" in (data / "tree.nrrd").read_bytes()


def test_other_voxels_are_refused_and_nothing_stays(run, tree, data):
    tree.files[PATH] = OTHER_BODY
    code, output, errors = run("tree")
    assert code == 1 and output == "" and names_in(data) == []
    assert "the voxels' SHA-512 is" in error_line(errors) and tree.address in error_line(errors)


@pytest.mark.parametrize("code, text", [(404, "404 Not Found"), (403, "403"), (410, "410")])
def test_a_file_that_is_not_there_is_asked_for_once(run, tree, data, code, text):
    tree.script = [status(code)]
    result, _, errors = run("tree")
    assert result == 1 and text in error_line(errors) and tree.address + PATH in error_line(errors)
    assert len(tree.requests) == 1 and names_in(data) == []


@pytest.mark.parametrize("code", [500, 502, 503, 429, 408])
def test_faults_that_may_pass_are_tried_again(run, tree, data, code):
    tree.script = [status(code)]
    assert run("tree")[0] == 0 and is_whole(data) and len(tree.requests) == 2


def test_attempts_come_to_an_end(run, tree, data):
    tree.script = [status(500)] * 10
    code, _, errors = run("tree")
    assert code == 1 and len(tree.requests) == 3 and names_in(data) == []
    assert "500" in error_line(errors) and "gave up after 3 attempts" in error_line(errors)


def test_the_pauses_between_attempts_grow(run, tree, monkeypatch):
    pauses = []
    monkeypatch.setattr(download, "PAUSES_SECONDS", (1, 2, 4, 8))
    monkeypatch.setattr(download.time, "sleep", pauses.append)
    tree.script = [status(500)] * 10
    assert run("tree")[0] == 1 and pauses == [1, 2, 4, 8]


def test_a_server_that_falls_silent_is_tried_again(run, tree, data, monkeypatch):
    monkeypatch.setattr(download, "TIMEOUT_SECONDS", 0.2)

    def fall_silent(handler):
        answer(handler, 700)
        handler.wfile.flush()
        time.sleep(0.6)

    tree.script = [fall_silent]
    code, _, errors = run("tree")
    assert code == 0 and is_whole(data) and "timed out" in errors
    assert ranges(tree) == [None, "bytes=700-"]


def test_no_server_at_all(run, tree, data, add_scene):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    add_scene("tree", url=f"http://127.0.0.1:{port}/x", sha512="0" * 128)
    code, _, errors = run("tree")
    assert code == 1 and "no connection" in error_line(errors) and names_in(data) == []


def test_a_file_of_another_length_is_refused_before_it_comes(run, tree, data):
    tree.files[PATH] = BODY + b"x"
    code, _, errors = run("tree")
    assert code == 1 and f"the server has {len(BODY) + 1} bytes, expected {len(BODY)}" in errors
    assert names_in(data) == [] and len(tree.requests) == 1


def test_an_answer_without_length(run, tree, data):
    tree.script = [without_length]
    assert run("tree")[0] == 0 and is_whole(data)


def test_an_answer_without_length_never_fills_the_disk(run, tree, data):
    tree.files[PATH] = BODY + bytes(1 << 21)
    tree.script = [without_length]
    # What follows the volume is not even read.
    assert run("tree")[0] == 0 and is_whole(data)


def test_redirects_are_followed(run, tree, data):
    tree.files["/moved"] = BODY
    tree.script = [status(302, Location="/moved")]
    assert run("tree")[0] == 0 and is_whole(data)


@pytest.mark.parametrize("location", ["file:///etc/passwd", "ftp://127.0.0.1/x", "data:,x"])
def test_redirects_elsewhere_are_refused(run, tree, data, location):
    tree.script = [status(302, Location=location)]
    code, _, errors = run("tree")
    assert code == 1 and location.partition(":")[0] in error_line(errors)
    assert names_in(data) == [] and len(tree.requests) == 1


def test_a_circle_of_redirects_ends(run, tree):
    tree.script = [status(302, Location=PATH)] * 50
    assert run("tree")[0] == 1 and len(tree.requests) < 20


@pytest.mark.parametrize("url", ["file:///etc/passwd", "ftp://example.org/x", "/etc/passwd", "http://127.0.0.1/a b"])
def test_other_addresses_are_refused(run, add_scene, data, url):
    add_scene("tree", url=url, sha512="0" * 128)
    code, _, errors = run("tree")
    assert code == 1 and errors.count("\n") == 1 and names_in(data) == []


def test_a_file_with_its_own_header_stays_as_it_is(run, tree, data, add_scene):
    content = b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 30 50\nencoding: raw\n\n" + BODY
    tree.files["/tree.nrrd"] = content
    add_scene("tree", url=tree.address + "/tree.nrrd", sha512=hashlib.sha512(BODY).hexdigest())
    tree.script = [cut_after(1000)]
    assert run("tree")[0] == 0 and (data / "tree.nrrd").read_bytes() == content
    assert ranges(tree) == [None, "bytes=1000-"]


def test_space_is_compared_before_a_byte_comes(run, tree, data, monkeypatch):
    usage = namedtuple("usage", "free")
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage(len(BODY) - 1))
    code, _, errors = run("tree")
    assert code == 1 and "0.1 MB are needed, 0.1 MB are free" in error_line(errors) and names_in(data) == []
    monkeypatch.setattr(shutil, "disk_usage", lambda path: usage(len(BODY)))
    assert run("tree")[0] == 0


def test_a_full_disk_leaves_a_part_that_goes_on(run, tree, data, monkeypatch):
    write = PartFile._write

    def fill_disk(part, body):
        write(part, body[:2000])
        if len(body) > 2000:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(PartFile, "_write", fill_disk)
    code, _, errors = run("tree")
    assert code == 1 and "No space left" in error_line(errors)
    monkeypatch.setattr(PartFile, "_write", write)
    assert run("tree")[0] == 0 and is_whole(data)
    assert ranges(tree) == [None, "bytes=2000-"]


@pytest.mark.skipif(not os.path.isdir("/sys/kernel"), reason="no folder that even root can't write to")
def test_a_folder_that_cannot_be_written(tree, capsys):
    assert fetch.main(["tree", "--to", "/sys/kernel"]) == 1
    assert "/sys/kernel/tree.nrrd.part" in error_line(capsys.readouterr().err)
    assert tree.requests == []


def test_a_file_in_place_of_the_folder(run, tree, data):
    data.write_text("mine")
    code, _, errors = run("tree")
    assert code == 1 and str(data) in error_line(errors) and data.read_text() == "mine"


def test_links_lead_no_bytes_elsewhere(run, tree, data, tmp_path):
    mine = tmp_path / "mine"
    mine.write_text("mine")
    data.mkdir()
    (data / "tree.nrrd.part").symlink_to(mine)
    assert run("tree")[0] == 1 and mine.read_text() == "mine"
    (data / "tree.nrrd.part").unlink()
    (data / "tree.nrrd").symlink_to(mine)
    assert run("tree")[0] == 0 and mine.read_text() == "mine" and is_whole(data)
    assert not (data / "tree.nrrd").is_symlink()


def test_one_process_at_a_time(run, tree, data):
    with PartFile(data / "tree.nrrd"):
        code, _, errors = run("tree")
        assert code == 1 and "another process is writing it" in error_line(errors) and tree.requests == []
    assert run("tree")[0] == 0


def fetch_in_process(data):
    script = f"""
import sys
sys.path.insert(0, {str(SCENES)!r})
import fetch
from pathlib import Path
fetch.SCENES = Path({str(fetch.SCENES)!r})
sys.exit(fetch.main(sys.argv[1:]))
"""
    return subprocess.Popen([sys.executable, "-c", script, "tree", "--to", str(data)],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_ctrl_c_leaves_a_part_that_goes_on(run, tree, data):
    def drip(handler):
        handler.head(200, Content_Length=len(BODY))
        for start in range(0, len(BODY), 100):
            handler.wfile.write(BODY[start : start + 100])
            time.sleep(0.01)

    tree.script = [drip]
    process = fetch_in_process(data)
    part = data / "tree.nrrd.part"
    deadline = time.monotonic() + 20
    while not (part.exists() and part.stat().st_size > 5000) and time.monotonic() < deadline:
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert process.returncode == 130 and "the same command goes on from there" in errors
    assert "Traceback" not in errors
    here = part.stat().st_size - part.read_bytes().index(b"\n\n") - 2
    assert 0 < here < len(BODY)
    tree.requests.clear()
    assert run("tree")[0] == 0 and is_whole(data) and ranges(tree) == [f"bytes={here}-"]


def test_proxies_are_honoured(run, tree, data, monkeypatch, add_scene):
    url = "http://volumes.invalid/tree.raw"
    tree.files[url] = BODY  # a proxy is asked for the whole address
    add_scene("tree", url=url, sha512=hashlib.sha512(BODY).hexdigest(), raw={"dims": [40, 30, 50], "type": "uint8"})
    monkeypatch.setenv("http_proxy", tree.address)
    assert run("tree")[0] == 0 and is_whole(data) and tree.requests == [(url, None)]


@pytest.mark.skipif(not shutil.which("openssl"), reason="openssl makes the certificate")
def test_https_needs_a_certificate_that_is_trusted(run, tree, data, tmp_path, monkeypatch, add_scene):
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes",
                    "-days", "2", "-subj", "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1",
                    "-keyout", key, "-out", certificate], check=True, capture_output=True)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    tree.server.socket = context.wrap_socket(tree.server.socket, server_side=True)
    url = tree.address.replace("http:", "https:") + PATH
    add_scene("tree", url=url, sha512=hashlib.sha512(BODY).hexdigest(), raw={"dims": [40, 30, 50], "type": "uint8"})
    code, _, errors = run("tree")
    assert code == 1 and "certificate is not trusted" in error_line(errors) and "trying again" not in errors
    monkeypatch.setenv("SSL_CERT_FILE", str(certificate))
    assert run("tree")[0] == 0 and is_whole(data)


class Screen:
    def __init__(self, is_terminal):
        self.text, self._is_terminal = "", is_terminal

    def isatty(self):
        return self._is_terminal

    def write(self, text):
        self.text += text

    def flush(self):
        pass


@pytest.mark.parametrize("is_terminal", [True, False])
def test_progress_shows_share_rate_and_time_left(is_terminal, monkeypatch):
    screen, now = Screen(is_terminal), [100.0]
    monkeypatch.setattr(sys, "stderr", screen)
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    progress = Progress("tree")
    progress.start(10_000_000, 50_000_000)  # 10 MB were here before
    for _ in range(10):
        now[0] += 1
        progress.advance(1_000_000)
    assert "tree: [#########...............]  40 %  20.0 of 50.0 MB  1.0 MB/s  0:30 left" in screen.text
    progress.end()
    shown = screen.text.replace("\r", "\n").strip().splitlines()
    assert len(shown) == (12 if is_terminal else 3), "each second on a terminal, every five seconds elsewhere"
    assert ("\x1b" in screen.text) == is_terminal and screen.text.endswith("\n")
