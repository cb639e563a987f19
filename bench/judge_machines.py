"""Machines and readings of bench/judge, what each effect of docs/physics.md adds to them, and who can stand for whom.

Written from the documents alone, as bench/judge is; its head says more.
"""
import copy
import dataclasses
import functools
import itertools
import math

from judging import np, number, rounded

AXES, LETTERS, TURN = "XYZ", "XYZABC", 2 * math.pi
SAME = 1 / 50  # of the noise, to which a rival reproduces the truth
CLEAR = 25.0  # by which any other effect must score worse
CURVE, FREE_CURVE = 8, 12  # Legendre degrees from 2 on; of a free curve a few more than "about ten" degrees of freedom


class Axis:
    def __init__(self, r):
        length = rounded(r.log(250.0, 4000.0), 10.0)
        self.low = r.choice([-length, -rounded(0.5 * length, 10.0), 0.0, 0.0])
        self.high = self.low + length
        self.datum = r.choice([0.0, 0.0, self.low, self.high])
        self.pitches = {name: r.choice(of) for name, (share, of) in PITCHES.items() if r.chance(share)}
        self.line = None  # measurement line

    def targets(self, r, count, moved):
        length = self.high - self.low
        step = length * r.uniform(0.6, 0.95) / (count - 1)
        step = max(0.5, rounded(step, 1.0 if step > 5.0 else 0.1))
        first = self.low + rounded(max(0.0, length - step * (count - 1)) * r.uniform(0.2, 0.8), 0.5)
        off = r.uniform(0.1, 0.35) * step if moved else 0.0
        return [float(rounded(first + step * k + off * r.uniform(-1.0, 1.0), 0.001)) for k in range(count)]


class Rotary:
    """Limits and targets in degrees."""
    datum, pitches, line = 0.0, {}, None

    def __init__(self, r):
        self.low, self.high = r.choice([(0.0, 360.0), (0.0, 360.0), (-180.0, 180.0), (-120.0, 120.0), (0.0, 180.0), (-110.0, 30.0)])

    def targets(self, r, count, moved):
        step = (self.high - self.low) / count
        off = r.uniform(0.1, 0.35) * step if moved else 0.0
        last = r.choice([0, 1]) if self.high - self.low == 360 else 1  # whether a turn is closed
        targets = self.low + step * np.arange(count + last) + off * np.array([r.uniform(-1.0, 1.0) for _ in range(count + last)])
        return [float(target) for target in np.clip(np.round(targets, 3), self.low, self.high)]


@dataclasses.dataclass(frozen=True)
class Term:
    """One effect at one place; with its numbers the contribution is columns(nonlinear) times coefficients."""
    id: str
    axis: int
    sense: int = None  # none where the code says it
    code: str = ""
    approach: int = 0  # of a cyclic: 0 both
    sensor: str = ""
    sensor2: str = ""
    nonlinear: float = 0.0  # period_mm, position_mm (machine coordinate), tau_s, u0_mm or shift_mm
    coefficients: tuple = ()
    given: bool = False  # of the base: its parameters stand in the model file

    @property
    def name(self):
        return f"{self.id}:{LETTERS[self.axis]}:{self.code if self.sense is None else 'E' + LETTERS[self.sense]}"

    def but(self, **changed):
        return dataclasses.replace(self, **changed)

    def sized(self, factor):
        return self.but(coefficients=tuple(c * factor for c in self.coefficients))

    @property
    def is_possible(self):
        low, high = {"air_refraction": (0.15, 1.7), "dead_path": (-9.0, 9.0), "cosine": (0.0, 400.0)}.get(self.id, (-math.inf, math.inf))
        return low < self.coefficients[0] < high


NONLINEAR = ("cyclic", "step", "warm_up", "reversal_spike", "map_shift")
OWN_AXIS = ("backlash", "servo_lag", "reversal_spike", "reversal_curve")
MAP_FAULTS = ("map_polarity", "map_gain", "map_shift", "map_direction_swap")
FIXED = ("map_shift", "map_direction_swap")  # coefficient 1
LIMITS = {"cosine": (0.0, math.inf), "air_refraction": (0.0, 2.0), "dead_path": (-10.0, 10.0)}
PITCHES = {"screw": (0.6, [4, 5, 6, 8, 10, 12, 12.7, 16, 20, 25]), "scale": (0.4, [0.02, 0.04, 0.1, 2.0])}  # share, mm
SQUARENESS = {"C0Y": (0, 1, -1.0), "B0Z": (0, 2, 1.0), "A0Z": (1, 2, -1.0)}  # sense, lever, sign
GIVEN = {"scale": "um_per_m", "backlash": "um"}  # in one base of five
LEVER_LINES = ["XZX", "XYX", "YZX", "XZY", "YZY", "XYZ", "ZYZ", "ZYX", "YXY", "ZXZ", "YXZ", "ZXY"]  # moving, lever, sense


def across(rotation, sense):
    """(rotation × lever) along a sense: the lever's axis and the sign; nothing along the rotation itself."""
    lever = 3 - rotation - sense
    return (lever, 1.0 if (rotation + 1) % 3 == lever else -1.0) if rotation != sense else None


def excess_refraction(celsius, hPa, percent):
    """Of air at 633 nm less that at 20 degC, 1013.25 hPa, 50 % (Birch and Downs 1993, 1994)."""
    def index(celsius, pascal, percent):
        wave = (1 / 0.6329912) ** 2
        standard = 1e-8 * (8342.54 + 2406147.0 / (130 - wave) + 15998.0 / (38.9 - wave))
        dry = pascal * standard / 96095.43 * (1 + 1e-8 * (0.601 - 0.00972 * celsius) * pascal) / (1 + 0.003661 * celsius)
        return dry - percent * 6.112 * np.exp(17.62 * celsius / (243.12 + celsius)) * (3.7345 - 0.0401 * wave) * 1e-10
    return index(celsius, 100 * hPa, percent) - index(20.0, 101325.0, 50.0)


class Setup:
    """A machine and its readings in the order of time, one array a column; what effects of docs/physics.md add to them.

    `wishes`: what an effect needs to show."""
    of_grid = ("step",)  # whose nonlinear parameter has no values between those of the grid
    true_pitch = 0.0  # mm, where the machine file has another

    def __init__(self, r, wishes):
        self.name = f"machine {r.randint(100, 999)}"
        self.chain = r.choice(["TXYZ", "XTYZ", "XYTZ", "XYZT"])
        self.axes = [Axis(r) for _ in AXES]
        for axis in self.axes:
            axis.line = [float(rounded(r.uniform(a.low, a.high), 10.0)) for a in self.axes] if r.chance(0.4) else None
        self.moved, self.map, self.known = r.chance(0.6), {}, None
        few = "few" in wishes
        passes = self.passes(r, wishes, r.randint(5, 9) if few else r.randint(16, 60))
        runs = r.randint(1, 2) if few or r.chance(0.15) else r.randint(3, 6)
        several = {"feeds", "loads"} & wishes
        runs = max(runs, 3 if several and few else r.randint(4, 6) if several else 3 if "runs" in wishes and not few else 1)
        if "volume" in wishes:
            runs = r.randint(1, 2)
        elif len(passes) > 1:
            runs = min(max(runs, 2), 3)
        self.both = bool({"both", "travel"} & wishes) or r.chance(0.6)
        self.shows = {"feed": bool({"feeds", "one_feed"} & wishes) or r.chance(0.15),
                      "load": bool({"loads", "one_load"} & wishes) or r.chance(0.1),
                      "travel": "travel" in wishes or (self.both and r.chance(0.2)),
                      "air": bool({"air", "one_weather", "similar_air"} & wishes) or r.chance(0.15)}
        self.travel_along(r, wishes, passes, runs)
        self.add_climates(r, wishes)
        self.m = [(self.at[:, k] - axis.datum) / 1000 for k, axis in enumerate(self.axes)]
        self.hours = (self.time - self.time[0]) / 3600
        self.session = float(self.time[-1] - self.time[0])
        self.n, self.kept = len(self.time), {}
        self.relative = np.ones(self.n)  # size of the noise of each reading
        self.zeros = np.zeros((self.n, 0))  # columns that belong to the set-up, in every base
        if "map" in wishes:
            self.add_map(r)
        if "known" in wishes:
            self.add_known(r)
        if "pitch" in wishes:
            self.mistake_pitch(r)

    def passes(self, r, wishes, count):
        """Lines to travel: (moving axis, senses, parked coordinates, targets)."""
        shares = r.uniform(0.0, 0.2), r.uniform(0.3, 0.7), r.uniform(0.8, 1.0)
        places = [[float(rounded(a.low + (a.high - a.low) * share, 5.0)) for a in self.axes] for share in shares]
        parked = [r.choice(column) for column in zip(*places)]
        beside = [[[column[k] if k == axis else parked[k] for k in range(3)] for column in places] for axis in range(3)]
        if "plane" in wishes:
            self.layout = "plane"
            pair, passes = r.choice([(0, 1), (0, 2), (1, 2)]), []
            for axis, other in (pair, pair[::-1]):
                targets = self.axes[axis].targets(r, r.randint(7, 12), self.moved)
                passes += [(axis, pair, place, targets) for place in beside[other]]
            return passes
        if "levers" in wishes:
            self.layout = "levers"
            axis, lever, sense = (AXES.index(letter) for letter in r.choice(LEVER_LINES))
            targets = self.axes[axis].targets(r, max(8, count // 2), self.moved)
            return [(axis, [sense], place, targets) for place in beside[lever][::r.choice([1, 2])]]
        self.layout = "line"
        axis = sense = r.randint(0, 2)
        square = next((word for word in sorted(wishes) if word in SQUARENESS), None)
        if square:
            sense, axis, _ = SQUARENESS[square]
        elif "across" in wishes or ("along" not in wishes and r.chance(0.4)):
            sense = r.choice([other for other in range(3) if other != axis])
        return [(axis, [sense], parked, self.axes[axis].targets(r, count, self.moved))]

    def travel_along(self, r, wishes, passes, runs):
        dwell, pause, overrun = r.uniform(4.0, 12.0), r.log(20.0, 900.0), float(rounded(r.uniform(1.0, 8.0), 0.1))
        feed, load, most = rounded(r.log(500.0, 6000.0), 100.0), rounded(r.uniform(10.0, 800.0), 5.0), r.log(100.0, 2000.0)
        feeds = [float(rounded(feed * (0.4 + 0.8 * k), 50.0)) if "feeds" in wishes else feed for k in range(3)]
        loads = [float(rounded(most * 0.5 * k, 5.0)) if "loads" in wishes else load for k in range(3)]
        rows, clock, run = [], 0.0, 0
        for line, (axis, senses, parked, targets) in enumerate(passes):
            for k in range(self.runs_of(line, runs)):
                level, run = (k + run // 3) % 3, run + 1
                for approach in (1, -1) if self.both else (1,):
                    start = targets[0] - overrun if approach > 0 else targets[-1] + overrun
                    for target in targets[::approach]:
                        clock += dwell * r.uniform(0.9, 1.1)
                        at = parked(target) if callable(parked) else [
                            target if other == axis else parked[other] for other in range(len(self.axes))]
                        rows += [(axis, sense, approach, run, clock, feeds[level], loads[level],
                                  abs(target - start), *at, line) for sense in senses]
                clock += pause * r.uniform(0.5, 1.5)
        self.take_rows(rows)

    def runs_of(self, line, runs):
        return runs

    def take_rows(self, rows):
        table = np.array(rows)
        self.axis, self.sense, self.approach, self.run = (table[:, k].astype(int) for k in range(4))
        self.time, self.feed, self.load = rounded(table[:, 4], 0.1), *table[:, 5:7].T
        self.travel, self.at = np.round(table[:, 7], 3), table[:, 8:-1]
        self.line = table[:, -1].astype(int)
        self.before, last = np.full(len(rows), -1), {}  # of each reading the one before of its run and sense
        for k, key in enumerate(zip(self.run, self.sense)):
            self.before[k] = last.get(key, -1)
            last[key] = k

    def add_climates(self, r, wishes):
        u, runs = self.time / max(1.0, self.time[-1]), int(self.run[-1])

        def climate(start=None):
            """A rise, a swing, now and then a level of each run."""
            start, rise, swing = start or r.uniform(17.5, 24.0), r.signed(0.2, 4.0), r.uniform(0.1, 1.2)
            phase, cycles, rate = r.uniform(0.0, TURN), r.uniform(0.6, 2.5), r.log(0.3, 6.0)
            levels = np.array([r.uniform(-1.5, 1.5) for _ in range(runs)]) * r.chance(0.3)
            smooth = rise * (1 - np.exp(-rate * u)) / (1 - math.exp(-rate))
            return start + smooth + swing * np.sin(TURN * cycles * u + phase) + levels[self.run - 1]
        material = 20.0 + r.signed(1.0, 4.0) + 0 * u if "one_temperature" in wishes else climate()
        values = {"t_material_degC": material} if {"material", "one_temperature"} & wishes or r.chance(0.25) else {}
        if self.shows["air"]:
            air = 20.0 + r.signed(2.0, 6.0) + 0 * u if "one_weather" in wishes else climate()
            values["t_air_degC"] = material if "similar_air" in wishes else air
        least = 2 if "two_sensors" in wishes else 1 if {"sensor", "ramp"} & wishes else 0
        for k in range(max(least, r.randint(1, 2) if r.chance(0.3) else 0)):
            even = r.uniform(17.5, 24.0) + r.signed(0.5, 4.0) * u
            values[("t_spindle_degC", "t_column_degC")[k]] = even if "ramp" in wishes and k == 0 else climate()
        exact = "ramp" in wishes or "similar_air" in wishes  # sensors whose equality is the point are not rounded
        self.sensors = {name: rounded(degC, 1e-6 if exact else 0.01) for name, degC in values.items()}
        if "sensors_exchanged" in wishes:
            one, other = r.sample(sorted(self.sensors), 2)
            self.sensors |= {one: self.sensors[other], other: self.sensors[one]}
        if "time_exchanged" in wishes:  # with a sensor that only rises, so that rows remain in the order of their time
            degC = r.uniform(17.5, 24.0) + r.uniform(1.5, 5.0) * (1 - np.exp(-r.uniform(2.0, 6.0) * u))
            self.sensors["t_spindle_degC"], self.time = self.time, rounded(degC, 1e-4)
        constant, hPa, percent = bool({"one_weather", "similar_air"} & wishes), r.uniform(940.0, 1030.0), r.uniform(30.0, 65.0)
        self.pressure = rounded(hPa + 0 * u if constant else climate(hPa), 0.01)
        self.humidity = rounded(percent + 0 * u if constant else climate(percent), 0.1)
        if self.shows["air"]:
            self.refraction = excess_refraction(self.sensors["t_air_degC"], self.pressure, self.humidity)

    def add_map(self, r):
        """Compensation of the measured curve: approach (0: both) → places and values."""
        axis = self.axes[self.axis[0]]
        length = axis.high - axis.low
        step = rounded(max(5.0, length / r.randint(20, 50)), 1.0)
        p = np.arange(axis.low, axis.high + 0.5 * step, step)
        u, size, lost = (p - axis.low) / length, r.uniform(3.0, 25.0), r.signed(1.0, 8.0)
        value = size * (np.sin(TURN * r.uniform(1.5, 6.0) * u + r.uniform(0.0, TURN)) + r.uniform(-1.0, 1.0) * u)
        value = rounded(value + np.cumsum(0.15 * size * r.normals(len(p))), 0.1)
        other = rounded(value + lost + np.cumsum(0.1 * lost * r.normals(len(p))), 0.1)
        self.map = {1: (p, value), -1: (p, other)} if r.chance(0.5) else {0: (p, value)}

    def add_known(self, r):
        """A rotation of the axis that moves, not its roll, measured separately: code, places, values."""
        axis = int(self.axis[0])
        letter = r.choice([other for other in range(3) if other != axis])
        p = np.round(np.linspace(self.axes[axis].low, self.axes[axis].high, 41), 2)
        self.known = ("E" + "ABC"[letter] + AXES[axis], p, np.round(np.cumsum(r.uniform(2.0, 6.0) * r.normals(41)), 2))

    def mistake_pitch(self, r):
        """In the machine file, 1 to 2 % from that of a wave that the readings show."""
        axis = int(self.axis[0])
        span, count = np.ptp(self.at[:, axis]), len(self.targets(axis))
        shown = [pitch for pitch in PITCHES["screw"][1] if (1.1 if self.moved else 2.2) * span / (count - 1) <= pitch <= 0.35 * span]
        if shown:
            self.true_pitch = float(r.choice(shown))
            self.axes[axis].pitches["screw"] = float(rounded(self.true_pitch * (1 + r.signed(0.01, 0.02)), 0.001))

    def positions(self, axis, sense):
        """That show a wave along an axis; in Kinds those of its sense."""
        return self.at[:, axis]

    def period(self, r, axis, sense):
        """Of a wave to hide: a little longer than the grid's shortest."""
        positions = self.positions(axis, sense)
        span = max(1e-3, np.ptp(positions) / 1000)
        step = 1000 * span / (len(np.unique(positions)) - 1)
        drawn = r.log(min(300 * span, (1.1 if self.moved else 2.2) * step), 350 * span)
        drawn = self.axes[axis].pitches.get("screw", drawn) if r.chance(0.6) else drawn
        return self.true_pitch or drawn

    def place_columns(self):
        return dict(zip(("x_mm", "y_mm", "z_mm"), self.at.T))

    def place(self, axis):
        """−1 … 1 over what the set covers of an axis."""
        at = self.at[:, axis]
        low, high = at.min(), at.max()
        return 2 * (at - low) / (high - low) - 1 if high > low else 0 * at

    def targets(self, axis, sense=None):
        """At which an axis was read; in Kinds of one sense."""
        return np.unique(self.at[self.axis == axis, axis])

    def smooth(self, t, on, count):
        """s(p): Legendre polynomials less mean and slope over the rows where the effect acts."""
        out = np.zeros((self.n, count))
        if on.any():
            curve = np.polynomial.legendre.legvander(self.place(t.axis)[on], count + 1)
            line = curve[:, :2]
            out[on] = curve[:, 2:] - line @ np.linalg.lstsq(line, curve[:, 2:], rcond=None)[0]
        return out

    def is_lever(self, axis, lever):
        """Whether the lever arm of an axis's rotation holds this coordinate (rigid-body model for any chain)."""
        tool, own, other = (self.chain.index(letter) for letter in ("T", AXES[axis], AXES[lever]))
        return other > own if own > tool else other > tool or other <= own

    def angular(self, t):
        """ε(p) × L, the lever counted from the measurement line."""
        lever_m, line = np.zeros(self.n), self.axes[t.axis].line
        for sense in range(3):
            found = across("ABC".index(t.code[1]), sense)
            if found and self.is_lever(t.axis, found[0]):
                from_mm = line[found[0]] if line and found[0] != t.axis else 0.0
                lever_m += (self.sense == sense) * found[1] * (self.at[:, found[0]] - from_mm) / 1000
        return lever_m[:, None] * np.polynomial.legendre.legvander(self.place(t.axis), CURVE + 1)

    def map_at(self, approach, shift=0.0):
        """The unit's compensation at each reading [um]."""
        where = self.at[np.arange(self.n), self.axis] + shift
        out = np.zeros(where.shape)
        for of, (p, value) in self.map.items():
            out = np.where((of == 0) | (approach == of), np.interp(where, p, value), out)
        return out

    def waves(self, axis, v):
        """Sine and cosine of one and two periods; those of a whole grid are kept."""
        key = axis, v.tobytes()
        if key in self.kept:
            return self.kept[key]
        found = [wave(k * TURN * 1000 * self.m[axis] / v) for k in (1, 2) for wave in (np.sin, np.cos)]
        if len(v) > 20:
            self.kept[key] = found
        return found

    def parts(self, t, v):
        """The columns of an effect that is no curve; with a nonlinear parameter, v (values × 1), each (values × readings)."""
        m = self.m[t.axis]
        match t.id:
            case "offset": return [np.ones(self.n)]
            case "scale": return [m]
            case "cyclic":
                on = (t.approach == 0) | ((self.axis == t.axis) & (self.approach == t.approach))
                return [on * wave for wave in self.waves(t.axis, v)]
            case "backlash": return [self.approach / 2]
            case "step": return [1.0 * (self.at[:, t.axis] > v)]
            case "sag": return [m**2, np.abs(m) ** 3]
            case "squareness":
                sense, lever, sign = SQUARENESS[t.code]
                return [(self.sense == sense) * sign * self.m[lever]]
            case "set_up_rotation":
                found = [(sense, across("ABC".index(t.code[1]), sense)) for sense in range(3)]
                return [sum((self.sense == sense) * to[1] * self.m[to[0]] for sense, to in found if to)]
            case "measurement_line": return [np.interp(self.at[:, t.axis], *self.known[1:]) / 1000]
            case "thermal_scale": return [m * (self.sensors["t_material_degC"] - 20)]
            case "thermal_drift": return [self.sensors[t.sensor] - self.sensors[t.sensor][0]]
            case "thermal_bend": return [m**2 * (self.sensors[t.sensor] - self.sensors[t.sensor2])]
            case "warm_up":
                warm = 1 - np.exp(-3600 * self.hours / v)
                return [warm, warm * m]
            case "time_drift": return [self.hours]
            case "air_refraction": return [1e6 * m * self.refraction]
            case "dead_path": return [1e6 * self.refraction]
            case "cosine": return [-m / 2]  # coefficient: the angle squared, in mrad²
            case "servo_lag": return [self.feed / 1000 * self.approach]
            case "load": return [self.load, self.load * m]
            case "reversal_spike": return [self.approach * np.exp(-self.travel / v)]
            case "map_polarity": return [-2 * self.map_at(self.approach)]
            case "map_gain": return [self.map_at(self.approach)]
            case "map_shift": return [self.map_at(self.approach, v) - self.map_at(self.approach)]
            case "map_direction_swap": return [self.map_at(-self.approach) - self.map_at(self.approach)]

    def columns(self, t, values=None, curve=CURVE, place=-1):
        """At each value of the nonlinear parameter; shape (values × readings × coefficients), the coefficients at this place."""
        on = np.ones(self.n, bool) if t.sense is None else self.sense == t.sense
        if t.id in OWN_AXIS:
            on = on & (self.axis == t.axis)
        if t.id == "angular":
            return np.moveaxis(self.angular(t)[None], -1, place)
        if t.id in ("progressive", "reversal_curve"):
            bends = self.smooth(t, on, curve) * (self.approach[:, None] / 2 if t.id == "reversal_curve" else 1.0)
            return np.moveaxis(bends[None], -1, place)
        v = np.array([t.nonlinear] if values is None else values, float)[:, None]
        return np.stack([np.atleast_2d(part * on) for part in self.parts(t, v if t.id in NONLINEAR else None)], axis=place)

    def contribution(self, t):
        return self.columns(t)[0] @ np.array(t.coefficients)

    def free_columns(self, t):
        """What a base term takes when it is fitted: its columns, and the derivative by its nonlinear parameter."""
        own = self.columns(t, curve=FREE_CURVE if t.id == "progressive" else CURVE)[0]
        if t.id not in NONLINEAR or t.id in self.of_grid:
            return own
        step = 1e-5 * max(1e-3, abs(t.nonlinear))
        ahead, behind = self.columns(t, [t.nonlinear + step, t.nonlinear - step]) @ np.array(t.coefficients)
        return np.hstack([own, (ahead - behind)[:, None] / (2 * step)])

    def grid(self, t):
        """Values of the nonlinear parameter inside its limits, to start a search with; [0] for effects without one."""
        if t.id in ("cyclic", "step"):
            targets = self.targets(t.axis, t.sense)
            if len(targets) < 6 or t.id == "step":
                return list((targets[2:-3] + targets[3:-2]) / 2) if len(targets) > 5 else []
            span = targets[-1] - targets[0]
            most = (len(targets) - 1) / (1 if self.moved else 2)  # waves
            pitches = [pitch * part for pitch in self.axes[t.axis].pitches.values() for part in (0.5, 1.0, 2.0)]
            return [span / k for k in np.arange(2.0, most + 1e-9, 0.2)] + [p for p in pitches if 2 * p <= span]
        low, high = {"warm_up": (self.session / 50, self.session),
                     "reversal_spike": (max(0.01, self.travel.min() / 3), self.travel.max() / 2)}.get(t.id, (0.0, 0.0))
        if low < high:
            return list(np.geomspace(low, high, 14))
        return [] if t.id == "reversal_spike" else [2.0 * k for k in range(-30, 31) if k] if t.id == "map_shift" else [0.0]

    def may_be_candidate(self, t):
        """Air and temperatures must change inside runs, or have four states."""
        if t.id not in ("dead_path", "thermal_drift", "air_refraction"):
            return True
        column = self.columns(t)[0, :, 0]
        largest = np.abs(column).max()
        inside = any(np.ptp(column[self.run == run]) > 1e-6 * largest for run in np.unique(self.run))
        return largest > 0 and (inside or len(np.unique(np.round(column / largest * 1e6))) >= 4)

    @functools.cached_property
    def library(self):
        """Every effect at every place where these readings could show it."""
        terms, shows = [], self.shows
        axes, senses = sorted(set(self.axis.tolist())), sorted(set(self.sense.tolist()))
        for axis, sense in itertools.product(axes, senses):
            ids = ["scale", "progressive", "step", "sag", "warm_up", "cyclic"]
            ids += ["offset", "time_drift"] * (axis == axes[0]) + ["backlash", "reversal_curve"] * self.both
            ids += ["reversal_spike"] * (self.both and shows["travel"]) + ["servo_lag"] * (self.both and shows["feed"])
            ids += ["load"] * shows["load"] + list(MAP_FAULTS) * bool(self.map)
            if axis == sense:
                ids += ["cosine"] + ["thermal_scale"] * ("t_material_degC" in self.sensors) + ["air_refraction", "dead_path"] * shows["air"]
            terms += [Term(id, axis, sense) for id in ids]
            terms += [Term("cyclic", axis, sense, approach=way) for way in (1, -1) if self.both]
            terms += [Term("thermal_drift", axis, sense, sensor=sensor) for sensor in self.sensors]
            terms += [Term("thermal_bend", axis, sense, sensor=a, sensor2=b)
                      for a, b in itertools.combinations(self.sensors, 2) if axis != sense]
            if self.known and AXES.index(self.known[0][2]) == axis:
                terms.append(Term("measurement_line", axis, sense, self.known[0]))
        for axis in range(3):
            if axis not in axes and np.ptp(self.at[:, axis]) > 0:
                terms += [Term("scale", axis, sense) for sense in senses]  # by the coordinate, whichever axis moved
            terms += [Term("angular", axis, code="E" + letter + AXES[axis]) for letter in "ABC"]
        terms += [Term("set_up_rotation", axes[0], code=code) for code in ("EA", "EB", "EC")]
        return terms + [Term("squareness", AXES.index(code[2]), code=code) for code in SQUARENESS]

    def structures(self, r):
        """Structure that is in no library, by kind; u the place, t the session's part, both 0 to 1."""
        u, t, run = (self.place(self.axis[0]) + 1) / 2, (self.time - self.time[0]) / self.session, self.run
        phase, k, place = r.uniform(0.0, TURN), r.uniform(3.0, 7.0), r.uniform(0.3, 0.7)
        targets, of = np.unique(u, return_inverse=True)
        wave, middle = np.sin(TURN * k * u + phase), run[self.n // 2]
        return {
            "chirp": lambda: np.sin(TURN * (2 * u + k * u**2) + phase),
            "amplitude-modulated wave": lambda: wave * np.sin(TURN * 0.9 * u + place),
            "random walk over targets": lambda: np.cumsum(r.normals(len(targets)))[of],
            "random walk over time": lambda: np.interp(60 * t, np.arange(63), np.cumsum(r.normals(63))),
            "square wave": lambda: np.where(wave > 0, 1.0, -1.0),
            "sawtooth": lambda: 2 * ((k * u + place) % 1) - 1,
            "straight pieces with kinks": lambda: np.interp(15 * u, np.arange(16), r.normals(16)),
            "play that jumps from zone to zone": lambda: self.approach * r.normals(12)[(11.999 * u).astype(int)],
            "wave that grows with time": lambda: wave * t,
            "burst in one run": lambda: (run == r.randint(1, int(run[-1]))) * (np.abs(u - place) < 0.12) * np.cos(40 * u),
            "two waves that beat": lambda: wave + np.sin(TURN * (k + 0.7) * u),
            "four unrelated waves": lambda: wave + sum(np.sin(TURN * k * f * u + at) for f, at in ((1.37, 0), (0.73, 1), (1.83, 2))),
            "narrow bump": lambda: np.exp(-((u - place) / 0.057) ** 2) - 0.8 * np.exp(-((u - place + 0.2) / 0.042) ** 2),
            "period that jumps": lambda: np.sin(TURN * np.where(u < place, k, 1.9 * k) * (u - place) + phase),
            "wave in time": lambda: np.sin(TURN * max(4.0, self.session / r.uniform(240.0, 900.0)) * t + phase),
            "jump in the middle of a run": lambda: np.where(run == middle, 1.0 * (u > place), np.sign(run - middle)),
            "wave that dies along the travel": lambda: wave * np.exp(-5 * u),
            "random values at targets, forward only": lambda: r.normals(len(targets))[of] * (self.approach > 0),
            "wave whose phase drifts with time": lambda: np.sin(TURN * (k * u + 1.3 * t) + phase),
            "random values at targets": lambda: r.normals(len(targets))[of],
        }

    def bad_runs(self, r):
        on, u, turn = self.run == r.randint(1, int(self.run[-1])), (self.place(self.axis[0]) + 1) / 2, r.uniform(0.3, 0.7)
        return {"offset of one run": lambda: 1.0 * on, "one run rotated": lambda: on * (u - turn),
                "one run noisy": lambda: on * r.normals(self.n)}


class Turn(Setup):
    """Readings of the angular positions of a rotary axis: degrees where others have mm. What turns comes back: its waves are whole
    fractions of a turn, also over part of it, and it has no scale."""
    of_grid = ("step", "cyclic")

    def __init__(self, r, wishes):
        super().__init__(r, wishes)
        self.letter = LETTERS[self.axis[0]]
        self.chain = self.chain.replace("T", self.letter + "T") if r.chance(0.7) else self.chain + self.letter
        self.shows |= {"feed": False, "travel": False}  # in mm

    def passes(self, r, wishes, count):
        self.layout, axis = "line", r.randint(3, 5)
        self.axes += [Rotary(r)] * 3
        return [(axis, [axis], [0.0] * 6, self.axes[axis].targets(r, count, self.moved))]

    def most(self, share):
        """Waves a turn that the targets show."""
        targets = self.targets(self.axis[0])
        return max(1, int(share * (len(targets) - 1) / (1 if self.moved else 2) * 360 / np.ptp(targets)))

    def period(self, r, axis, sense):
        return 360.0 / round(r.log(1.0, self.most(0.9)))

    def grid(self, t):
        return [360.0 / k for k in range(1, self.most(1.0) + 1)] if t.id == "cyclic" else super().grid(t)

    def place_columns(self):
        return {f"{self.letter.lower()}_deg": self.at[:, self.axis[0]]}

    @functools.cached_property
    def library(self):
        axis = int(self.axis[0])
        ids = ["offset", "cyclic", "step", "time_drift"] + ["backlash", "reversal_curve"] * self.both
        terms = [Term(id, axis, axis) for id in ids] + [Term("cyclic", axis, axis, approach=way) for way in (1, -1) if self.both]
        return terms + [Term("thermal_drift", axis, axis, sensor=sensor) for sensor in self.sensors]


class Volume(Setup):
    """Lines along X, Y and Z at several places, in half of the sets body diagonals too: a reading there is the sum of the errors of all
    directions along it, with the approach that each axis has there, and the zero of each run is the set-up's."""
    motions = ()

    def __init__(self, r, wishes):
        super().__init__(r, wishes)
        self.shows |= {"feed": False, "travel": False}
        self.on_path = np.isin(self.line, list(self.diagonals))
        self.zeros = 1.0 * (self.run[:, None] == np.unique(self.run[self.on_path]))
        self.motions = [self.parted(axis) for axis in range(3)] if self.diagonals else ()

    def passes(self, r, wishes, count):
        self.layout, self.diagonals, passes = "volume", {}, []
        diagonals = r.randint(1, 4) * r.chance(0.5)
        senses = (0, 1, 2) if diagonals or r.chance(0.5) else sorted(r.sample(range(3), 2))
        targets = [axis.targets(r, r.randint(11, 15), self.moved) for axis in self.axes]
        for axis in range(3):
            for a, b in [(0, 0), (-1, 0), (0, -1)] + [(-1, -1)] * r.chance(0.4):
                parked = [targets[k][a if k == (axis + 1) % 3 else b] for k in range(3)]
                passes.append((axis, senses, parked, targets[axis]))
        for ways in r.sample(["PPP", "PNP", "PPN", "PNN"], diagonals):
            start, end = (np.array([of[0 if (way == "P") == first else -1] for of, way in zip(targets, ways)]) for first in (True, False))
            length = np.linalg.norm(end - start)
            ends = (" ".join(map(number, corner)) for corner in (start, end))
            self.diagonals[len(passes)] = f"diagonal {ways} from {' to '.join(ends)}", (end - start) / length
            passes.append((0, [0], lambda at, start=start, toward=(end - start) / length: np.round(start + at * toward, 4),
                           list(length * np.linspace(0, 1, r.randint(11, 15)))))
        return passes

    def parted(self, axis):
        """The readings as motions of this axis, along a diagonal one in each direction."""
        of, motions = np.repeat(np.arange(self.n), np.where(self.on_path, 3, 1)), copy.copy(self)
        for name, values in vars(self).items():
            if isinstance(values, np.ndarray) and len(values) == self.n:
                setattr(motions, name, values[of])
        motions.n, motions.kept, motions.m = len(of), {}, [m[of] for m in self.m]
        motions.sensors, motions.share = {name: degC[of] for name, degC in self.sensors.items()}, np.ones(len(of))
        motions.first = np.searchsorted(of, np.arange(self.n))
        for line, (_, toward) in self.diagonals.items():
            on = motions.line == line
            motions.axis[on], motions.sense[on] = axis, np.tile(range(3), on.sum() // 3)
            motions.approach[on] *= int(np.sign(toward[axis]))
            motions.share[on] = toward[motions.sense[on]]
        return motions

    def targets(self, axis, sense=None):
        return np.unique(self.at[(self.axis == axis) & ~self.on_path, axis])

    def place_columns(self):
        paths = {"path": [self.diagonals.get(line, [""])[0] for line in self.line]} if self.diagonals else {}
        return super().place_columns() | paths

    def columns(self, t, values=None, curve=CURVE, place=-1):
        if not self.motions:
            return super().columns(t, values, curve, place)
        motions = self.motions[t.axis]
        raw = Setup.columns(motions, t, values, curve) * motions.share[:, None]
        return np.moveaxis(np.add.reduceat(raw, motions.first, axis=1), -1, place)


class Kinds(Setup):
    """Positions in several runs; beside them one or two lines of straightness in one or two runs, with another instrument: other noise,
    and on other targets in half of the sets."""

    def __init__(self, r, wishes):
        super().__init__(r, wishes)
        self.relative = np.array(self.sizes)[self.line]

    def passes(self, r, wishes, count):
        self.layout, axis = "line", r.randint(0, 2)
        parked = [float(rounded(r.uniform(a.low, a.high), 10.0)) for a in self.axes]
        own = self.axes[axis].targets(r, r.randint(12, 31), self.moved)
        other = self.axes[axis].targets(r, r.randint(12, 31), self.moved) if r.chance(0.5) else own
        senses = r.sample([sense for sense in range(3) if sense != axis], r.randint(1, 2))
        self.sizes = [1.0] + [r.log(0.1, 6.0)] * len(senses)
        self.runs = [r.randint(3, 6)] + [r.randint(1, 2)] * len(senses)
        return [(axis, [axis], parked, own)] + [(axis, [sense], parked, other) for sense in senses]

    def runs_of(self, line, runs):
        return self.runs[line]

    def targets(self, axis, sense=None):
        return np.unique(self.at[(self.axis == axis) & ((self.sense == sense) | (sense is None)), axis])

    def positions(self, axis, sense):
        return self.targets(axis, sense)


class Days(Setup):
    """A machine that warms, read at one place in several runs, each with a clock of its own: cold on one day, warm on another. A body may
    follow its sensor late; it also followed it before the first reading of a run, which the file does not show."""
    SENSORS = ("t_spindle_degC", "t_column_degC", "t_hall_degC")

    def __init__(self, r, wishes):
        super().__init__(r, wishes)
        self.shows = dict.fromkeys(self.shows, False)

    def passes(self, r, wishes, count):
        self.layout, axis = "line", r.randint(0, 2)
        return [(axis, [axis], [float(rounded(r.uniform(a.low, a.high), 10.0)) for a in self.axes], [])]

    def travel_along(self, r, wishes, passes, runs):
        (axis, senses, parked, _), = passes
        self.both, self.readings, self.interval = False, r.randint(25, 60), 0.0
        self.interval = float(rounded(r.log(600.0, 10800.0) / self.readings, 1.0))
        self.take_rows([(axis, senses[0], 1, run, self.interval * k, 0.0, 0.0, 0.0, *parked, 0)
                        for run in range(1, r.randint(3, 9) + 1) for k in range(self.readings)])

    def add_climates(self, r, wishes):
        """Courses from a while before each run on: a spindle that heats itself, a column that it heats, the hall."""
        length = self.interval * self.readings
        earlier = math.ceil(r.uniform(0.5, 2.0) * self.readings)
        slow, spindle, column = r.uniform(0.3, 1.0) * length, r.uniform(0.1, 0.4) * length, r.uniform(0.4, 1.5) * length
        self.earlier, self.courses, self.warm, rest = earlier, {name: [] for name in self.SENSORS}, 0, r.uniform(17.0, 24.0)
        for _ in range(int(self.run[-1])):
            steps = earlier + self.readings
            hall = rest + r.uniform(-2.0, 2.0) + r.uniform(-1.0, 3.0) * (1 - np.exp(-np.arange(steps) * self.interval / slow))
            hall[:earlier] = hall[0] if (cold := r.chance(0.6)) else hall[:earlier]
            self.warm += not cold
            power = np.where(np.arange(steps) < (earlier if cold else 0), 0.0, r.uniform(3.0, 12.0))
            if r.chance(0.3):  # the spindle stops in the run
                power[earlier + int(r.uniform(0.4, 0.8) * self.readings):] = 0.0
            courses = self.low_pass(power, spindle), self.low_pass(hall + r.uniform(0.1, 0.4) * self.low_pass(power, spindle), column)
            for name, course in zip(self.SENSORS, (hall + courses[0], courses[1], hall)):
                self.courses[name].append(rounded(course, 0.01))
        self.pressure = self.humidity = 0 * self.time
        self.sensors = {name: np.concatenate([course[earlier:] for course in of]) for name, of in self.courses.items()}

    def low_pass(self, degC, lag_s):
        """First order, from a steady state at its first value, straight lines between the others; one row for each of several lags."""
        step = self.interval / np.maximum(lag_s, 1e-9)
        kept, mean = np.exp(-step), -np.expm1(-step) / step
        late = [degC[0] + 0 * step]
        for before, now in zip(degC, degC[1:]):
            late.append(kept * late[-1] + (mean - kept) * before + (1 - mean) * now)
        return np.stack(late, axis=-1)

    def columns(self, t, values=None, curve=CURVE, place=-1):
        if t.id != "thermal_drift":
            return super().columns(t, values, curve, place)
        lags = np.array([t.nonlinear] if values is None else values, float)
        key = t.sensor, *lags
        if key not in self.kept:
            self.kept[key] = np.concatenate([self.low_pass(course, lags)[:, self.earlier:] for course in self.courses[t.sensor]], axis=1)
        return np.stack([self.kept[key] - self.kept[key][:, :1]], axis=place)

    def grid(self, t):
        return [0.0, *np.geomspace(self.session / 30, self.session, 10)] if t.id == "thermal_drift" else super().grid(t)

    @functools.cached_property
    def library(self):
        axis = int(self.axis[0])
        return [Term(id, axis, axis) for id in ("offset", "time_drift", "warm_up")] + [
            Term("thermal_drift", axis, axis, sensor=sensor) for sensor in self.sensors]


@dataclasses.dataclass(frozen=True)
class Noise:
    law: str = "white"
    sigma: float = 1.0  # of a reading, rounding included
    correlation: float = 0.0  # of neighbours of a run, law ar
    step: float = 0.0  # of the display, law rounded

    @staticmethod
    def drawn(r, row):
        if row == "coarse" and r.chance(0.5):
            return Noise("rounded", r.log(0.35, 1.5), step=1.0)
        laws = ["heavy"] if row == "coarse" else ["white", "ar", "heavy"] if row.startswith("kinds") else ["white", "white", "rounded", "ar", "heavy", "outliers"] + ["ar"] * 6 * (row == "days")
        law, sigma = r.choice(laws), r.log(0.15, 2.0)
        return Noise(law, sigma, r.uniform(0.2, 0.75) * (law == "ar"), sigma * r.uniform(0.5, 2.0) * (law == "rounded"))

    def um(self, r, s):
        values = r.normals(s.n)
        if self.law == "heavy":  # Student's t of four degrees, of deviation one
            values /= np.sqrt(sum(r.normals(s.n) ** 2 for _ in range(4)) / 4) * math.sqrt(2)
        if self.law == "outliers":
            values *= np.array([6.0 if r.chance(0.015) else 1.0 for _ in range(s.n)])
        for k, before in enumerate(s.before if self.law == "ar" else []):
            if before >= 0:
                values[k] = self.correlation * values[before] + math.sqrt(1 - self.correlation**2) * values[k]
        return math.sqrt(self.sigma**2 - self.step**2 / 12) * values * s.relative


class Projector:
    """Least squares beside a base model: who can stand for whom, by projections; no list made by hand."""

    def __init__(self, s, noise, base):
        self.s, self.noise, self.log_n, self.kept = s, noise, math.log(s.n), {}
        white = self.whitened(np.hstack([s.zeros] + [s.free_columns(t) for t in base if not t.given]))
        left, values, _ = np.linalg.svd(white / np.maximum(np.linalg.norm(white, axis=0), 1e-300), full_matrices=False)
        self.base = left[:, values > 1e-7]

    def whitened(self, values):
        """Divided by sigma, the correlation inside runs taken out (Cochrane and Orcutt); readings are the last axis but one."""
        rho, before = self.noise.correlation, self.s.before
        values = values / self.s.relative[:, None]
        if not rho:
            return values / self.noise.sigma
        fresh = (values - rho * values[..., before, :]) / math.sqrt(1 - rho**2)
        return np.where((before >= 0)[:, None], fresh, values) / self.noise.sigma

    def beside_base(self, white):
        return white - self.base @ (self.base.T @ white)

    def rest(self, um):
        return self.beside_base(self.whitened(um[:, None]))[:, 0]

    def block(self, t, values):
        """The term's columns beside the base at each value (values × coefficients × readings), of length one unless its size is fixed,
        their lengths, how many are not zero, and inverse eigenvalues and eigenvectors of their products."""
        raw = self.s.columns(t, values, place=1)
        raw = np.swapaxes(self.whitened(np.swapaxes(raw, 1, 2)), 1, 2) if self.noise.correlation else raw / self.noise.sigma / self.s.relative
        own = raw.reshape(-1, self.s.n)
        lengths = np.sqrt(np.einsum("ij,ij->i", own, own))
        own = own - (own @ self.base) @ self.base.T
        size = np.sqrt(np.einsum("ij,ij->i", own, own))
        if (small := size < 0.01 * lengths).any():  # where digits were lost, once more
            own[small] -= (own[small] @ self.base) @ self.base.T
            size[small] = np.linalg.norm(own[small], axis=1)
        if t.id in FIXED:
            return own, None, np.zeros(len(own), int), None, None
        shows, size = size > 1e-6 * lengths, np.maximum(size, 1e-300)
        own = own * (shows / size)[:, None]
        if raw.shape[1] == 1:
            return own, size, shows, None, None
        own = own.reshape(raw.shape)
        eigen, vectors = np.linalg.eigh(own @ own.swapaxes(1, 2))
        kept = eigen > 1e-11
        return own, size, kept.sum(axis=1), kept / np.where(kept, eigen, 1.0), vectors

    def at(self, t, values, rest, keep=False):
        """What the term leaves at each value (chi²), and how many parameters it takes; keep: of these values its columns are."""
        if t not in self.kept or not keep:
            found = self.block(t, values)
            if keep:
                self.kept[t] = found
        own, size, count, inverse, vectors = self.kept[t] if keep else found
        count = count + (1 if t.id in NONLINEAR else 0)
        if t.id in FIXED:
            return np.sum((rest - own) ** 2, axis=1), count
        along = own @ rest
        if inverse is not None:
            return rest @ rest - np.sum((along[:, None] @ vectors)[:, 0] ** 2 * inverse, axis=1), count
        low, high = LIMITS.get(t.id, (-math.inf, math.inf))
        taken = np.clip(along, low * size, high * size)
        return rest @ rest + taken**2 - 2 * taken * along, count

    def best(self, t, rest):
        """(score, chi² left, parameters, term) at the best nonlinear parameter; nothing if it cannot be one or shows nothing."""
        tried = np.array(self.s.grid(t))
        if not len(tried) or not self.s.may_be_candidate(t):
            return None
        def least(values, keep=False):
            excess, count = self.at(t, values, rest, keep)
            score = np.round(excess + count * self.log_n, 6)  # equals, whatever the processor's rounding
            k = int(np.argmin(score))
            return float(score[k]), float(excess[k]), int(count[k]), t.but(nonlinear=float(values[k]))
        found, order = least(tried, keep=True), np.sort(tried)
        if len(order) > 1 and t.id not in self.s.of_grid:
            place = int(np.searchsorted(order, found[3].nonlinear))
            low, high = order[max(0, place - 1)], order[min(place + 1, len(order) - 1)]
            for _ in range(2):
                found = min(found, least(np.linspace(low, high, 14)[1:-1]), key=lambda one: one[0])
                width, middle = (high - low) / 13, found[3].nonlinear
                low, high = max(order[0], middle - width), min(order[-1], middle + width)
        return found if found[2] > (t.id in NONLINEAR and t.id not in FIXED) or t.id == "map_direction_swap" else None

    def ranked(self, rest, without=()):
        """The best of each name, best first."""
        found = {}
        for t in self.s.library:
            now = self.best(t, rest) if t.id not in without else None
            if now and (t.name not in found or now[0] < found[t.name][0]):
                found[t.name] = now
        return sorted(found.values(), key=lambda one: one[0])

    def parameters_of(self, t):
        return int(self.at(t, [t.nonlinear], np.zeros(self.s.n))[1][0])

    def rivals(self, truth, um, without=()):
        """(required, allowed, simplest); nothing where another effect is not clearly worse. Required reproduce it to within
        1/50 of the noise with no more parameters, allowed with more."""
        rest, own, required, allowed, simplest = self.rest(um), self.parameters_of(truth), [], [], True
        for t in self.s.library:
            other = self.best(t, rest) if t.name != truth.name and not {t.name, t.id} & {*without} else None
            if other and other[1] >= self.s.n * SAME**2 and other[1] + (other[2] - own) * self.log_n <= CLEAR:
                return None
            if other and other[1] < self.s.n * SAME**2 and t.name not in required + allowed:
                more = other[2] > own or t.id == "angular"  # of any shape, even where a parked axis shows one value only
                simplest = simplest and (more or other[2] == own)
                (allowed if more else required).append(t.name)
        return required, allowed, simplest
