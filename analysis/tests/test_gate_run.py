"""The whole gate, with a program and a valgrind that are made up."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from volmark_analysis.__main__ import main
from volmark_analysis.gate import stages
from volmark_analysis.gate.builds import MachineError, resolve
from volmark_analysis.gate.program import count_instructions, kept_count, read_scenario, read_totals

FAKE = Path(__file__).parent / "fake_volmark.py"


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty repository folder with a scenario."""
    monkeypatch.chdir(tmp_path)
    write_scenario("configs/ci/small.json", "small", ["dvr", "iso"])
    return tmp_path


def write_scenario(path, name, points, **more):
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_text(json.dumps({"name": name, "points": points, "profiles": {"instructions": {}}} | more))


def build(folder, **changes):
    Path(folder).mkdir(parents=True)
    program = Path(folder) / "volmark"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} {FAKE} "$0" "$@"\n')
    program.chmod(0o755)
    (Path(folder) / "side.json").write_text(json.dumps(changes))
    return folder


def fake_valgrind(folder, monkeypatch, totals, code=0):
    """Counts the given totals, one part each; calls without a tool only run the program."""
    folder.mkdir()
    script = folder / "valgrind"
    lines = ["#!/bin/sh", 'for a in "$@"; do case "$a" in --callgrind-out-file=*) out=${a#*=} ;; esac; done',
             f'echo "$MESA_SHADER_CACHE_DIR $LP_NUM_THREADS $*" >> {folder}/calls', '[ -n "$out" ] || exit 0',
             "out=$(echo $out | sed s/%p/77/)"]
    for part, total in enumerate(totals, start=1):
        name = "$out" if part == len(totals) else f"$out.{part}"
        lines.append(f'printf "version: 1\\npart: {part}\\n\\nfn=(1) 0\\n\\ntotals: {total}\\n" > "{name}"')
    script.write_text("\n".join([*lines, f"exit {code}"]) + "\n")
    script.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:{os.environ['PATH']}")


def gate(*arguments):
    return main(["gate", *map(str, arguments)])


def calls(folder):
    return [line.split(" ") for line in (Path(folder) / "calls").read_text().splitlines()]


def test_equal_builds_pass(here, capsys, monkeypatch):
    fake_valgrind(here / "bin", monkeypatch, [900, 10, 10, 10, 100, 100, 100, 104, 5])
    assert gate("--base", build("a"), "--candidate", build("b"), "--output", "out", "--pairs", 8) == 0
    printed = capsys.readouterr()
    assert "volmark gate: same" in printed.out and printed.out == Path("out/verdict.md").read_text()
    assert "+0.0000 % a frame" in printed.out and "Not calibrated" in printed.out
    verdict = json.loads(Path("out/verdict.json").read_text())
    assert verdict["outcome"] == "same" and verdict["spent_seconds"] > 0
    point = verdict["scenarios"][0]["points"][0]
    assert point["time"]["cpu"]["pairs"] == 8 and point["exact"]["base"]["instructions"] == 102
    assert [c[0] for c in calls("out")] == ["first", "first"]  # a probe, then all; nothing to confirm
    assert len(Path("results/gate/history.jsonl").read_text().splitlines()) == 1
    assert "gate [0:" in printed.err and "min left" in printed.err
    # Two points of two builds, each once to compile and once to count; of one program under two names a count tells both.
    assert len((here / "bin" / "calls").read_text().splitlines()) == 8
    assert gate("--base", "a", "--candidate", "a", "--output", "again", "--pairs", 8) == 0
    assert len((here / "bin" / "calls").read_text().splitlines()) == 8 + 4
    assert "+0.0000 % a frame" in capsys.readouterr().out


def test_slower_builds_are_confirmed_by_fresh_pairs_of_the_slow_point_alone(here, capsys):
    build("a"), build("b", only="iso", cpu=1.1, wall=1.1)
    assert gate("--base", "a", "--candidate", "b", "--output", "out", "--pairs", 8, "--no-instructions") == 1
    assert [(stage, points) for stage, _, points, _ in calls("out")] == \
        [("first", "0,1"), ("first", "0,1"), ("confirmation", "1")]
    seeds = {stage: seed for stage, _, _, seed in calls("out")}
    assert seeds["first"] != seeds["confirmation"]
    assert "confirmed" in capsys.readouterr().out


def test_the_time_given_decides_the_number_of_pairs(here, monkeypatch):
    build("a"), build("b")
    write_scenario("configs/ci/small.json", "small", ["dvr"])
    seconds = iter(range(0, 10000, 30))  # every look at the clock is half a minute later
    monkeypatch.setattr(stages.time, "monotonic", lambda: float(next(seconds)))
    monkeypatch.setattr(stages, "MOST_PAIRS", 14)
    pairs = {}
    for minutes in (1, 8, 60):
        assert gate("--base", "a", "--candidate", "b", "--output", f"out{minutes}", "--minutes", minutes, "--no-instructions") == 0
        pairs[minutes] = int(calls(f"out{minutes}")[-1][1])
    assert pairs[1] == stages.FEWEST_PAIRS < pairs[8] < pairs[60] == stages.MOST_PAIRS


def test_failing_points_are_named(here, capsys):
    build("a"), build("b", status="failed", reason="device lost")
    assert gate("--base", "a", "--candidate", "b", "--pairs", 2, "--no-instructions") == 1
    assert "failed: device lost" in capsys.readouterr().out
    assert gate("--base", "b", "--candidate", "a", "--pairs", 2, "--no-instructions", "--output", "other") == 4
    assert "base can't run it" in capsys.readouterr().out
    assert gate("--judge", "other", "--allow-inconclusive") == 0


def test_judging_again_runs_nothing_and_takes_other_rules(here, capsys):
    build("a"), build("b", picture=0.6)
    assert gate("--base", "a", "--candidate", "b", "--pairs", 8, "--no-instructions", "--output", "out") == 1
    before = (here / "out" / "calls").read_text()
    assert gate("--judge", "out", "--accept-changes") == 0
    assert gate("--judge", "out", "--accept-changes", "--margin", "0.0001") == 4
    assert (here / "out" / "calls").read_text() == before
    assert len(Path("results/gate/history.jsonl").read_text().splitlines()) == 1


def test_baselines_hold_what_is_exact(here, capsys):
    build("a"), build("slow", cpu=3.0, wall=3.0), build("b", counters={"samples": 1.0})
    assert gate("--candidate", "a", "--store-baseline", "base.json", "--no-instructions") == 0
    assert not Path("results/gate/history.jsonl").exists()  # nothing was judged
    stored = json.loads(Path("base.json").read_text())
    assert stored["format"] == "volmark.baseline" and "_ms" not in json.dumps(stored) and "time" not in stored
    assert gate("--base", "base.json", "--candidate", "slow", "--no-instructions", "--output", "o1") == 0
    assert "time was not compared" in capsys.readouterr().out
    assert json.loads(Path("o1/verdict.json").read_text())["base"]["name"] == "a"
    assert gate("--base", "base.json", "--candidate", "b", "--no-instructions", "--output", "o2") == 1
    build("elsewhere", device="another GPU")
    assert gate("--base", "base.json", "--candidate", "elsewhere", "--no-instructions", "--output", "o3") == 2
    assert "store it again on this driver" in capsys.readouterr().err
    Path("base.json").write_text('{"format": "volmark.baseline", "version": 1}')
    assert gate("--judge", "o1", "--base", "base.json") == 2


@pytest.mark.parametrize("arguments, words", [
    ([], "--base: missing"), (["--base", "no-such-thing"], "--base: 'no-such-thing' is neither"), (["--base", "empty"], "no program"),
    (["--base", "a", "--candidate", "a/side.json"], "--candidate: a/side.json is a file"), (["--base", "a", "--clocks", "gpu"], "--clocks"),
    (["--base", "a", "--candidate", "a", "--configs", "missing.json"], "missing.json"),
    (["--base", "a", "--candidate", "a", "--configs", "a/side.json"], "not a scenario"),
    (["--base", "a", "--candidate", "a", "--output", "full"], "full is not empty"), (["--judge", "nowhere"], "gate.json"),
    (["--base", "--upload-pack=touch x", "--candidate", "a"], "is neither")])
def test_bad_input_is_one_line(here, capsys, arguments, words):
    build("a")
    Path("empty").mkdir()
    (here / "full" / "inner").mkdir(parents=True)
    assert gate(*arguments) == 2
    error = capsys.readouterr().err
    assert words in error and error.count("\n") == 1


def test_what_the_program_says_decides_the_exit_code(here, capsys):
    build("a")
    for code, words in ((2, "unknown key"), (3, "no Vulkan device")):
        write_scenario("configs/ci/small.json", "small", ["dvr"], exit=[code, words])
        assert gate("--base", "a", "--candidate", "a", "--no-instructions", "--pairs", 1, "--output", f"out{code}") == code
        assert words in capsys.readouterr().err


def test_a_script_is_not_the_runner(here):
    """What a wrapper sets for its own workers must not reach those of the other build."""
    from volmark_analysis.gate.program import _runner
    (here / "binary").write_bytes(b"\x7fELF")
    (here / "script").write_text("#!/bin/sh\n")
    binary, script = here / "binary", here / "script"
    assert _runner({"base": binary, "candidate": script}) == binary
    assert _runner({"base": script, "candidate": binary}) == binary
    assert _runner({"base": binary, "candidate": binary}) == binary
    assert _runner({"candidate": script}) == script


def test_counts_are_of_the_frames_of_the_last_orbit(here, monkeypatch):
    scenario = read_scenario(Path(build("a")).resolve() / "volmark", Path("configs/ci/small.json"))
    program = here / "a" / "volmark"
    fake_valgrind(here / "bin", monkeypatch, [9000, 1, 2, 3, 40, 50, 60, 80, 777])
    count = count_instructions(program, scenario, 1, here / "counts", here / "shaders")
    assert (count.frames, count.per_frame) == ([60, 80], 70)
    warming, counting = (here / "bin" / "calls").read_text().splitlines()
    assert "--tool=none" in warming and "--orbits 0" in warming and "--tool=callgrind" in counting and "--orbits 2" in counting
    assert all(line.startswith(f"{here}/shaders 0 ") and "--profile instructions" in line and "--device llvmpipe" in line for line in (warming, counting))


def test_counts_of_a_revision_are_kept_until_something_changes(here, monkeypatch):
    program = Path(build("a")).resolve() / "volmark"
    fake_valgrind(here / "bin", monkeypatch, [9000, 1, 2, 3, 40, 50, 60, 80, 777])

    def counted(kept=here / "kept"):
        before = len(calls("bin")) if (here / "bin" / "calls").exists() else 0
        scenario = read_scenario(program, Path("configs/ci/small.json"))
        assert kept_count(kept, program, scenario, 0, here / "counts", here / "shaders").per_frame == 70
        return any("callgrind" in " ".join(call) for call in calls("bin")[before:])

    assert counted() and not counted() and not counted()
    assert counted(None) and counted(None)
    write_scenario("configs/ci/small.json", "small", ["dvr", "iso"], title="another")
    assert counted() and not counted()
    monkeypatch.setenv("FAKE_DRIVER", "2")
    assert counted() and not counted()
    for path in (here / "kept").iterdir():
        path.write_text("[6")
    assert counted() and not counted()


def test_what_cannot_be_counted_says_why(here, capsys, monkeypatch):
    build("a"), build("b")
    fake_valgrind(here / "bin", monkeypatch, [9000, 777])
    assert gate("--base", "a", "--candidate", "b", "--pairs", 7, "--output", "out") == 0
    printed = capsys.readouterr().out
    assert "not counted" in printed and "1 of 4 frames were counted" in printed
    monkeypatch.setenv("PATH", "/nowhere")
    with pytest.raises(MachineError, match="valgrind is not installed"):
        count_instructions(here / "a/volmark", read_scenario_stub(), 0, here / "c", here / "s")


def read_scenario_stub():
    from volmark_analysis.gate.program import Scenario
    return Scenario(Path("configs/ci/small.json"), "small", [], True)


def test_parts_of_a_wrapper_are_not_frames(tmp_path):
    for name, part, total in (("5", 1, 99), ("7.1", 1, 10), ("7.2", 2, 20), ("7", 3, 30), ("7.10", 10, 40)):
        (tmp_path / f"counts.{name}").write_text(f"part: {part}\ntotals: {total}\n")
    assert read_totals(tmp_path) == [10, 20, 30, 40]


def test_a_revision_is_built_once(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for command in (["init", "-q"], ["config", "user.email", "a@b"], ["config", "user.name", "a"]):
        subprocess.run(["git", *command], check=True)
    Path("CMakeLists.txt").write_text("")
    subprocess.run(["git", "add", "."], check=True)
    subprocess.run(["git", "commit", "-q", "-m", "first"], check=True)
    tools = tmp_path / "tools"
    tools.mkdir()
    (tools / "cmake").write_text(f'#!/bin/sh\necho "$PWD $*" >> {tmp_path}/made\n[ -e {tmp_path}/broken ] && exit 1\n'
                                 'mkdir -p build/release; printf "#!/bin/sh\\n" > build/release/volmark; chmod +x build/release/volmark\n')
    (tools / "ninja").write_text("#!/bin/sh\n")
    for tool in tools.iterdir():
        tool.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tools}:{os.environ['PATH']}")
    said = []
    (tmp_path / "broken").touch()
    assert gate("--base", "HEAD", "--results", "r") == 2
    assert ".log" in capsys.readouterr().err.splitlines()[-1]
    (tmp_path / "broken").unlink()
    first = resolve("HEAD", "--base", Path("r/builds"), said.append)
    again = resolve("HEAD^{commit}", "--base", Path("r/builds"), said.append)
    assert first.program == again.program and len(said) == 1 and len(first.side.commit) == 40
    made = Path("made").read_text().splitlines()
    assert len(made) == 3 and all(line.split()[0].endswith(first.side.commit[:12]) for line in made)
    assert "release" in made[1] and "-DVOLMARK_TESTS=OFF" in made[1]
