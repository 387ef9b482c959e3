# SPDX-License-Identifier: Apache-2.0
"""Statistics of small counts: confidence intervals and quantiles."""
import math

Z95 = 1.959963984540054  # two-sided 95 % of a normal distribution
Z90 = 1.6448536269514722


def wilson(right, of, z=Z95):
    """Interval of a proportion (Wilson 1927), of 95 % or another quantile of the normal distribution."""
    if of == 0:
        return 0.0, 1.0
    share, square = right / of, z * z
    middle = (share + square / (2 * of)) / (1 + square / of)
    half = z / (1 + square / of) * math.sqrt(share * (1 - share) / of + square / (4 * of * of))
    return max(0.0, middle - half), min(1.0, middle + half)


def quantile(values, share):
    """Linear between order statistics."""
    ordered = sorted(values)
    position = share * (len(ordered) - 1)
    low = int(position)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (position - low) * (ordered[high] - ordered[low])


def median(values):
    return quantile(values, 0.5)
