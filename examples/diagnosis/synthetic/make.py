#!/usr/bin/env python3
"""Makes the synthetic recordings of the examples beside this file: the same bytes every time.

    examples/diagnosis/synthetic/make.py [FOLDER]

The equations are solved by the classic Runge-Kutta method, and share no code with rths. Each system has
one effect that its case.toml omits. Standard library only.
"""
import csv
import math
import pathlib
import random
import sys

HERE = pathlib.Path(__file__).resolve().parent
RECORDS = HERE.parents[1] / "records"
GRAVITY = 9.80665  # [m/s^2]
SUBSTEPS = 8


def solve(rate, state, times):
    """States at the times of x' = rate(t, x)."""
    states = [list(state)]
    for start, end in zip(times, times[1:]):
        h, x = (end - start) / SUBSTEPS, states[-1]
        for part in range(SUBSTEPS):
            t = start + part * h
            k1 = rate(t, x)
            k2 = rate(t + h / 2, [a + h / 2 * b for a, b in zip(x, k1)])
            k3 = rate(t + h / 2, [a + h / 2 * b for a, b in zip(x, k2)])
            k4 = rate(t + h, [a + h * b for a, b in zip(x, k3)])
            x = [a + h / 6 * (p + 2 * q + 2 * r + s) for a, p, q, r, s in zip(x, k1, k2, k3, k4)]
        states.append(x)
    return states


def interpolated(values, step):
    def at(t):
        i = min(int(t / step), len(values) - 2)
        return values[i] + (values[i + 1] - values[i]) * (t / step - i)
    return at


def write(file, header, columns, digits):
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("w", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(header)
        for row in zip(*columns):
            rows.writerow(f"{value:.{digits}g}" for value in row)


def multisine(rng, frequencies, step, count, rest):
    """Sines of equal amplitude and random phase, after a time at rest; their derivative as well."""
    phases = [rng.uniform(0, 2 * math.pi) for _ in frequencies]

    def at(t):
        if t < rest:
            return 0.0
        rise = 1 - math.exp(-(((t - rest) / 1.5) ** 2))
        return rise * sum(math.sin(2 * math.pi * f * t + p) for f, p in zip(frequencies, phases))
    return [at(i * step) for i in range(count)]


def bearing(folder):
    """A lead-rubber bearing whose strength follows its vertical load: Q (1 + 0.3 (N - N0) / N0)."""
    step, count, rest = 0.005, 3600, 2.0
    strength, post, yielding, load = 1.0e6, 4.0e6, 0.003, 9.0e6
    for name, seed in (("fit.csv", 1), ("held_out.csv", 2)):
        rng = random.Random(seed)
        u = [0.04 * x for x in multisine(rng, [rng.uniform(0.2, 1.2) for _ in range(5)], step, count, rest)]
        v = [2e6 * x for x in multisine(rng, [rng.uniform(1, 4) for _ in range(4)], step, count, rest)]
        z, force = 0.0, []
        for i in range(count):
            if i:
                du = (u[i] - u[i - 1]) / 40
                for _ in range(40):  # Bouc-Wen with beta = gamma = 1/2, n = 2; Heun's method
                    def slope(y):
                        return (1 - y * y * (0.5 + (0.5 if y * du > 0 else -0.5))) * du / yielding
                    first = slope(z)
                    z += (first + slope(z + first)) / 2
            force.append(post * u[i] + strength * (1 + 0.3 * v[i] / load) * z + rng.gauss(0, 1e3))
        write(folder / name, ["t [s]", "u [mm]", "F [kN]", "N [kN]"],
              [[i * step for i in range(count)], [1e3 * (x + rng.gauss(0, 2e-6)) for x in u],
               [1e-3 * f for f in force], [1e-3 * (load + x + rng.gauss(0, 1e4)) for x in v]], 7)


def masses(folder):
    """Two masses on springs; the first spring hardens with the cube of its deformation."""
    step, count, rest = 0.01, 2000, 2.0
    m, k, c, cubic = (2.0, 1.5), (4000.0, 3000.0), (6.0, 4.0), 4e5
    for name, seed in (("fit.csv", 3), ("held_out.csv", 4)):
        rng = random.Random(seed)
        push = [9 * x for x in multisine(rng, [rng.uniform(0.5, 10) for _ in range(12)], step, count, rest)]
        at = interpolated(push, step)

        def rate(t, x):
            first = k[0] * x[0] + c[0] * x[2] + cubic * x[0] ** 3
            second = k[1] * (x[1] - x[0]) + c[1] * (x[3] - x[2])
            return [x[2], x[3], (at(t) - first + second) / m[0], -second / m[1]]
        times = [i * step for i in range(count)]
        states = solve(rate, [0.0] * 4, times)
        noise = [rng.gauss(0, 1) for _ in range(2 * count)]
        write(folder / name, ["t [s]", "push [N]", "x1 [mm]", "x2 [mm]"],
              [times, push, [1e3 * s[0] + 0.02 * n for s, n in zip(states, noise)],
               [1e3 * s[1] + 0.02 * n for s, n in zip(states, noise[count:])]], 7)


def program(folder):
    """A mass on a spring, pushed by an actuator whose force saturates at 30 N."""
    step, count, rest = 0.005, 2400, 2.0
    m, k, c, limit = 2.0, 2000.0, 12.0, 30.0
    for name, seed in (("fit.csv", 5), ("held_out.csv", 6)):
        rng = random.Random(seed)
        push = [9 * x for x in multisine(rng, [rng.uniform(0.5, 6) for _ in range(12)], step, count, rest)]
        at = interpolated(push, step)

        def rate(t, x):
            return [x[1], (max(-limit, min(limit, at(t))) - c * x[1] - k * x[0]) / m]
        times = [i * step for i in range(count)]
        states = solve(rate, [0.0] * 2, times)
        write(folder / name, ["t [s]", "push [N]", "x [mm]"],
              [times, push, [1e3 * s[0] + rng.gauss(0, 0.05) for s in states]], 7)


def structure(folder):
    """Three storeys under a recorded earthquake; the cladding of the first one slides with friction."""
    mass, k, friction, slip = 2.0e4, (3.0e7, 2.5e7, 2.0e7), 8.0e3, 2e-4
    c = [2e-3 * stiffness for stiffness in k]
    for name, record, scale in (("fit.csv", "petrolia_1992_riodell_freefield.csv", 0.5),
                                ("held_out.csv", "imperial_valley_1979_meloland_freefield.csv", 0.5)):
        rows = list(csv.DictReader((RECORDS / record).open()))
        own = float(rows[1]["t_s"]) - float(rows[0]["t_s"])
        ground = interpolated([scale * GRAVITY * float(row["h1_g"]) for row in rows], own)
        step, rest = 0.01, 2.0
        count = min(2200, int(round((len(rows) - 2) * own / step + rest / step)))

        def base(t):
            return ground(t - rest) if t >= rest else 0.0
        times = [i * step for i in range(count)]
        sampled = interpolated([base(t) for t in times], step)

        def forces(x):
            drift = [x[0], x[1] - x[0], x[2] - x[1]]
            speed = [x[3], x[4] - x[3], x[5] - x[4]]
            shear = [k[i] * drift[i] + c[i] * speed[i] for i in range(3)]
            shear[0] += friction * x[6]
            return shear

        def rate(t, x):
            shear, a = forces(x), sampled(t)
            slide = (x[3] - x[6] * abs(x[3])) / slip  # Dahl's law
            return [x[3], x[4], x[5], (shear[1] - shear[0]) / mass - a, (shear[2] - shear[1]) / mass - a,
                    -shear[2] / mass - a, slide]
        rng = random.Random(len(name))
        states = solve(rate, [0.0] * 7, times)
        roof = [-forces(x)[2] / mass + rng.gauss(0, 2e-3) for x in states]
        drift = [1e3 * (x[0] + rng.gauss(0, 2e-6)) for x in states]
        write(folder / name, ["t [s]", "ground [m/s2]", "roof [m/s2]", "drift 1 [mm]"],
              [times, [base(t) for t in times], roof, drift], 7)


def main():
    out = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else HERE
    bearing(out / "bearing")
    masses(out / "masses")
    program(out / "program")
    structure(out / "structure")


if __name__ == "__main__":
    main()
