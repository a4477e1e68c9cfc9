import json

import pytest

from volmark_analysis import __main__ as program
from volmark_analysis.errors import InputError
from volmark_analysis.microbenchmarks import read_benchmarks, to_markdown


def entry(name, time, unit="ms", **more):
    return {"name": name, "run_name": name, "run_type": "iteration", "real_time": time, "cpu_time": 2 * time,
            "time_unit": unit, **more}


def write(path, *entries):
    path.write_text(json.dumps({"context": {}, "benchmarks": list(entries)}))
    return path


def test_times_are_milliseconds_of_the_clock_that_the_name_says(tmp_path):
    found = read_benchmarks(write(tmp_path / "a.json", entry("load/256/real_time", 3e6, "ns"), entry("expand", 2, "s")))
    assert found["load/256/real_time"].median_ms == pytest.approx(3)
    assert found["expand"].median_ms == pytest.approx(4000)


def test_repetitions_are_joined_and_aggregates_left_out(tmp_path):
    aggregate = {**entry("a/real_time", 100), "name": "a/real_time_mean", "run_type": "aggregate"}
    found = read_benchmarks(write(tmp_path / "a.json", entry("a/real_time", 1), entry("a/real_time", 5),
                                  entry("a/real_time", 2), aggregate))
    assert found["a/real_time"].median_ms == 2
    assert "1 to 5" in to_markdown(found).replace(".00", "")


def test_a_second_file_gives_ratios(tmp_path, capsys):
    old = write(tmp_path / "old.json", entry("a/real_time", 4), entry("gone/real_time", 1))
    new = write(tmp_path / "new.json", entry("a/real_time", 3, bytes_per_second=2e9), entry("b/real_time", 1))
    assert program.main(["bench", str(new), "--old", str(old)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[2].endswith("| 2.00 GB/s | 0.750 |") and lines[3].endswith("|  |")


def test_skipped_benchmarks_say_why(tmp_path):
    skipped = entry("draw|x", 0, error_occurred=True, error_message="no Vulkan device")
    text = to_markdown(read_benchmarks(write(tmp_path / "a.json", skipped)))
    assert "skipped" in text and "no Vulkan device" in text and "draw\\|x" in text


@pytest.mark.parametrize("text", ["", "[]", '{"benchmarks": 1}', '{"benchmarks": [{"name": "a"}]}', "null",
                                  '{"benchmarks": [{"name": "a", "cpu_time": 1, "time_unit": "h"}]}'])
def test_other_files_are_one_line(tmp_path, text):
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(InputError) as error:
        read_benchmarks(tmp_path / "a.json")
    assert "a.json" in str(error.value) and "\n" not in str(error.value)
    with pytest.raises(InputError):
        read_benchmarks(tmp_path / "missing.json")
