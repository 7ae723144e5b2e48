"""Where a strain gauge leaves its straight line: initiation by change of curvature.

The paper reads the initiation of a fracture off "a change in curvature" of the axial stress against
the principal strain of a gauge (Klerck 2004, section 3.3, Fig. 15) and gives no rule. The curve is
straight, bends, and is far from straight later, so two straight lines through the whole of it would
meet somewhere else. The rule here:

1. Only the record up to the largest axial stress counts, without its first part, in which the
   platens settle (`SETTLING`).
2. A window grows from the start by `GROWTH`. In each window one straight line is held against two
   that meet at a breakpoint (continuous, least squares, breakpoint searched). The first window in
   which the two are better by an F-test at `SIGNIFICANCE` and the slope changes by at least
   `CHANGE` of the first slope holds the kink, if the next ones confirm it (`CONFIRMED`).
3. From the best of these the window grows on as long as two straight lines still fit as well as
   they did there (`ADEQUATE`), which makes a sharp kink precise and keeps later bends out.
4. The interval is that of the profile likelihood: breakpoints whose residual sum is within the
   F-quantile of the smallest.

Noise guard: the variance of the residuals is never taken as less than the square of the resolution
of the gauge, and tests and intervals count neighbouring residuals that go together as one (first
autocorrelation), as ringing of the platens and a smooth bend make them. Without a window that
passes there is no kink, which is said rather than guessed.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

SETTLING = 0.01  # of the largest stress, left out at the start
FEWEST = 12  # points of the first window
SIDE = 4  # points at least on either side of a breakpoint
GROWTH = 1.06  # of the window from one to the next
CONFIRMED = 3  # windows in a row that must see the kink; fewer where the record ends
SIGNIFICANCE = 1e-4  # of the F-test; small, because many windows and breakpoints are tried
CHANGE = 0.1  # least change of slope over the first slope
ADEQUATE = 1.2  # most that the variance may grow with the window
CONFIDENCE = 0.95  # of the interval
TRIED = 60  # breakpoints tried in a window before the best is refined


@dataclass(frozen=True)
class Kink:
    """A change of slope of strain against stress; stress in the unit given.

    Attributes
    ----------
    stress : at the breakpoint
    low, high : interval of the breakpoint at `CONFIDENCE`
    slope_before, slope_after : strain over stress
    strain : on the lines at the breakpoint
    window : stress at the end of the window that was fitted
    last : row of the curve at which the window ends
    """

    stress: float
    low: float
    high: float
    slope_before: float
    slope_after: float
    strain: float
    window: float
    last: int


def find_kink(stress: np.ndarray, strain: np.ndarray, resolution: float = 0.0) -> Kink | None:
    """First change of slope of a curve, or None when it has none that noise cannot explain.

    Parameters
    ----------
    stress, strain : (n,) in order of loading; stress rises, but may ripple
    resolution : smallest strain that the gauge tells apart, a lower bound of the noise

    Raises
    ------
    ValueError
        When the lengths differ.
    """
    stress, strain = np.asarray(stress, dtype=float), np.asarray(strain, dtype=float)
    if stress.shape != strain.shape:
        raise ValueError(f"{stress.size} stresses and {strain.size} strains, expected as many")
    first, end = _loading(stress)
    x, y = stress[first:end], strain[first:end]
    ends = _window_ends(x.size)
    seen: list[_Fit] = []
    for number, n in enumerate(ends):
        fit = _two_lines(x[:n], y[:n])
        if fit is None or not _stands_out(fit, resolution):
            seen = []
            continue
        seen.append(fit)
        if len(seen) == CONFIRMED or n == x.size:
            best = min(range(len(seen)), key=lambda i: seen[i].variance(resolution))
            later = ends[number - len(seen) + 2 + best :]
            return _refined(x, y, later, seen[best], resolution, first)
    return None


def _window_ends(points: int) -> list[int]:
    """Sizes of the growing window, the last that of the record."""
    ends = [FEWEST]
    while ends[-1] < points:
        ends.append(min(max(ends[-1] + 1, int(GROWTH * ends[-1])), points))
    return ends if points >= FEWEST else []


def _loading(stress: np.ndarray) -> tuple[int, int]:
    """First and one past the last row that count: after settling, up to the largest stress."""
    if stress.size == 0:
        return 0, 0
    end = int(np.argmax(stress)) + 1
    below = np.flatnonzero(stress[:end] < SETTLING * stress[end - 1])
    return (int(below[-1]) + 1 if below.size else 0), end


@dataclass(frozen=True)
class _Fit:
    """Two lines through a window: y = a + b x + c max(x - breakpoint, 0)."""

    x: np.ndarray
    y: np.ndarray
    at: float  # breakpoint
    rss: float  # residual sum of squares
    rss_one: float  # that of a single line
    coefficients: np.ndarray  # a, b, c

    @property
    def freedom(self) -> int:
        """Points less parameters."""
        return self.x.size - 4

    def residuals(self) -> np.ndarray:
        """Strain less that of the two lines, (n,)."""
        a, b, c = self.coefficients
        return self.y - (a + b * self.x + c * np.maximum(self.x - self.at, 0.0))

    def variance(self, resolution: float) -> float:
        """Of one point about the lines, at least that of the gauge."""
        return max(self.rss / self.freedom, resolution**2, np.finfo(float).tiny)

    def clustering(self) -> float:
        """Points that count as one, (1 + r) / (1 - r) of the first autocorrelation, 1 or more."""
        r = self.residuals()
        size = float(r @ r)
        together = float(r[1:] @ r[:-1]) / size if size > 0.0 else 0.0
        together = min(max(together, 0.0), 1.0 - 1.0 / self.x.size)
        return (1.0 + together) / (1.0 - together)


def _two_lines(x: np.ndarray, y: np.ndarray) -> _Fit | None:
    """Best two lines; None where no breakpoint leaves `SIDE` different points on either side."""
    ordered = np.unique(x)
    if ordered.size < 2 * SIDE + 1:
        return None
    tried = ordered[SIDE - 1 : ordered.size - SIDE + 1]
    tried = np.unique(np.append(tried[:: max(1, tried.size // TRIED)], tried[-1]))
    rss_one, rss = _residual_sums(x, y, tried)
    for _ in range(2):
        best = int(np.argmin(rss))
        tried = np.linspace(
            *tried[[max(best - 1, 0), min(best + 1, tried.size - 1)]], 2 * TRIED + 1
        )
        _, rss = _residual_sums(x, y, tried)
    at = float(tried[int(np.argmin(rss))])
    columns = np.column_stack([np.ones_like(x), x, np.maximum(x - at, 0.0)])
    coefficients = np.linalg.lstsq(columns, y, rcond=None)[0]
    residual = y - columns @ coefficients
    return _Fit(x, y, at, float(residual @ residual), rss_one, coefficients)


def _residual_sums(x: np.ndarray, y: np.ndarray, tried: np.ndarray) -> tuple[float, np.ndarray]:
    """Residual sum of one line, and of two lines for each breakpoint tried, (k,).

    What the second line takes away is its part of the residual of the first (Frisch, Waugh). All
    sums over the points beyond a breakpoint are read off running sums.
    """
    order = np.argsort(x, kind="stable")
    middle, spread = x.mean(), np.ptp(x)
    u, v = (x[order] - middle) / spread, y[order]
    basis = np.linalg.qr(np.column_stack([np.ones_like(u), u]))[0]
    left = v - basis @ (basis.T @ v)
    one = float(left @ left)
    columns = np.column_stack([basis, left, np.ones_like(u), u])
    beyond = np.searchsorted(x[order], tried, side="right")
    c = (tried - middle) / spread
    plain, with_u = (_sums_from(part)[beyond] for part in (columns, u[:, None] * columns))
    products = with_u - c[:, None] * plain  # of the hinge (u - c)+ with every column
    size = products[:, 4] - c * products[:, 3] - (products[:, :2] ** 2).sum(axis=1)
    useful = size > 1e-12
    taken = np.where(useful, products[:, 2] ** 2 / np.where(useful, size, 1.0), 0.0)
    return one, one - np.minimum(taken, one)


def _sums_from(columns: np.ndarray) -> np.ndarray:
    """Sums of the rows from each row on, and of none, (n + 1, k)."""
    sums = np.zeros((len(columns) + 1, columns.shape[1]))
    sums[:-1] = np.cumsum(columns[::-1], axis=0)[::-1]
    return sums


def _stands_out(fit: _Fit, resolution: float) -> bool:
    """Whether noise cannot explain the second line, and its slope differs enough."""
    before, change = abs(fit.coefficients[1]), abs(fit.coefficients[2])
    if change < CHANGE * before or change == 0.0:
        return False
    if fit.rss_one < fit.freedom * resolution**2:
        return False
    ratio = (fit.rss_one - fit.rss) / 2.0 / fit.variance(resolution) / fit.clustering()
    return bool(stats.f.sf(ratio, 2, fit.freedom) < SIGNIFICANCE)


def _refined(
    x: np.ndarray, y: np.ndarray, ends: list[int], fit: _Fit, resolution: float, first: int
) -> Kink:
    """Let the window grow while two lines are adequate, then measure the breakpoint."""
    noise = fit.variance(resolution)
    for n in ends:
        wider = _two_lines(x[:n], y[:n])
        if wider.variance(resolution) > ADEQUATE * noise:
            break
        fit = wider
    low, high = _interval(fit, resolution)
    a, before, change = fit.coefficients
    return Kink(
        fit.at, low, high, float(before), float(before + change), float(a + before * fit.at),
        float(fit.x[-1]), first + fit.x.size - 1,
    )  # fmt: skip


def _interval(fit: _Fit, resolution: float) -> tuple[float, float]:
    """Breakpoints that fit about as well as the best one."""
    ordered = np.unique(fit.x)
    quantile = stats.f.ppf(CONFIDENCE, 1, fit.freedom)
    allowed = fit.rss + quantile * fit.variance(resolution) * fit.clustering()
    ends = []
    for end in (ordered[SIDE - 1], ordered[-SIDE]):
        # Two passes: the whole side, then the cell in which the sum first is small enough.
        near, far = fit.at, float(end)
        for _ in range(2):
            tried = np.linspace(near, far, 4 * TRIED)
            rss = _residual_sums(fit.x, fit.y, tried)[1]
            inside = np.flatnonzero(rss <= allowed)
            last = int(inside[-1]) if inside.size else 0
            near, far = float(tried[last]), float(tried[min(last + 1, tried.size - 1)])
        ends.append(near)
    return ends[0], ends[1]
