"""The paper's claims one by one: held, not held or not decidable, each with what was measured and what was published."""

from __future__ import annotations

from typing import Callable

from ...columns import number_text
from ..claims import Case, Claim
from ..evidence import NOT_MEASURED, UNDECIDED, Quantity, above, at_least, at_most, most_of, quotient, within
from ..measurements import Measurements
from . import published
from .published import MARCHING, MESH, OURS
from .sources import (STILL, VIEWS, Source, Sources, figure6_of, in_part, is_software, isovalue_parts, megapixels, part_text, ratio,
                      ratio_of_methods, size_of, size_text, sizes_of, sweep_of)

HARDLY = 0.25
"""Draw times that are "hardly influenced" by the resolution grow at most with this power of the number of pixels: of 16 times the
pixels, by no more than 2."""
SIMILAR = 1.25
"""Two methods are at a "similar level" if neither is faster by more than this factor."""
TWICE = (1.8, 2.2)
RATIOS = "widest bounds of the two ratios"
SOFTWARE = "the device is a CPU: it rasterizes in software, without the fixed-function units that the claim rests on"

Judge = Callable[[Quantity], str]
Choice = Callable[[Measurements], Quantity | None]


def claims_of(sources: Sources) -> list[Claim]:
    return [*[claim for view in VIEWS for claim in _about_resolution(sources, view)],
            published_speed_ups(sources), crossing(sources), published_mesh_gains(sources), *_about_time_steps(sources["fig7a"]),
            level_of_marching(sources["fig7b"]), *_about_stereo(sources["fig8"])]


def _about_resolution(sources: Sources, view: str) -> list[Claim]:
    figure6 = {dataset: figure6_of(sources, dataset, view) for dataset in published.STATIC}
    return [faster_when_large(figure6, view), faster_at_most(figure6, view), small_volumes(figure6, view), gains_with_size(figure6, view),
            hardly_influenced(figure6, view), mesh_is_faster(figure6, view)]


# Cells --------------------------------------------------------------------------------------------------------


def quantity_case(where: str, paper: str, source: Source, choose: Choice, judge: Judge, rasterizes: bool = True) -> Case:
    """`choose` finds the quantity in either of the source's measures. `rasterizes`: whether the claim is about a method that does."""
    case = Case(where, paper)
    draw, frame = choose(source.draw), choose(source.frame)
    if draw is None or frame is None:
        return case
    case.measured, case.verdict = _bounded_text(draw), judge(draw)
    case.other, case.other_verdict = _bounded_text(frame), judge(frame)
    case.numbers = _numbers(draw, "") | _numbers(frame, "other_")
    if rasterizes and is_software(source.draw):
        case.reason = SOFTWARE
    return case


def _bounded_text(quantity: Quantity) -> str:
    return quantity.text if quantity.low is not None else f"{quantity.text}, without bounds"


def _numbers(quantity: Quantity, prefix: str) -> dict:
    return {f"{prefix}value": quantity.value, f"{prefix}low": quantity.low, f"{prefix}high": quantity.high, f"{prefix}bounds": quantity.kind}


def only_at_full_size(case: Case, size: tuple[int, int] | None) -> Case:
    """A published number is of one size: at another one nothing is decided by it."""
    if case.verdict != NOT_MEASURED and size != published.FULL_SIZE:
        case.verdict = case.other_verdict = UNDECIDED
        case.reason = "; ".join(filter(None, [f"measured at {size_text(size)}, published for {size_text(published.FULL_SIZE)}", case.reason]))
    return case


def _methods(a: str, b: str, **labels: str) -> Choice:
    return lambda m: ratio_of_methods(m, a, b, **labels)


def _at_every_size(dataset: str, source: Source, a: str, b: str, judge: Judge) -> list[Case]:
    sizes = sizes_of(source.draw)
    return [quantity_case(f"{dataset}, {size_text(size)}: {a} / {b}", "above 1", source, _methods(a, b, resolution=label), judge)
            for label, size in sizes.items()] or [Case(f"{dataset}: {a} / {b}", "above 1")]


def _largest(source: Source) -> tuple[str, tuple[int, int] | None]:
    """Label and size."""
    return list(sizes_of(source.draw).items() or [("", None)])[-1]


def _at_largest(dataset: str, source: Source, a: str, b: str, paper: str, judge: Judge) -> Case:
    label, size = _largest(source)
    where = f"{dataset}, {size_text(size)}" if size else dataset
    return quantity_case(f"{where}: {a} / {b}", paper, source, _methods(a, b, resolution=label), judge)


def _faster(quantity: Quantity) -> str:
    return above(quantity, 1.0)


def _gain(published_gain: float) -> Judge:
    return lambda q: at_least(q, published_gain)


# Resolution ---------------------------------------------------------------------------------------------------


def _view_text(view: str) -> str:
    return f"({view} view)" if view == STILL else "(on an orbit)"


def faster_when_large(figure6: dict[str, Source], view: str) -> Claim:
    cases = [_at_largest(d, source, MARCHING, OURS, number_text(published.SPEED_UP[d]), _faster) for d, source in figure6.items()]
    return Claim(f"Direct rasterization is faster than octree ray marching at the highest resolution {_view_text(view)}.", "4.1.1, figure 6",
                 cases, in_other=False, note="At the highest resolution that was measured, which the cell names.")


def faster_at_most(figure6: dict[str, Source], view: str) -> Claim:
    cases = [case for d, source in figure6.items() for case in _at_every_size(d, source, MARCHING, OURS, _faster)]
    return Claim(f"Direct rasterization outperforms octree ray marching at most of the resolutions {_view_text(view)}.", "4.1.1", cases,
                 most_of, in_other=False)


def small_volumes(figure6: dict[str, Source], view: str) -> Claim:
    cases = [case for d in ("CT head", "vertebra") for case in _at_every_size(d, figure6[d], MARCHING, OURS, _faster)]
    return Claim(f"On the CT head and the vertebra direct rasterization is faster even at the lowest resolutions {_view_text(view)}.", "figure 6",
                 cases, in_other=False)


def gains_with_size(figure6: dict[str, Source], view: str) -> Claim:
    cases = [_by_size(d, source, _change_of_gain, "grows", lambda _: _faster) for d, source in figure6.items()]
    return Claim(f"The speed-up of direct rasterization over octree ray marching grows with the resolution {_view_text(view)}.", "1, 4.1.1",
                 cases, in_other=False, note="Speed-up at the highest resolution over that at the lowest one.")


def _change_of_gain(measurements: Measurements, low: str, high: str) -> Quantity | None:
    gains = [ratio_of_methods(measurements, MARCHING, OURS, resolution=label) for label in (high, low)]
    return None if None in gains else quotient(*gains, RATIOS)


def hardly_influenced(figure6: dict[str, Source], view: str) -> Claim:
    def growth(method):
        return lambda m, low, high: ratio(m, {"resolution": high, "method": method}, {"resolution": low, "method": method})

    def judge(pixels):
        return lambda q: at_most(q, pixels**HARDLY)

    cases = [_by_size(f"{d}, {method}", source, growth(method), "hardly influenced", judge)
             for d, source in figure6.items() for method in (OURS, MESH)]
    return Claim(f"Direct rasterization, like the mesh, is hardly influenced by the resolution {_view_text(view)}.", "4.1.1", cases,
                 in_other=False, note=f"Draw time at the highest resolution over that at the lowest one. The paper names no limit; here it "
                                      f"is the number of pixels to the power of {HARDLY}.")


def _by_size(where: str, source: Source, choose, paper: str, judge_of: Callable[[float], Judge]) -> Case:
    """Of the lowest and the highest resolution; `judge_of` is told how many times the pixels the highest one has."""
    sizes = list(sizes_of(source.draw).items())
    if len(sizes) < 2:
        return Case(where, paper)
    (low, small), (high, large) = sizes[0], sizes[-1]
    return quantity_case(f"{where}: {size_text(large)} / {size_text(small)}", paper, source, lambda m: choose(m, low, high),
                         judge_of(megapixels(large) / megapixels(small)))


def mesh_is_faster(figure6: dict[str, Source], view: str) -> Claim:
    cases = [case for d, source in figure6.items() for case in _at_every_size(d, source, OURS, MESH, _faster)]
    return Claim(f"The reference mesh always outperforms direct rasterization {_view_text(view)}.", "4.1.1", cases, in_other=False,
                 note="Extracting the mesh takes no time here, as in the paper.")


# Published numbers --------------------------------------------------------------------------------------------


def published_speed_ups(sources: Sources) -> Claim:
    cases = []
    for dataset in published.STATIC:
        source, gain = figure6_of(sources, dataset, STILL), published.SPEED_UP[dataset]
        case = _at_largest(dataset, source, MARCHING, OURS, f"{gain} (Figure 1: {published.speed_up_of_figure1(dataset):.2f})", _gain(gain))
        cases.append(only_at_full_size(case, _largest(source)[1]))
    gains = ", ".join(f"{published.SPEED_UP[d]} ({d})" for d in published.STATIC)
    return Claim(f"At {size_text(published.FULL_SIZE)} direct rasterization is faster than octree ray marching by these factors: {gains}.", "4.1.1",
                 cases, in_other=False, note="Held: at least the published speed-up of the text. A smaller one is not held, though it may be one.")


def crossing(sources: Sources) -> Claim:
    """On each side of the published crossing there has to be a resolution."""
    source, limit = figure6_of(sources, "chameleon", STILL), published.CROSSING_MEGAPIXELS
    cases = []
    for side, judge, paper in (("below", lambda q: above(_inverse(q), 1.0), "below 1"), ("from", _faster, "above 1")):
        sizes = {label: size for label, size in sizes_of(source.draw).items() if (megapixels(size) < limit) == (side == "below")}
        cases += [quantity_case(f"chameleon, {size_text(size)} ({megapixels(size):.2g} megapixels): {MARCHING} / {OURS}", paper, source,
                                _methods(MARCHING, OURS, resolution=label), judge) for label, size in sizes.items()]
        if not sizes:
            cases.append(Case(f"chameleon, {side} {limit:g} megapixels: {MARCHING} / {OURS}", paper))
    return Claim(f"On the chameleon octree ray marching is faster below {limit:g} megapixels, direct rasterization from there on.", "figure 6 (c)",
                 cases, in_other=False)


def _inverse(quantity: Quantity) -> Quantity:
    if quantity.low is None:
        return Quantity(1 / quantity.value)
    return Quantity(1 / quantity.value, 1 / quantity.high, 1 / quantity.low, quantity.kind)


def published_mesh_gains(sources: Sources) -> Claim:
    low, high = published.MESH_GAINS
    every = {d: figure6_of(sources, d, STILL) for d in published.STATIC} | {published.SUPERNOVA: sources["fig7a"]}
    cases = [_at_largest(d, source, OURS, MESH, number_text(published.MESH_GAIN[d]), lambda q: within(q, low, high))
             for d, source in every.items()]
    return Claim(f"The reference mesh is {low:g} to {high:g} times as fast as direct rasterization on all volumes.", "4.1.1, figure 6", cases,
                 in_other=False, note="At the highest resolution that was measured. Held: within the range that the paper gives for all volumes.")


# Time steps and isovalues -------------------------------------------------------------------------------------


def _about_time_steps(source: Source) -> list[Claim]:
    gain = published.SPEED_UP[published.SUPERNOVA]
    most = Claim("With a new time step in every frame direct rasterization outperforms octree ray marching at almost all resolutions.", "4.1.2",
                 _at_every_size(published.SUPERNOVA, source, MARCHING, OURS, _faster), most_of, note="Judged as most of them.")
    case = _at_largest(published.SUPERNOVA, source, MARCHING, OURS,
                       f"{gain} (Figure 1: {published.speed_up_of_figure1(published.SUPERNOVA):.2f})", _gain(gain))
    best = Claim(f"The speed-up on time steps is {gain} at {size_text(published.FULL_SIZE)}.", "4.1.2, figure 7 (a)",
                 [only_at_full_size(case, _largest(source)[1])], note="Held: at least the published speed-up.")
    mesh = Claim("The reference mesh outperforms direct rasterization on time steps, too.", "4.1.1",
                 _at_every_size(published.SUPERNOVA, source, OURS, MESH, _faster),
                 note="The claim is about draw times. In the frame times the mesh is extracted anew for every time step.")
    return [most, best, mesh]


def level_of_marching(source: Source) -> Claim:
    before, around, _ = map(part_text, isovalue_parts(sweep_of(source.draw)))

    def gain(m: Measurements, part: int) -> Quantity | None:
        return ratio_of_methods(in_part(m, part), MARCHING, OURS) if m.results else None

    def fall(m: Measurements) -> Quantity | None:
        gains = gain(m, 0), gain(m, 1)
        return None if None in gains else quotient(*gains, RATIOS)

    cases = [quantity_case(f"isovalues {around}: {MARCHING} / {OURS}", "about 1", source, lambda m: gain(m, 1),
                           lambda q: within(q, 1 / SIMILAR, SIMILAR)),
             quantity_case(f"speed-up at isovalues {before} / at {around}", "above 1", source, fall, _faster)]
    return Claim(f"Around the isovalue {published.LEVEL_AT:g} of the chameleon direct rasterization falls to about the level of octree ray marching.",
                 "4.1.2, figure 7 (b)", cases,
                 note=f"About the level: neither is faster by more than a factor of {SIMILAR}, which is not the paper's number. The paper's times "
                      f"are draw times at {size_text(published.FULL_SIZE)}.")


# Stereo -------------------------------------------------------------------------------------------------------


def _about_stereo(source: Source) -> list[Claim]:
    return [stereo_costs_less(source), *[stereo_overhead(source, method) for method in (OURS, MESH)], marching_takes_twice(source)]


def stereo_factor(measurements: Measurements, dataset: str, method: str) -> Quantity | None:
    """Time of two views over that of one."""
    mine = {"dataset": dataset, "method": method}
    return ratio(measurements, mine | {"views": "stereo"}, mine | {"views": "mono"})


def _factor_case(source: Source, dataset: str, method: str, paper: str, judge: Judge) -> Case:
    return quantity_case(f"{dataset}, {method}: stereo / mono", paper, source, lambda m: stereo_factor(m, dataset, method), judge,
                         rasterizes=method != MARCHING)


def stereo_costs_less(source: Source) -> Claim:
    def compared(dataset):
        def choose(m):
            factors = stereo_factor(m, dataset, MARCHING), stereo_factor(m, dataset, OURS)
            return None if None in factors else quotient(*factors, RATIOS)
        return choose

    cases = [quantity_case(f"{d}: stereo / mono of {MARCHING}, over that of {OURS}", "above 1", source, compared(d), _faster)
             for d in published.DATASETS]
    return Claim("A second view costs direct rasterization less than octree ray marching.", "4.1.3, figure 8", cases, in_other=False)


def stereo_overhead(source: Source, method: str) -> Claim:
    low, high = (1 + overhead for overhead in published.STEREO_OVERHEAD[method])
    size = next((size_of(r) for r in source.draw.results if r.any_run is not None), None)
    cases = [only_at_full_size(_factor_case(source, d, method, f"{low:.3f} to {high:.3f}", lambda q: within(q, low, high)), size)
             for d in published.DATASETS]
    return Claim(f"A second view costs {method} {100 * (low - 1):.1f} to {100 * (high - 1):.1f} % of the first one.", "figure 8", cases,
                 in_other=False)


def marching_takes_twice(source: Source) -> Claim:
    cases = [_factor_case(source, d, MARCHING, f"{1 + published.STEREO_OVERHEAD_OF_MARCHING:g}", lambda q: within(q, *TWICE))
             for d in published.DATASETS]
    return Claim("Two views take octree ray marching about twice the time of one.", "4.1.3, figure 8", cases, in_other=False,
                 note=f"About: {TWICE[0]:g} to {TWICE[1]:g}, which are not the paper's numbers.")
