"""Straight strength line through measured strengths: sigma_1 = q + N sigma_3."""

from dataclasses import dataclass

import numpy as np
from scipy import stats


@dataclass(frozen=True)
class StrengthLine:
    """Least-squares line with its confidence; stresses in the unit of the data.

    q, n : intercept and slope
    q_half, n_half : half-widths of their confidence intervals
    rms : root mean square of the residuals
    left_out_rms : the same for each point predicted from all others, relative to the point
    """

    q: float
    n: float
    q_half: float
    n_half: float
    rms: float
    left_out_rms: float
    confidence: float
    _x_mean: float
    _x_spread: float  # sum of squares about the mean
    _scale: float  # standard error of one point
    _points: int

    @property
    def cohesion(self) -> float:
        """Cohesion c = q / (2 sqrt N), unit of the data."""
        return self.q / (2.0 * np.sqrt(self.n))

    @property
    def friction_deg(self) -> float:
        """Friction angle from N = (1 + sin phi) / (1 - sin phi) [degrees]."""
        return float(np.degrees(np.arcsin((self.n - 1.0) / (self.n + 1.0))))

    def at(self, confinement: np.ndarray) -> np.ndarray:
        """Strength on the line."""
        return self.q + self.n * np.asarray(confinement, dtype=float)

    def half_width(self, confinement: np.ndarray) -> np.ndarray:
        """Half-width of the confidence band of the line (not of single tests)."""
        x = np.asarray(confinement, dtype=float)
        variance = 1.0 / self._points + (x - self._x_mean) ** 2 / self._x_spread
        return _student(self.confidence, self._points) * self._scale * np.sqrt(variance)


def fit_line(
    confinement: np.ndarray, strength: np.ndarray, confidence: float = 0.95
) -> StrengthLine:
    """Fit sigma_1 = q + N sigma_3 by least squares.

    Parameters
    ----------
    confinement, strength : (n,) sigma_3 and sigma_1, compression positive, n >= 3
    confidence : level of the intervals, Student's t with n - 2 degrees of freedom

    Raises
    ------
    ValueError
        With fewer than three points: two always lie on a line and say nothing of its error.
    """
    x, y = np.asarray(confinement, dtype=float), np.asarray(strength, dtype=float)
    if x.size < 3:
        raise ValueError(f"{x.size} points, expected at least 3 to fit a line with its error")
    line = stats.linregress(x, y)
    t = _student(confidence, x.size)
    residual = y - (line.intercept + line.slope * x)
    spread = float(np.sum((x - x.mean()) ** 2))
    leverage = 1.0 / x.size + (x - x.mean()) ** 2 / spread
    left_out = residual / (1.0 - leverage) / y  # exact for least squares, no refit needed
    return StrengthLine(
        q=float(line.intercept),
        n=float(line.slope),
        q_half=float(t * line.intercept_stderr),
        n_half=float(t * line.stderr),
        rms=float(np.sqrt(np.mean(residual**2))),
        left_out_rms=float(np.sqrt(np.mean(left_out**2))),
        confidence=confidence,
        _x_mean=float(x.mean()),
        _x_spread=spread,
        _scale=float(np.sqrt(np.sum(residual**2) / (x.size - 2))),
        _points=x.size,
    )


def _student(confidence: float, points: int) -> float:
    return float(stats.t.ppf(0.5 + 0.5 * confidence, points - 2))
