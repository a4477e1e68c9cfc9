"""What a reader should know first: what was faster, at what error, what failed, what to distrust."""

from __future__ import annotations

from .columns import ABSENT, DAGGER, error_text, number_text
from .comparisons import Comparison, verdict
from .load import Experiment
from .plots import Panel, panels_of
from .points import PointResult, label_text, varying_axes
from .statistics import POSES_FOR_LOW1

_STAMPS_LIMIT = 1.03
_MOST_PAIRS = 6
_MOST_PANELS = 4


def findings(results: list[PointResult], comparisons: list[Comparison]) -> tuple[list[str], list[str]]:
    """Plain sentences: what to read first, and what to fold away if there are many scenes."""
    done = [r for r in results if r.completed]
    if not done:
        return ["No run completed: there is nothing to compare."], []
    first = _technique_findings(comparisons)
    panels = panels_of(results)
    by_panel = [_extremes(panel, len(panels) > 1) for panel in panels]
    if len(panels) <= _MOST_PANELS:
        return first + by_panel, []
    return (first, by_panel) if first else (by_panel[:_MOST_PANELS], by_panel[_MOST_PANELS:])


def _technique_findings(comparisons: list[Comparison]) -> list[str]:
    pairs: dict[tuple[str, str], list[Comparison]] = {}
    for c in comparisons:
        key = tuple(sorted((c.a.technique, c.b.technique)))
        pairs.setdefault(key, []).append(c)
    if len(pairs) > _MOST_PAIRS:  # only those with the technique that wins most often
        wins = [(c.a if c.ratio.median < 1 else c.b).technique for c in comparisons]
        best = max(dict.fromkeys(wins), key=wins.count)
        pairs = {key: members for key, members in pairs.items() if best in key}
    return [_pair_finding(key, members) for key, members in pairs.items()]


def _pair_finding(key: tuple[str, str], members: list[Comparison]) -> str:
    if len(members) == 1:
        where = f" ({members[0].where})" if members[0].where else ""
        return f"{verdict(members[0])}{where}."
    # Times of the first name over those of the second.
    ratios = [c.ratio if c.a.technique == key[0] else c.ratio.inverse() for c in members]
    sides = {name: [c.a if c.a.technique == name else c.b for c in members] for name in key}
    faster = {key[0]: sum(r.median < 1 and (r.clear or not r.paired) for r in ratios),
              key[1]: sum(r.median > 1 and (r.clear or not r.paired) for r in ratios)}
    first, second = sorted(key, key=lambda name: -faster[name])
    if faster[first] == 0:
        return f"{first} and {second}: no clear difference in {len(members)} comparisons."
    speedups = [1 / r.median if first == key[0] else r.median for r in ratios]
    won = [s for s, r in zip(speedups, ratios) if s > 1 and (r.clear or not r.paired)]
    count = f"all {len(members)}" if faster[first] == len(members) else f"{faster[first]} of {len(members)}"
    text = (f"{first} was faster than {second} in {count} comparisons, by {_times(won)} (median over poses); lowest PSNR "
            f"{_errors(sides[first])} against {_errors(sides[second])}")
    if faster[second]:
        text += f"; {second} was faster in {faster[second]}"
    draws = {name: sides[name][0].any_run.technique.get("draws") for name in key}
    if len(set(draws.values())) > 1:
        text += f". They draw different things ({draws[first]}, {draws[second]}): each error is against its own reference"
    return text + "."


def _times(values: list[float]) -> str:
    low, high = number_text(min(values)), number_text(max(values))
    return f"{low}×" if low == high else f"{low}× to {high}×"


def _errors(results: list[PointResult]) -> str:
    texts = list(dict.fromkeys(error_text(r) for r in sorted(results, key=lambda r: r.errors.get("psnr_db", 1e9))))
    return texts[0] if len(texts) == 1 else f"{texts[0]} to {texts[-1]}"


def _extremes(panel: Panel, named: bool) -> str:
    fastest = min(panel.results, key=lambda r: r.statistics["mean_ms"])
    if len(panel.results) == 1:
        return f"{panel.title}: {label_text(fastest, panel.axes)} took {_time_and_error(fastest)}."
    where = f"{panel.title}: fastest" if named else "Fastest"
    text = f"{where} is {label_text(fastest, panel.axes)}, {_time_and_error(fastest)}"
    measured = [r for r in panel.results if r.errors]
    if not measured:
        return text + "."
    best = max(measured, key=lambda r: (bool(r.errors.get("identical")), r.errors.get("psnr_db", 0.0)))
    if best is fastest:
        return text + "; it is also the closest to its reference."
    return text + f"; closest to its reference is {label_text(best, panel.axes)}, {_time_and_error(best)}."


def _time_and_error(r: PointResult) -> str:
    text = f"{number_text(r.statistics['mean_ms'])} ms ({number_text(r.statistics['fps'])} fps)"
    return f"{text} at {error_text(r)}" if r.errors else text


def failures(results: list[PointResult]) -> list[str]:
    """Points without a result, then single runs that failed beside others that did not."""
    axes = varying_axes(results)
    sentences = [f"{label_text(r, axes)}: {r.status.replace('_', ' ')} {ABSENT} {r.reason}" for r in results
                 if not r.completed]
    for r in results:
        if r.completed and r.others:
            sentences.append(f"{label_text(r, axes)}: {len(r.others)} of {len(r.others) + len(r.completed)} processes "
                             f"{r.others[0].status.replace('_', ' ')} {ABSENT} {r.reason}")
    return sentences


def warnings(experiment: Experiment, results: list[PointResult]) -> list[str]:
    """What makes a number doubtful."""
    axes = varying_axes(results)
    done = [r for r in results if r.completed]
    found = []
    for r in results:
        for check in r.failed_checks:
            detail = f": {check['detail']}" if check.get("detail") else ""
            found.append(f"Check failed, {label_text(r, axes)}: {check.get('name', 'unnamed').replace('_', ' ')}{detail}.")
    few = [r for r in done if r.insufficient_frames]
    if few:
        found.append(f"{_points(few, done)} fewer than {POSES_FOR_LOW1} distinct poses (insufficient_frames): "
                     f"the 1 % low is marked {DAGGER}.")
    slowed = [r for r in done if (r.stamps_ratio or 0) > _STAMPS_LIMIT]
    if slowed:
        worst = max(slowed, key=lambda r: r.stamps_ratio)
        found.append(f"Stamping every pass slowed frames by more than {100 * (_STAMPS_LIMIT - 1):.0f} % at {len(slowed)} of "
                     f"{len(done)} points (worst: {label_text(worst, axes)}, stamps_ratio {worst.stamps_ratio:.3f}): "
                     f"read their times by pass as shares.")
    disturbed = [r for r in done if r.disturbed_frames]
    if disturbed:
        worst = max(disturbed, key=lambda r: r.disturbed_frames / r.statistics["count"])
        total, frames = sum(r.disturbed_frames for r in done), sum(r.statistics["count"] for r in done)
        found.append(f"{total} of {frames} frames were disturbed by other work on the machine (worst: "
                     f"{label_text(worst, axes)}, {worst.disturbed_frames} of {worst.statistics['count']}); none is dropped.")
    unmeasured = [r for r in done if not r.errors]
    if unmeasured:
        found.append(f"{_points(unmeasured, done)} no reference: their error is not measured.")
    visible = list(dict.fromkeys(r.technique for r in done if r.history == "visible"))
    if visible:
        found.append(f"{', '.join(visible)}: pictures depend on earlier frames (history visible); they are shown with the "
                     f"time spent since the history was empty.")
    if experiment.unfinished:
        found.append(f"{len(experiment.unfinished)} run folder(s) without a finished run.json: still running, or stopped.")
    if experiment.damaged:
        more = f" (and {len(experiment.damaged) - 1} more)" if len(experiment.damaged) > 1 else ""
        found.append(f"{len(experiment.damaged)} run(s) with damaged files are left out; remove their folders and run the "
                     f"scenario again: {experiment.damaged[0]}{more}.")
    stale = len(experiment.runs) - len(experiment.current_runs)
    if stale:
        found.append(f"{stale} runs of points that the scenario no longer has are left out.")
    if any("point" in r.labels for r in results):
        found.append("Some points were run with different settings under the same labels: see the label “point”.")
    return found


def _points(some: list[PointResult], done: list[PointResult]) -> str:
    if len(some) == len(done):
        return "All points have" if len(done) > 1 else "The point has"
    return f"{len(some)} of {len(done)} points have"
