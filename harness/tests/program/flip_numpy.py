"""FLIP a second time, to check the program's: from the papers' formulas in numpy and scipy, with filters that are not
separated and colour matrices from the primaries, so that it shares nothing with harness/image/flip.cpp."""

import numpy
from scipy import ndimage

PIXELS_PER_DEGREE = 0.7 * (3840 / 0.7) * numpy.pi / 180


def _rgb_to_xyz():
    """Rec.709's primaries and D65, scaled so that (1, 1, 1) is white."""
    xy = numpy.array([[0.64, 0.33], [0.30, 0.60], [0.15, 0.06]])
    primaries = numpy.column_stack([xy, 1 - xy.sum(axis=1)]).T
    white = numpy.array([0.3127 / 0.3290, 1, (1 - 0.3127 - 0.3290) / 0.3290])
    return primaries * numpy.linalg.solve(primaries, white), white


TO_XYZ, WHITE = _rgb_to_xyz()


def to_opponent(rgb):
    x, y, z = numpy.moveaxis(rgb @ TO_XYZ.T / WHITE, -1, 0)
    return numpy.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def from_opponent(opponent):
    y = (opponent[..., 0] + 16) / 116
    xyz = numpy.stack([opponent[..., 1] / 500 + y, y, y - opponent[..., 2] / 200], axis=-1) * WHITE
    return xyz @ numpy.linalg.inv(TO_XYZ).T


def to_hunt_lab(rgb):
    t = rgb @ TO_XYZ.T / WHITE
    x, y, z = numpy.moveaxis(numpy.where(t > (6 / 29) ** 3, numpy.cbrt(t), t / (3 * (6 / 29) ** 2) + 4 / 29), -1, 0)
    lightness = 116 * y - 16
    return numpy.stack([lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)], axis=-1)


def hyab(a, b):
    return numpy.abs(a[..., 0] - b[..., 0]) + numpy.linalg.norm(a[..., 1:] - b[..., 1:], axis=-1)


def contrast_filters(ppd):
    """A, RG, BY: sums of a sqrt(pi/b) exp(-pi^2 d^2 / b)."""
    terms = [[(1, 0.0047)], [(1, 0.0053)], [(34.1, 0.04), (13.5, 0.025)]]
    radius = int(numpy.ceil(3 * numpy.sqrt(0.04 / (2 * numpy.pi**2)) * ppd))
    x, y = numpy.meshgrid(*2 * [numpy.arange(-radius, radius + 1) / ppd])
    for parts in terms:
        kernel = sum(a * numpy.sqrt(numpy.pi / b) * numpy.exp(-numpy.pi**2 * (x * x + y * y) / b) for a, b in parts)
        yield kernel / kernel.sum()


def feature_filter(ppd, points):
    deviation = 0.5 * 0.082 * ppd
    radius = int(numpy.ceil(3 * deviation))
    x, y = numpy.meshgrid(*2 * [numpy.arange(-radius, radius + 1)])
    kernel = numpy.exp(-(x * x + y * y) / (2 * deviation**2)) * ((x / deviation) ** 2 - 1 if points else -x)
    return numpy.where(kernel > 0, kernel / kernel[kernel > 0].sum(), kernel / -kernel[kernel < 0].sum())


def correlate(plane, kernel):
    return ndimage.correlate(plane, kernel, mode="nearest")


def feature_strength(plane, kernel):
    return numpy.hypot(correlate(plane, kernel), correlate(plane, kernel.T))


def ldr_flip(picture, reference, ppd=PIXELS_PER_DEGREE):
    """Map of LDR-FLIP; the pictures are linear, in [0, 1], height x width x 3."""
    opponents = [to_opponent(p) for p in (picture, reference)]
    labs = []
    for opponent in opponents:
        planes = [correlate(opponent[..., i], kernel) for i, kernel in enumerate(contrast_filters(ppd))]
        labs.append(to_hunt_lab(numpy.clip(from_opponent(numpy.stack(planes, axis=-1)), 0, 1)))
    largest = hyab(to_hunt_lab(numpy.array([0, 1, 0.0])), to_hunt_lab(numpy.array([0, 0, 1.0]))) ** 0.7
    difference = hyab(*labs) ** 0.7
    knee = 0.4 * largest
    color = numpy.where(difference < knee, 0.95 / knee * difference,
                        0.95 + (difference - knee) / (largest - knee) * 0.05)

    lightness = [(opponent[..., 0] + 16) / 116 for opponent in opponents]
    feature = numpy.zeros_like(color)
    for points in (False, True):
        kernel = feature_filter(ppd, points)
        a, b = (feature_strength(plane, kernel) for plane in lightness)
        feature = numpy.maximum(feature, numpy.abs(a - b))
    return color ** (1 - numpy.sqrt(feature / numpy.sqrt(2)))


def tone_map(linear):
    x = 0.6 * linear
    return numpy.clip((2.51 * x * x + 0.03 * x) / (2.43 * x * x + 0.59 * x + 0.14), 0, 1)


def exposures(reference):
    """Start and stop where 0.85 is reached by the brightest and by the median pixel (of those that are not black, if
    most are); ceil of the stops between, 2 at least."""
    luminance = numpy.sort((numpy.maximum(reference, 0) @ [0.2126, 0.7152, 0.0722]).ravel())
    lit = luminance if luminance[len(luminance) // 2] > 0 else luminance[luminance > 0]
    # 2.51 x^2 + 0.03 x = 0.85 (2.43 x^2 + 0.59 x + 0.14), of the exposed value.
    bright = max(numpy.roots([2.51 - 0.85 * 2.43, 0.03 - 0.85 * 0.59, -0.85 * 0.14]).real) / 0.6
    start, stop = numpy.log2(bright / lit[-1]), numpy.log2(bright / lit[len(lit) // 2])
    return numpy.linspace(start, stop, max(2, int(numpy.ceil(stop - start))))


def hdr_flip(picture, reference, ppd=PIXELS_PER_DEGREE):
    """Map of HDR-FLIP; the pictures are linear."""
    maps = [ldr_flip(*(tone_map(2.0**exposure * numpy.maximum(p, 0)) for p in (picture, reference)), ppd)
            for exposure in exposures(reference)]
    return numpy.max(maps, axis=0)
