"""The report in a browser: headless Chromium, a file, no network."""

import base64
import hashlib
import html
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from volmark_analysis.__main__ import main

CHROMIUM = shutil.which("chromium")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed (apt-get install chromium)")

# Uses the page as a reader would and leaves what it saw in an attribute that --dump-dom shows.
PROBE = r"""
addEventListener("error", event => errors.push(event.message));
addEventListener("securitypolicyviolation", event => errors.push(`blocked ${event.violatedDirective}`));
addEventListener("load", () => {
  const all = selector => [...document.querySelectorAll(selector)];
  const shown = element => element.getClientRects().length > 0;
  const saw = {};
  const style = getComputedStyle(document.body);
  saw.colors = [style.color, style.backgroundColor];
  saw.dark = matchMedia("(prefers-color-scheme: dark)").matches;
  saw.darkPlots = all("picture img").map(image => image.currentSrc === image.previousElementSibling.srcset);
  all("details").forEach(details => { details.open = true; });
  saw.widths = [innerWidth, document.documentElement.scrollWidth];
  saw.beyond = all("main *").filter(e => !e.closest(".wide") && e.getBoundingClientRect().right > innerWidth + 1)
    .slice(0, 5).map(e => `${e.tagName} ${e.className}`);
  saw.broken = all("img").filter(image => image.getAttribute("src") && !image.naturalWidth).length;
  saw.images = all("img").length;
  saw.loaded = performance.getEntriesByType("resource").filter(entry => !entry.name.startsWith("data:")).length;

  const column = all("#results th").findIndex(head => head.textContent.startsWith("frame time"));
  const body = document.querySelector("#results table").tBodies[0];
  all("#results th")[column].click();
  const times = body.querySelectorAll(`tr:not(.failed) td:nth-child(${column + 1})`);
  saw.sorted = [...times].map(cell => parseFloat(cell.dataset.key));

  saw.plots = all("[data-choice] h3").filter(shown).length;
  const picks = all(".picks input:not([name=shade])");
  picks.at(-1)?.click();
  saw.plotsAfter = all("[data-choice] h3").filter(shown).length;
  saw.lastPlot = all("[data-choice] h3").filter(shown).map(head => head.textContent);

  const cell = document.querySelector(".heat td[style*='--g1']");
  const colors = all("[name=shade]").map(pick => {
    pick.click();
    return cell && getComputedStyle(cell).backgroundColor;
  });
  saw.shades = [colors, all("[data-shade]").filter(shown).length];

  const [stage, divider] = [document.querySelector(".stage"), document.querySelector(".compare input")];
  if (stage) {
    const box = stage.getBoundingClientRect();
    const at = share => ({pointerId: 1, buttons: 1, clientX: box.left + share * box.width, bubbles: true});
    stage.setPointerCapture = () => {};
    stage.dispatchEvent(new PointerEvent("pointerdown", at(0.25)));
    stage.dispatchEvent(new PointerEvent("pointermove", at(0.75)));
    const over = stage.querySelector(".over");
    saw.divider = [parseFloat(divider.value), getComputedStyle(over).clipPath];
    const block = document.querySelector(".block");
    const sources = [...block.querySelectorAll("img.zoom")].map(image => image.src);
    const [under] = stage.children;
    saw.compared = [sources.indexOf(over.src), sources.indexOf(under.src)];
    const right = document.querySelectorAll(".compare select")[1];
    right.value = 2;
    right.dispatchEvent(new Event("input", {bubbles: true}));
    saw.comparedAfter = sources.indexOf(under.src);
    saw.choices = right.options.length === sources.length;
    block.querySelector("img.zoom").click();
    saw.zoomed = [all(".zoomed").length];
    document.dispatchEvent(new KeyboardEvent("keydown", {key: "Escape"}));
    saw.zoomed.push(all(".zoomed").length);
  }
  const field = document.querySelector(".filter");
  if (field) {
    const rows = [...field.nextElementSibling.querySelectorAll("tbody tr")];
    field.querySelector("input").value = "DVR 1.0";
    field.querySelector("input").dispatchEvent(new Event("input"));
    saw.found = [rows.filter(shown).length, field.querySelector("output").textContent];
    const fits = row => /dvr/.test(row.textContent) && row.textContent.includes("1.0");
    saw.foundWrongly = rows.filter(row => shown(row) !== fits(row)).length;
  }
  saw.title = document.title;
  saw.errors = errors;
  document.documentElement.dataset.saw = JSON.stringify(saw);
  parent.postMessage(JSON.stringify(saw), "*");
});
const errors = [];
"""
# A window can't be as narrow as a phone: there the page stands in a frame that is, and tells it what it saw.
NARROW = """<!doctype html><body style="margin:0">
<iframe src="{name}" width="{width}" height="844" style="border:0"></iframe>
<script>
addEventListener("message", event => {{ document.documentElement.dataset.saw = event.data; }});
</script></body>"""


def probed(report: Path, folder: Path, width: int, dark: bool) -> dict:
    """What the probe saw of a report; but for the probe the page is as it is."""
    text = report.read_text(encoding="utf-8")
    key = base64.b64encode(hashlib.sha256(PROBE.encode()).digest()).decode()
    text = text.replace("script-src ", f"script-src 'sha256-{key}' ", 1)
    text = text.replace("<style>", f"<script>{PROBE}</script><style>", 1)
    page = folder / f"probed_{width}_{dark}.html"
    page.write_text(text, encoding="utf-8")
    if width < 500:
        frame = page.with_name(f"frame_{width}_{dark}.html")
        frame.write_text(NARROW.format(name=page.name, width=width))
        page = frame
    command = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync",
               "--disable-background-networking", "--disable-component-update", "--hide-scrollbars",
               f"--user-data-dir={folder / 'profile'}", "--host-resolver-rules=MAP * ~NOTFOUND",
               f"--window-size={max(width, 500)},900", f"--blink-settings=preferredColorScheme={0 if dark else 1}",
               "--virtual-time-budget=5000", "--dump-dom", page.as_uri()]
    dom = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True).stdout
    saw = re.search(r'<html[^>]* data-saw="([^"]*)"', dom)
    assert saw, "the page never came to its end"
    return json.loads(html.unescape(saw[1]))


def luminance(color: str) -> float:
    value = [int(part) / 255 for part in re.findall(r"\d+", color)[:3]]
    linear = [v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4 for v in value]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


@pytest.fixture(scope="module")
def report(experiment_folder, tmp_path_factory):
    folder = tmp_path_factory.mktemp("browser")
    copy = Path(shutil.copytree(experiment_folder, folder / "synthetic"))
    assert main(["report", str(copy), "-o", str(folder / "report.html")]) == 0
    return folder / "report.html"


@pytest.fixture(scope="module")
def seen(report):
    """By width and scheme, each looked at once."""
    return {(width, dark): probed(report, report.parent, width, dark)
            for width, dark in ((1280, False), (1280, True), (390, False), (390, True))}


def test_runs_without_errors_and_loads_nothing(seen):
    for saw in seen.values():
        assert saw["errors"] == [] and saw["loaded"] == 0
        assert saw["broken"] == 0 and saw["images"] > 50


def test_nothing_is_wider_than_the_screen(seen):
    for (width, _), saw in seen.items():
        assert saw["widths"][0] == width
        assert saw["widths"][1] <= width and saw["beyond"] == [], (width, saw["beyond"])


def test_follows_the_light_and_the_dark_scheme(seen):
    for (_, dark), saw in seen.items():
        text, ground = map(luminance, saw["colors"])
        assert saw["dark"] == dark == (ground < text)
        assert (max(text, ground) + 0.05) / (min(text, ground) + 0.05) > 7
        assert saw["darkPlots"] and set(saw["darkPlots"]) == {dark}


def test_tables_sort(seen):
    for saw in seen.values():
        assert len(saw["sorted"]) == 8 and saw["sorted"] == sorted(saw["sorted"])


def test_one_error_at_a_time(seen):
    for saw in seen.values():
        assert saw["plots"] == saw["plotsAfter"] == 1 and saw["lastPlot"] == ["Depth error against time"]


def test_heat_maps_change_what_colours_them(seen):
    for saw in seen.values():
        colors, scales = saw["shades"]
        assert len(colors) == 5 and len(set(colors)) > 2 and scales == 1


def test_divider_lies_between_two_pictures(seen):
    for saw in seen.values():
        assert saw["divider"][0] == pytest.approx(75, abs=0.5)
        assert saw["divider"][1].startswith("inset(0px ") and saw["divider"][1] != "inset(0px 0px 0px 0px)"
        assert saw["compared"] == [1, 0]  # the first point over the reference
        assert saw["comparedAfter"] == 2 and saw["choices"]
        assert saw["zoomed"] == [1, 0]


def test_long_tables_can_be_searched(large_folder, tmp_path):
    saw = probed(large_folder / "report.html", tmp_path, 1280, False)
    assert saw["errors"] == [] and saw["broken"] == 0 and saw["foundWrongly"] == 0
    count, text = saw["found"]
    assert 0 < count < 200 and text == f"{count} of 200"


def test_hostile_text_runs_nothing(hostile_folder):
    saw = probed(hostile_folder / "report.html", hostile_folder.parent, 1280, False)
    assert saw["errors"] == [] and saw["loaded"] == 0 and not saw["title"].startswith("owned")
    assert saw["widths"][1] <= 1280
