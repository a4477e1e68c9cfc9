"""What one process does for others: workers that serve many runs, limits, memory that is too short for all."""

import os

import pytest
from conftest import SMALL
from test_grid import by_fault, faults


def run(volmark, document, *options):
    return volmark("run", volmark.scenario(document), "--results", volmark.results, *options)


def processes(runs):
    return [document["provenance"]["process"] for document in runs.values()]


def host_grid(count, isolation, scenes=("marschner_lobb",)):
    """Points of one technique that are worked one after the other."""
    return {"set": {**SMALL, "technique": {"name": "test_host_threads", "parameters": {}},
                    "measure": {"isolation": isolation, "interleave": 1}},
            "blocks": [{"axes": {"scene": {"path": "scene", "values": list(scenes)},
                                 "view": {"path": "timeline.elevation_degrees", "values": list(range(count))}}}]}


def test_one_process_serves_all_runs_of_a_volume_with_the_same_pictures(volmark):
    scenes = ("marschner_lobb", "nested_ellipsoids")
    pictures = {}
    for isolation, expected in (("run", 6), ("volume", 2)):
        document = host_grid(3, isolation, scenes)
        assert run(volmark, document, "--set", f"volume.generator.dims=[24,24,24]").returncode == 0
        runs = volmark.runs()
        assert len(set(processes(runs))) == expected
        for key, document in runs.items():
            checks = {check["name"]: check["passed"] for check in document["checks"]}
            assert checks["memory_is_returned"] and checks["timed_frame_equals_replay"]
            folder = volmark.results / "scenario" / "runs" / document["run"][:2] / document["run"]
            pictures.setdefault(key, []).append((folder / document["pictures"][0]["file"]).read_bytes())
            assert (folder / "log.txt").is_file()
        volmark.results.rename(volmark.folder / f"results_{isolation}")
    # The run's hash in the file is the same too: isolation is not part of what a run is.
    assert len(pictures) == 6 and all(a == b for a, b in pictures.values())


@pytest.mark.parametrize("fault", ["crash", "throw", "kill", "device_lost"])
def test_a_fault_costs_its_own_run_alone_and_the_worker(volmark, fault):
    document = faults("none", fault)
    document["blocks"][0]["axes"]["pass"] = {"path": "timeline.elevation_degrees", "values": [1, 2, 3]}
    document["set"]["measure"] = {"isolation": "volume", "interleave": 1}
    assert run(volmark, document).returncode == 1
    runs = volmark.runs()
    good = [document for document in runs.values() if document["labels"]["fault"] == "none"]
    bad = [document for document in runs.values() if document["labels"]["fault"] == fault]
    assert [document["status"] for document in good] == ["completed"] * 3
    assert {document["status"] for document in bad} == {"failed" if fault in ("throw", "device_lost") else "crashed"}
    if fault == "device_lost":
        assert "device lost" in bad[0]["reason"]
    assert len(set(processes(volmark.runs()))) > 1


def test_memory_over_the_limit_ends_the_run_with_a_reason(volmark):
    sanitized = "asan" in os.environ["VOLMARK_BUILD"]
    names = ["none", "share"] if sanitized else ["none", "allocate", "share"]
    document = faults(*names, frame_ms=20)
    document["set"]["measure"] = {"memory_limit_gib": 2 if sanitized else 0.75, "time_limit_seconds": 60}
    document["set"]["pacing"]["frames"] = 300
    assert run(volmark, document).returncode == 1
    runs = by_fault(volmark.runs())
    assert runs["none"]["status"] == "completed"
    assert {runs[name]["status"] for name in names[1:]} == {"out_of_memory"}
    # Its own allocations fail at the limit; what only the system counts is seen from outside.
    if not sanitized:
        assert runs["allocate"]["reason"] == "out of host memory"
    assert "over the memory limit of" in runs["share"]["reason"] and "memory_limit_gib" in runs["share"]["reason"]


def test_where_memory_is_too_short_for_all_whole_processes_alternate(volmark):
    document = faults("none")
    document["blocks"] = [{"set": {"technique": {"name": "test_faults", "parameters": {}}}},
                          {"set": {"technique": {"name": "test_host_threads", "parameters": {}}}}]
    document["set"].pop("technique")
    document["set"]["measure"] = {"replicates": 2}
    together = run(volmark, document)
    assert together.returncode == 0
    assert {turn["of"] for document in volmark.runs().values() for turn in document["turns"]} == {2}
    volmark.results.rename(volmark.folder / "together")
    alone = run(volmark, document, "--memory-gib", "0.001")
    assert alone.returncode == 0 and "4 completed" in alone.stdout, alone.stderr
    assert {turn["of"] for document in volmark.runs().values() for turn in document["turns"]} == {1}
    # A B, then B A: what drifts meets both alike.
    order = sorted(volmark.runs().items(), key=lambda item: item[1]["provenance"]["started"])
    first, second, third, fourth = [key[0] for key, _ in order]
    assert (first, second) == (fourth, third) and first != second
    assert not list((volmark.results / "scenario" / "runs").glob("*/*.claim"))
