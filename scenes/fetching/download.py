"""One file over http or https into a PartFile, in as many pieces as it takes."""
import http.client
import re
import ssl
import time
import urllib.error
import urllib.parse
import urllib.request

from . import FetchError

TIMEOUT_SECONDS = 30
PAUSES_SECONDS = (1, 2, 4, 8)  # before the second and later attempts
CHUNK_BYTES = 1 << 18
SCHEMES = ("http", "https")
# Besides 5xx: request timeout, too many requests.
PASSING_STATUS = (408, 429)


class PassingError(Exception):
    """A fault that may be gone the next time."""


class Redirects(urllib.request.HTTPRedirectHandler):
    """To http and https only; urllib itself would also follow to ftp."""

    def redirect_request(self, request, answer, code, message, headers, url):
        if urllib.parse.urlsplit(url).scheme not in SCHEMES:
            raise urllib.error.HTTPError(url, code, f"redirected to {url}, allowed: http, https", headers, answer)
        return super().redirect_request(request, answer, code, message, headers, url)


def make_opener():
    """Without urllib's handlers for file:, ftp: and data:. Honours http_proxy, https_proxy and no_proxy."""
    opener = urllib.request.OpenerDirector()
    for handler in (
        urllib.request.ProxyHandler,
        urllib.request.HTTPHandler,
        urllib.request.HTTPSHandler,
        urllib.request.UnknownHandler,
        urllib.request.HTTPDefaultErrorHandler,
        urllib.request.HTTPErrorProcessor,
        Redirects,
    ):
        opener.add_handler(handler())
    return opener


def judge(error, start):
    """Raises what the status means, but returns a 416: the piece asked for isn't there, the caller begins anew."""
    if error.code == 416 and start > 0:
        return error
    error.close()
    text = f"the server says {error.code} {error.reason}"
    if error.code >= 500 or error.code in PASSING_STATUS:
        raise PassingError(text)
    raise FetchError(text)


def request(url, start):
    """The server's answer about the bytes from `start` on."""
    # A compressed answer would have other lengths.
    headers = {"User-Agent": "volmark-fetch", "Accept-Encoding": "identity"}
    if start > 0:
        headers["Range"] = f"bytes={start}-"
    try:
        return make_opener().open(urllib.request.Request(url, headers=headers), timeout=TIMEOUT_SECONDS)
    except urllib.error.HTTPError as error:
        return judge(error, start)
    except urllib.error.URLError as error:
        if isinstance(error.reason, ssl.SSLCertVerificationError):
            raise FetchError(f"its certificate is not trusted: {error.reason.verify_message}") from None
        raise PassingError(f"no connection: {error.reason}") from None
    except http.client.InvalidURL as error:
        raise FetchError(str(error)) from None
    except (OSError, http.client.HTTPException) as error:
        raise PassingError(str(error) or type(error).__name__) from None


def read_chunk(answer, limit):
    """What has come, at most `limit` bytes; empty at the end. Waiting for more could lose it to a fault."""
    try:
        return answer.read1(limit)
    except (OSError, http.client.HTTPException) as error:
        raise PassingError(str(error) or type(error).__name__) from None


def length_of(answer, start):
    """Length of the whole file, or None if the server doesn't say."""
    if answer.status == 206:
        match = re.fullmatch(r"bytes (\d+)-\d+/(\d+)", answer.headers.get("Content-Range", "").strip())
        return int(match[2]) if match and int(match[1]) == start else None
    text = answer.headers.get("Content-Length", "")
    return int(text) if text.isdecimal() else None


def origin_of(url, answer, start):
    """What must be the same for a piece to fit the pieces before it."""
    return {
        "url": url,
        "etag": answer.headers.get("ETag"),
        "modified": answer.headers.get("Last-Modified"),
        "bytes": length_of(answer, start),
    }


def continues(part, url, answer, start):
    origin = origin_of(url, answer, start)
    return answer.status == 206 and origin["bytes"] is not None and origin == part.origin


def copy_body(answer, part, end, progress):
    """Appends until the body has `end` bytes, or without `end` to the end of the answer."""
    while end is None or part.body_bytes < end:
        limit = CHUNK_BYTES if end is None else min(CHUNK_BYTES, end - part.body_bytes)
        chunk = read_chunk(answer, limit)
        if not chunk:
            break
        part.append(chunk)
        progress.advance(len(chunk))
    if end is not None and part.body_bytes < end:
        raise PassingError(f"the connection ended after {part.body_bytes} of {end} bytes")


def receive(url, part, size, progress):
    """One attempt. `size` is that of the whole body if it is known beforehand."""
    start = part.body_bytes
    if size is not None and start == size:
        return
    answer = request(url, start)
    if start > 0 and not continues(part, url, answer, start):
        progress.say("what was here is of another version, or the server can't go on in the middle: starting over")
        if answer.status != 200:
            answer.close()
            answer = request(url, 0)
        start = 0
    with answer:
        length = length_of(answer, start)
        if answer.status != (206 if start > 0 else 200):
            raise FetchError(f"the server says {answer.status}, expected 200")
        if size is not None and length not in (None, size):
            raise FetchError(f"the server has {length} bytes, expected {size}")
        end = length if size is None else size
        if start == 0:
            part.restart(origin_of(url, answer, start))
        if end is not None:
            part.require_space(end - start)
        progress.start(start, end)
        copy_body(answer, part, end, progress)
    progress.end()


def download(url, part, size, progress):
    """Appends the file at `url` to the part, from where an earlier download of the same file stopped.

    Faults that may pass are met with more attempts. What came stays in the part in any case.
    """
    if urllib.parse.urlsplit(url).scheme not in SCHEMES:
        raise FetchError(f"found the address {url}, allowed: http, https")
    for pause in (*PAUSES_SECONDS, None):
        try:
            return receive(url, part, size, progress)
        except FetchError as error:
            raise FetchError(f"{url}: {error}") from None
        except PassingError as error:
            if pause is None:
                text = f"{error}; gave up after {len(PAUSES_SECONDS) + 1} attempts, the same command goes on"
                raise FetchError(f"{url}: {text}") from None
            progress.say(f"{error}; trying again in {pause} s")
            time.sleep(pause)
