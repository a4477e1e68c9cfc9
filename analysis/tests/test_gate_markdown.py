import re

import pytest
from gate_folders import make_side, write_gate
from hostile import HOSTILE
from volmark_analysis.gate.evidence import Side, read_evidence
from volmark_analysis.gate.markdown import code, to_markdown
from volmark_analysis.gate.rules import Rules
from volmark_analysis.gate.verdicts import judge

MARKDOWN = ["`", "``x``", "` | `", "a|b", "\\|", "\\", "[x](http://evil)", "![x](y)", "@someone", "#12", "a\nb", "a\r\n# title",
            "**x**", "| a | b |", "   ", "", "<!-- ", "\u202egnp.exe", "`" * 30, "a\u2028b", "http://evil.example", "\x00\x1b[2J"]


def spans_of(line):
    """Splits a line by CommonMark's rule for code spans: the next run of backticks of equal length closes. Returns what
    is inside and what is outside."""
    inside, outside, at = [], "", 0
    while match := re.compile("`+").search(line, at):
        fence = match[0]
        close = next((m for m in re.compile("`+").finditer(line, match.end()) if m[0] == fence), None)
        outside += line[at:match.start()]
        if close is None:
            outside, at = outside + fence, match.end()
        else:
            inside.append(line[match.end():close.start()])
            outside, at = outside + "␣", close.end()
    return inside, outside + line[at:]


@pytest.mark.parametrize("text", HOSTILE + MARKDOWN)
def test_a_code_span_holds_everything(text):
    line = code(text)
    assert "\n" not in line and "|" not in line and line.isprintable()
    inside, outside = spans_of(f"before {line} after")
    assert outside in ("before ␣ after", "before – after")
    if inside:
        plain = re.sub(r"\s+", "", text.replace("|", "¦"))
        assert re.sub(r"\s+", "", inside[0]) == "".join(c for c in plain if c.isprintable())


def test_long_texts_are_cut():
    assert len(code("x" * 10000)) < 1000


@pytest.fixture(scope="module")
def hostile_text(tmp_path_factory):
    """Every text that a gate can show, hostile."""
    bad = "".join(HOSTILE + MARKDOWN)
    scenario = "ci|<b>`@all`"
    points = {(scenario, HOSTILE[0] + "|x"): (make_side(), make_side(counters={bad.replace("\x00", ""): 2.0, "samples": 1.0})),
              (scenario, "`" + HOSTILE[1]): (make_side(), make_side(status="failed", reason=bad)),
              (scenario, HOSTILE[2] + "\n"): (make_side(), make_side(checks=False, governor=bad)),
              (scenario, HOSTILE[5]): (make_side(status="crashed", reason=bad), make_side())}
    folder = write_gate(tmp_path_factory.mktemp("hostile") / "gate", points, pairs=2, title=bad, base=bad, candidate=bad)
    for path in folder.glob("first/*/runs/*/*/run.json"):
        path.write_text(path.read_text().replace("llvmpipe", "<img src=x>|@all`"))
    evidence = read_evidence(folder)
    return to_markdown(judge(evidence, Rules()), Side(bad, bad), evidence.candidate, "Not calibrated.", 61.0)


def test_hostile_texts_stay_in_their_spans(hostile_text):
    for line in hostile_text.splitlines():
        _, outside = spans_of(line)
        assert not re.search(r"[<>@#`\\]|\]\(|http|!\[", outside.removeprefix("##").removeprefix("#")), line
    assert hostile_text.count("alert(1)") > 3  # they were shown


def test_hostile_texts_do_not_break_tables(hostile_text):
    tables = re.findall(r"(?:^\|.*\n)+", hostile_text, re.M)
    assert len(tables) == 2
    for table in tables:
        assert len({line.count("|") for line in table.splitlines()}) == 1


def test_reads_as_a_summary(tmp_path):
    folder = write_gate(tmp_path, {("ci", "dvr"): (make_side(), make_side(cpu=1.06, wall=1.06, instructions=10.2e6)),
                                   ("ci", "iso"): (make_side(), make_side())}, pairs=8, confirming=8)
    evidence = read_evidence(folder)
    verdict = judge(evidence, Rules())
    text = to_markdown(verdict, evidence.base, evidence.candidate, "Calibrated.", 120.0)
    lines = text.splitlines()
    assert "regressed" in lines[0] and "2.0 minutes" in lines[2]
    rows = [line for line in lines if line.startswith("| `ci`")]
    assert "❌ regressed" in rows[0] and "+2.0000 %" in rows[0] and "confirmed" in rows[0]
    assert "✅ same" in rows[1] and "pictures identical, counters identical" in rows[1]
    # A time is never shown without the error of its picture.
    times = [line for line in lines if "| base |" in line or "| candidate |" in line]
    assert len(times) == 4 and all(line.endswith("40.0 dB |") for line in times)
    assert "16 pairs" in lines[-1] and "Calibrated." in lines[-1]
