#!/usr/bin/env python3
"""True times of flight for the tests of src/simulation/flight: python3 tests/data/flight_reference.py

Writes flight-lines.csv, flight-pairs.csv and flight-accelerated.csv beside itself (needs mpmath). The inputs are f64,
written so that they read back exactly; the times are the roots for exactly these inputs, found with 60 digits from all
complex roots of the polynomial, and rounded to f64. `inf` is never; an empty field is not asked.

The condition of a time, s, says how far it moves per relative change of the terms that make up the gap (distance,
velocity x time, half the acceleration x time squared, reach), taken over a change of WIDTH roundings: where it grazes,
the root goes with the square root of the change. Where such a change decides whether they touch at all, `sure` is `no`,
the time is that of the closest approach, and never is right as well.
"""

import csv
import random
from pathlib import Path

from mpmath import mp, mpf, polyroots, sqrt

mp.dps = 60
INF = mpf("inf")
EPSILON = mpf(2) ** -52
WIDTH = 8
RANDOM = random.Random(1877)


def roots(coefficients):
    """The real roots of a polynomial, highest power first, in rising order."""
    while coefficients and coefficients[0] == 0:
        coefficients = coefficients[1:]
    if len(coefficients) < 2:
        return []
    if len(coefficients) == 3:
        with mp.workdps(500):  # so that the smallest gap beside the largest speed leaves digits enough
            a, b, c = coefficients
            square = b * b - 4 * a * c
            return [] if square < 0 else sorted((-b + sign * sqrt(square)) / (2 * a) for sign in (-1, 1))
    found = polyroots(coefficients, maxsteps=1000, extraprec=600)
    return sorted(root.real for root in found if abs(root.imag) <= abs(root) * mpf(10) ** -40)


def value(coefficients, time):
    total = mpf(0)
    for coefficient in coefficients:
        total = total * time + coefficient
    return total


def derivative(coefficients):
    degree = len(coefficients) - 1
    return [coefficient * (degree - index) for index, coefficient in enumerate(coefficients[:-1])]


class Gap:
    """A gap as a polynomial in time that is negative behind the line or in the other disc."""

    def moved(self, change):
        """The coefficients where the gap is less by `change`, px."""
        raise NotImplementedError

    def size(self, time):
        """The sum of the sizes of the terms of the gap, px."""
        raise NotImplementedError

    def crossings(self, sign, change=mpf(0)):
        """The times from 0 on when the gap closes (sign -1) or opens (sign 1)."""
        polynomial = self.moved(change)
        slope = derivative(polynomial)
        return [t for t in roots(polynomial) if t > 0 and sign * value(slope, t) > 0]

    def closest(self):
        """The times from 0 on when the gap is smallest."""
        slope = derivative(self.moved(0))
        return [t for t in roots(slope) if t > 0 and value(derivative(slope), t) > 0]

    def first(self, sign):
        """The first crossing, its condition, and whether rounding leaves no doubt about it."""
        time = next(iter(self.crossings(sign)), INF)
        for turn in self.closest():
            if sign > 0 and turn > time:
                break
            change = WIDTH * EPSILON * self.size(turn)
            if (value(self.moved(change), turn) < 0) != (value(self.moved(-change), turn) < 0):
                return turn, self.condition(turn, change, sign), "no"
            if turn > time:
                break
        if time == INF:
            return INF, mpf(0), "yes"
        return time, self.condition(time, WIDTH * EPSILON * self.size(time), sign), "yes"

    def condition(self, time, change, sign):
        moves = [abs(t - time) for t in (self.nearest(time, sign, change), self.nearest(time, sign, -change)) if t < INF]
        return max(moves) / (WIDTH * EPSILON)

    def nearest(self, time, sign, change):
        times = self.crossings(sign, change)
        return min(times, key=lambda t: abs(t - time)) if times else INF


class Line(Gap):
    def __init__(self, gap, speed, acceleration):
        self.gap, self.speed, self.acceleration = mpf(gap), mpf(speed), mpf(acceleration)

    def moved(self, change):
        return [-self.acceleration / 2, -self.speed, self.gap - change]

    def size(self, time):
        return abs(self.gap) + abs(self.speed) * time + abs(self.acceleration) / 2 * time**2

    def reach(self):
        gap, speed, acceleration = self.gap, self.speed, self.acceleration
        if gap <= 0 and (speed > 0 or (speed == 0 and acceleration > 0)):
            return mpf(0), mpf(0), "yes"
        time, condition, sure = self.first(-1)
        if gap < 0 and acceleration > 0:
            turn = -speed / acceleration
            change = WIDTH * EPSILON * self.size(turn)
            if value(self.moved(-change), turn) < 0:
                return turn, mpf(0), "yes"
            if value(self.moved(change), turn) < 0:
                return turn, self.condition(turn, change, -1), "no"
        return time, condition, sure


class Pair(Gap):
    def __init__(self, distance, velocity, reach, acceleration=(0.0, 0.0)):
        self.d, self.w, self.a = (tuple(map(mpf, vector)) for vector in (distance, velocity, acceleration))
        self.s = mpf(reach)

    def moved(self, change):
        def dot(one, other):
            return one[0] * other[0] + one[1] * other[1]

        d, w, a, s = self.d, self.w, self.a, self.s + change
        return [dot(a, a) / 4, dot(a, w), dot(w, w) + dot(a, d), 2 * dot(d, w), dot(d, d) - s * s]

    def size(self, time):
        return length(self.d) + length(self.w) * time + length(self.a) / 2 * time**2 + self.s

    def meet(self):
        *_, slope, gap = self.moved(0)
        if gap <= 0 and slope < 0:
            return mpf(0), mpf(0), "yes"
        # What overlaps and turns back before it has parted meets where it turns.
        cubic = derivative(self.moved(0))
        out = next(iter(self.crossings(1)), INF)
        for turn in roots(cubic):
            if gap < 0 and 0 < turn < out and value(derivative(cubic), turn) < 0:
                speed = length(self.w) + length(self.a) * turn
                return turn, self.size(turn) * speed / abs(value(derivative(cubic), turn) / 2), "yes"
        return self.first(-1)

    def part(self):
        return self.first(1)


def length(vector):
    return sqrt(mpf(vector[0]) ** 2 + mpf(vector[1]) ** 2)


def between(low, high):
    """A random number, evenly over the powers of ten."""
    return 10 ** RANDOM.uniform(low, high)


def sign():
    return RANDOM.choice((-1.0, 1.0))


def direction(turn=None):
    angle = mpf(RANDOM.uniform(0, 2) if turn is None else turn) * mp.pi
    return mp.cos(angle), mp.sin(angle)


def floats(vector):
    return tuple(float(component) for component in vector)


def combine(*terms):
    """The sum of factor times vector, rounded to f64."""
    return floats(sum(mpf(factor) * mpf(vector[axis]) for factor, vector in terms) for axis in (0, 1))


def lines():
    for power in (-3, -6, -9, -12, -15, -30, -100, -200):
        for pull in (980.0, -980.0, 1e-3, -1e7):
            yield "tiny gap", 10.0**power * RANDOM.uniform(1, 9), between(1, 3), pull
    for power in (-6, -4, -2, 0, 2, 4, 6, 8):
        for pull in (0.0, 980.0, -980.0):
            yield "speed", between(0, 3), 10.0**power * RANDOM.uniform(1, 9), pull
            if pull > 0.0:
                yield "away and back", between(0, 3), -(10.0**power) * RANDOM.uniform(1, 9), pull
    for power in range(-3, 8):
        pull = 10.0**power * RANDOM.uniform(1, 9)
        yield "gravity", between(0, 3), between(0, 3), pull
        yield "gravity", between(0, 3), between(0, 3), -pull
        yield "dropped", between(-6, 3), 0.0, pull
        yield "behind, comes out and returns", -between(-6, 1), -between(3, 4) * max(1.0, pull) ** 0.5, pull
    for eta in range(-16, -3):
        for side in (1, -1):
            pull, speed = between(-3, 7), between(-2, 6)
            gap = float(mpf(speed) ** 2 / (2 * mpf(pull)) * (1 - side * mpf(10) ** eta))
            yield "turns back at the line", gap, speed, -pull
            yield "turns back behind the line", -gap, -speed, pull
    for _ in range(4):
        yield "behind", -between(-9, 2), between(-3, 3), sign() * between(-3, 7)
        yield "behind", -between(-9, 2), -between(-3, 3), -between(-3, 7)


def pairs():
    for power in range(-6, 9):
        for far in (1.5, 4):
            s, n = between(0, 2), direction()
            d = combine((s * between(0.1, far), n))
            aim = combine((RANDOM.uniform(-0.9, 0.9) * s, (-n[1], n[0])), (-1, d))
            yield "speed", d, combine((10.0**power * RANDOM.uniform(1, 9) / length(aim), aim)), s
    for power in range(-12, -2):
        for angle in (0.1, 0.9, 1.5):
            s, n = between(0, 2), direction()
            w = combine((-between(-1, 4) * mp.cos(angle), n), (between(-1, 4) * mp.sin(angle), (-n[1], n[0])))
            yield "tiny gap", combine((s + 10.0**power, n)), w, s
    for eta in range(-16, -5):
        for far in (1.01, 3.0, 100.0, 1e4):
            for side in (1, -1):
                n, w = direction(), between(-3, 6)
                away = RANDOM.uniform(0.5, 50)
                d = combine((away, (-n[1], n[0])), (-away * far, n))
                velocity = combine((w, n))
                # Exactly what the rounded vectors pass by.
                by = abs(mpf(d[0]) * mpf(velocity[1]) - mpf(d[1]) * mpf(velocity[0])) / length(velocity)
                case = "grazing hit" if side > 0 else "grazing miss"
                yield case, d, velocity, float(by * (1 + side * mpf(10) ** eta))
    for _ in range(20):
        s = between(-3, 3)
        yield "overlap", combine((s * RANDOM.uniform(0, 0.999), direction())), combine((between(-6, 8), direction())), s
    for _ in range(8):
        s = between(-3, 3)
        yield "shallow overlap", combine((s * (1 - between(-12, -3)), direction())), combine((between(-6, 8), direction())), s
    for _ in range(20):
        s, n = between(-3, 3), direction()
        slope = between(-5, 0)
        w = combine((-slope, n), (1, (-n[1], n[0])))
        yield "touch", combine((s, n)), combine((between(-6, 8), w)), s
    yield "rest", (1.0, 2.0), (0.0, 0.0), 3.0
    for _ in range(12):
        yield leaving()


def leaving():
    """A pair that touches up to rounding, on either side, and parts."""
    s, n = between(-3, 3), direction()
    w = combine((between(-5, 0), n), (sign(), (-n[1], n[0])))
    return "leave", combine((s, n)), combine((between(-6, 8), w)), s


def towards(time, acceleration, velocity, s):
    """A pair that touches about `time` from now, and moves at `velocity` then."""
    a, n = combine((1, acceleration)), direction()
    w = combine((1, velocity), (-time, a))
    return combine((s, n), (-time, velocity), (mpf(time) ** 2 / 2, a)), w, s, a


def pull(angle=None):
    return combine((between(-3, 7), direction(angle)))


def accelerated():
    for power in range(-3, 8):
        s, far = between(0, 2), between(0, 3)
        a = (0.0, 10.0**power * RANDOM.uniform(1, 9))
        fall = float(sqrt(2 * far * length(a)))
        yield "dropped", (0.0, -(s + far)), (0.0, 0.0), s, a
        yield "head-on", (0.0, -(s + far)), (0.0, between(-2, 2) * fall), s, a
        yield "thrown up", (0.0, -(s + far)), (0.0, -between(-2, 1) * fall), s, a
        yield "thrown up, slid under", (between(-2, 0) * s, -(s + far)), (0.1 * fall * sign() * s / far, -fall), s, a
        yield "from below", (0.0, s + far), (0.0, -between(0.05, 1) * fall), s, a
        yield "turns back before", (0.0, s + far), (0.0, -0.999 * fall), s, a
    for power in (-6, -3, 0, 3, 6, 8):
        for _ in range(4):
            a, s = pull(), between(0, 2)
            velocity = combine((10.0**power * RANDOM.uniform(1, 9), direction()))
            time = min(100 / float(length(velocity)), float(sqrt(2000 / length(a))))
            yield "oblique", *towards(time, a, velocity, s)
    for power in range(-12, -2):
        for angle in (0.1, 1.4):
            s, n = between(0, 2), direction()
            w = combine((-between(-1, 4) * mp.cos(angle), n), (between(-1, 4) * mp.sin(angle), (-n[1], n[0])))
            yield "tiny gap", combine((s + 10.0**power, n)), w, s, pull()
    for _ in range(12):
        s = between(0, 2)
        yield "overlap", combine((s * RANDOM.uniform(0, 0.99), direction())), combine((between(-1, 4), direction())), s, pull()
        n = direction()
        w = combine((-between(-1, 4), n), (between(-1, 4), (-n[1], n[0])))
        yield "touch", combine((s, n)), w, s, pull()
    for _ in range(6):
        s, n, a = between(0, 2), direction(RANDOM.uniform(1.2, 1.8)), between(0, 4)
        yield "pressed", combine((s, n)), (0.0, 0.0), s, (0.0, a)
    for _ in range(4):
        # From just above the middle, thrown away from it and pulled back.
        s, a = between(0, 2), between(-3, 7)
        away = float(sqrt(2 * mpf(a) * s)) * RANDOM.uniform(0.1, 0.8)
        yield "overlap that turns back", (RANDOM.uniform(-0.1, 0.1) * s, -0.3 * s), (0.0, -away), s, (0.0, a)
    for eta in range(-13, -5):
        for side in (1, -1):
            for wanted in ("single", "first", "second"):
                yield grazing(mpf(10) ** eta * side, wanted)
    for _ in range(12):
        # Fast enough to part, slow enough to come back where it falls.
        _, d, w, s = leaving()
        a = pull()
        yield "leave", d, combine((float(sqrt(length(a) * s) / length(w)) * between(-1, 1), w)), s, a
    for power in (-9, -12, -20, -30, -39, -50):
        a, s = combine((10.0**power, direction())), between(0, 2)
        velocity = combine((between(-3, 6), direction()))
        yield "weak gravity", *towards(100 / float(length(velocity)), a, velocity, s)
        yield "weak gravity", combine((s * 0.5, direction())), velocity, s, a


def grazing(eta, wanted):
    """A parabola that passes the other at a distance of (1 - eta) reaches: the only, first or second time."""
    while True:
        a = pull(0.5)
        time = float(sqrt(2 * RANDOM.uniform(50, 500) / length(a)))
        d = (RANDOM.uniform(-100, 100), RANDOM.uniform(-300, 100))
        w = (RANDOM.uniform(-60, 60) / time, RANDOM.uniform(-400, 100) / time)
        pair = Pair(d, w, 0, a)
        turns = pair.closest()
        by = [length(combine_exactly(pair, turn)) for turn in turns]
        if wanted == "single" and len(by) == 1:
            s = by[0]
        elif wanted == "first" and len(by) == 2 and by[1] < 0.9 * by[0]:
            s = by[0]
        elif wanted == "second" and len(by) == 2 and by[1] < 0.9 * by[0]:
            s = by[1]
        else:
            continue
        if 1 < s < 0.9 * length(d):
            case = {"single": "", "first": ", the first of two approaches", "second": ", the second of two approaches"}
            return ("grazing hit" if eta > 0 else "grazing miss") + case[wanted], d, w, float(s * (1 + eta)), a


def combine_exactly(pair, time):
    return tuple(d + w * time + a * time**2 / 2 for d, w, a in zip(pair.d, pair.w, pair.a))


def written(number):
    """The shortest text that reads back as the same f64; conditions need no more than three digits."""
    return repr(float(number)).removesuffix(".0")


def answer(time, condition, sure):
    return [written(time), f"{float(condition):.2e}", sure]


NOT_ASKED = ["", "", ""]


def row(case, distance, velocity, reach, acceleration=None):
    pair = Pair(distance, velocity, reach, acceleration or (0.0, 0.0))
    within = case in ("overlap", "shallow overlap", "touch", "pressed", "rest") or (
        case == "weak gravity" and pair.moved(0)[-1] < 0
    )
    meet = NOT_ASKED if case == "pressed" else answer(*pair.meet())
    part = answer(*pair.part()) if within else NOT_ASKED
    inputs = [*distance, *velocity, reach, *(acceleration or ())]
    return [case.replace(",", ";"), *map(written, inputs), *meet, *part]


def write(name, header, rows):
    with open(Path(__file__).with_name(name), "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header.split())
        writer.writerows(rows)


def main():
    answers = "meet meet_condition meet_sure part part_condition part_sure"
    write(
        "flight-lines.csv",
        "case gap speed acceleration reach reach_condition reach_sure",
        ([case.replace(",", ";"), *map(written, inputs), *answer(*Line(*inputs).reach())] for case, *inputs in lines()),
    )
    write("flight-pairs.csv", f"case dx dy wx wy reach {answers}", (row(*pair) for pair in pairs()))
    write("flight-accelerated.csv", f"case dx dy wx wy reach ax ay {answers}", (row(*pair) for pair in accelerated()))


if __name__ == "__main__":
    main()
