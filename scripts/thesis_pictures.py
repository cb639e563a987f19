"""Small SVG pictures for scripts/thesis: curves before and after compensation, circle, flat and cube of the mill."""
import csv
import math

BEFORE, AFTER = "#a03000", "#0050a0"
WORDS = ("not compensated", "compensated")
PANEL, HEIGHT, MARGIN = 360, 150, 46


def rows_of(path):
    with open(path) as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def svg(width, height, body):
    return (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" font-family="sans-serif" '
            f'font-size="11"><rect width="{width}" height="{height}" fill="white"/>{body}</svg>\n')


def text(x, y, words, anchor="middle"):
    return f'<text x="{x:.0f}" y="{y:.0f}" text-anchor="{anchor}">{words}</text>'


def line(points, colour, dashed=False, width=1.2):
    dash = ' stroke-dasharray="5 3"' if dashed else ""
    return (f'<polyline fill="none" stroke="{colour}" stroke-width="{width}"{dash} points="'
            + " ".join(f"{x:.1f},{y:.1f}" for x, y in points) + '"/>')


def panel(left, top, title, curves, x_range, y_range):
    """One frame; curves: [(points, colour, dashed)]."""
    (x0, x1), (y0, y1) = x_range, y_range
    wide, high = PANEL - MARGIN - 12, HEIGHT - 44

    def at(point):
        return (left + MARGIN + wide * (point[0] - x0) / (x1 - x0), top + 20 + high * (y1 - point[1]) / (y1 - y0))

    body = f'<rect x="{left + MARGIN}" y="{top + 20}" width="{wide}" height="{high}" fill="none" stroke="#b0b0b0"/>'
    body += text(left + MARGIN + wide / 2, top + 14, title)
    for value in (y0, y1):
        body += text(left + MARGIN - 4, at((x0, value))[1] + 4, f"{value:.3g}", "end")
    body += text(left + MARGIN, top + HEIGHT - 10, f"{x0:.4g}", "start")
    body += text(left + PANEL - 12, top + HEIGHT - 10, f"{x1:.4g}", "end")
    if y0 < 0 < y1:
        body += line([at((x0, 0)), at((x1, 0))], "#d0d0d0", width=0.8)
    for points, colour, dashed in curves:
        body += line([at(point) for point in points], colour, dashed)
    return body


def range_of(curves, axis):
    values = [point[axis] for points, *_ in curves for point in points]
    return (min(values), max(values)) if max(values) > min(values) else (min(values) - 1, max(values) + 1)


def lines(panels, most=600):
    """[(title, table, column of x, columns of y)], one below the other."""
    body = ""
    for index, (title, path, x, ys) in enumerate(panels):
        with open(path) as source:
            table = [row for row in csv.reader(row for row in source if not row.startswith("#"))][1:]
        table = [[float(cell) for cell in row] for row in table[::max(1, len(table) // most)]]
        curves = [([(row[x], row[y]) for row in table], colour, False) for y, colour in zip(ys, (BEFORE, AFTER))]
        body += panel(0, index * HEIGHT, title, curves, range_of(curves, 0), range_of(curves, 1))
    return svg(PANEL, HEIGHT * len(panels), body)


def means(path, colour, level):
    """Means over the runs at each target, forward and reverse (dashed); level: less the line through them [mm, um]."""
    sums = {}
    for row in rows_of(path):
        target = float(row[row["axis"].lower() + "_mm"])
        total = sums.setdefault((int(row["approach"]) < 0, target), [0.0, 0])
        total[0] += float(row["reading"])
        total[1] += 1
    points = sorted((reverse, target, total / count) for (reverse, target), (total, count) in sums.items())
    slope = middle = height = 0.0
    if level:
        middle = sum(p for _, p, _ in points) / len(points)
        height = sum(e for *_, e in points) / len(points)
        slope = (sum((p - middle) * (e - height) for _, p, e in points) / sum((p - middle) ** 2 for _, p, _ in points))
    return [([(p, e - height - slope * (p - middle)) for reverse, p, e in points if reverse == side], colour, side)
            for side in (False, True)]


def before_after(rows):
    """[(name, file before, file after)]: two panels a row, at one scale; without a file after, one. Straightness (EYX,
    EZX_y0, ...) loses its slope."""
    body = ""
    for index, (name, *files) in enumerate(rows):
        level = name[0] == "E" and name[1] in "XYZ" and name[1] != name[2]
        unit = "µm/m" if name[1] in "ABC" else "µm"
        curves = [means(path, colour, level) for path, colour in zip(files, (BEFORE, AFTER))]
        every = [curve for phase in curves for curve in phase]
        for column, (words, phase) in enumerate(zip(("before", "after"), curves)):
            body += panel(column * PANEL, index * HEIGHT, f"{name} {words} [{unit}] over mm", phase, range_of(every, 0),
                          range_of(every, 1))
    return svg(max(len(files) for _, *files in rows) * PANEL, HEIGHT * len(rows), body)


def circle(path, centre=(-2000.0, -500.0), radius=125.0, first_turn=8):
    """[(turn, angle, deviation from the least-squares circle in um)] of the track of samples/mill/circle_xz.nc."""
    found = []
    for row in rows_of(path):
        x, z = float(row["command_x_mm"]) - centre[0], float(row["command_z_mm"]) - centre[1]
        if abs(math.hypot(x, z) - radius) < 1e-6:
            angle = math.atan2(z, x)
            found.append((1 if int(row["line"]) == first_turn else 2, angle,
                          float(row["ex_um"]) * math.cos(angle) + float(row["ez_um"]) * math.sin(angle)))
    count = len(found)
    mean = sum(r for *_, r in found) / count
    shift_x = sum(2 * r * math.cos(a) for _, a, r in found) / count
    shift_z = sum(2 * r * math.sin(a) for _, a, r in found) / count
    return [(turn, a, r - mean - shift_x * math.cos(a) - shift_z * math.sin(a)) for turn, a, r in found]


def spread(points):
    return max(r for *_, r in points) - min(r for *_, r in points)


def polar(files, size=360, inner=80.0, um=2.0):
    """Figure 7.22: two polar plots, one division 10 um; of each degree the largest deviation."""
    body = ""
    for column, (path, colour) in enumerate(zip(files, (BEFORE, AFTER))):
        x0, y0 = column * size + size / 2, size / 2 + 8
        points = circle(path)
        for division in range(-3, 5):
            body += (f'<circle cx="{x0:.0f}" cy="{y0:.0f}" r="{inner + um * 10 * division:.0f}" fill="none" '
                     f'stroke="{"#909090" if division == 0 else "#d8d8d8"}"/>')
        body += text(x0, 14, f"{WORDS[column]}: out of round {spread(points):.0f} µm")
        for turn in (1, 2):
            largest = {}
            for side, angle, r in points:
                degree = int(math.degrees(angle) // 1)
                if side == turn and abs(r) >= abs(largest.get(degree, (0, 0))[1]):
                    largest[degree] = (angle, r)
            track = [largest[degree] for degree in sorted(largest)]
            body += line([(x0 + (inner + um * r) * math.cos(a), y0 - (inner + um * r) * math.sin(a))
                          for a, r in track + track[:1]], colour, turn == 2)
    return svg(2 * size, size + 8, body + text(size, size - 4, "1 division = 10 µm; dashed: the other way round"))


def flat(path, first_line=9, x_range=(-2950.0, -1150.0)):
    """[(x, z, deviation from the least-squares plane in um)] on the passes of samples/mill/flat_xz.nc."""
    points = [(float(row["command_x_mm"]), float(row["command_z_mm"]), float(row["ey_um"])) for row in rows_of(path)
              if int(row["line"]) >= first_line]
    points = [(x, z, e) for x, z, e in points if x_range[0] <= x <= x_range[1] and abs(z / 100 - round(z / 100)) < 1e-6]
    mx, mz, me = (sum(point[i] for point in points) / len(points) for i in range(3))
    xx, zz = sum((x - mx) ** 2 for x, _, _ in points), sum((z - mz) ** 2 for _, z, _ in points)
    xz = sum((x - mx) * (z - mz) for x, z, _ in points)
    xe, ze = sum((x - mx) * e for x, _, e in points), sum((z - mz) * e for _, z, e in points)
    in_x, in_z = (xe * zz - ze * xz) / (xx * zz - xz * xz), (ze * xx - xe * xz) / (xx * zz - xz * xz)
    return [(x, z, e - me - in_x * (x - mx) - in_z * (z - mz)) for x, z, e in points]


def surface(files, um=0.6):
    """Figure 7.23: the passes one behind the other, heights above the least-squares plane at one scale."""
    body = ""
    for column, (path, colour) in enumerate(zip(files, (BEFORE, AFTER))):
        points = flat(path)
        body += text(column * PANEL + PANEL / 2, 14, f"{WORDS[column]}: {spread(points):.0f} µm")
        for z in sorted({round(z / 100) for _, z, _ in points}):
            track = sorted((x, e) for x, at, e in points if round(at / 100) == z)[::12]
            left, base = column * PANEL + 20 + 8 * (-z - 1), 250 + 22 * z
            body += line([(left + (x + 2950) / 7.2, base + 60 - um * e) for x, e in track], colour)
    return svg(2 * PANEL, 320, body + text(PANEL, 312, "nine passes of 1800 mm, 100 mm apart; heights at one scale"))


def cube(corners):
    """Figures 7.20 and 7.21: the lengths of the error vectors at the corners of the working volume [um]."""
    body = ""
    travel = {axis: sorted({round(c["position_mm"][axis]) for c in corners[0]}) for axis in "XYZ"}
    for column, (phase, colour) in enumerate(zip(corners, (BEFORE, AFTER))):
        at = {}
        for corner in phase:
            x, y, z = (travel[axis].index(round(corner["position_mm"][axis])) for axis in "XYZ")
            at[x, y, z] = (column * PANEL + 60 + 190 * x + 60 * (1 - z), 210 - 110 * y - 55 * (1 - z))
        for one in at:
            for axis in range(3):
                other = tuple(1 if i == axis else one[i] for i in range(3))
                body += line([at[one], at[other]], "#909090", width=0.8) if one != other else ""
        for corner in phase:
            x, y, z = (travel[axis].index(round(corner["position_mm"][axis])) for axis in "XYZ")
            px, py = at[x, y, z]
            body += f'<circle cx="{px}" cy="{py}" r="3" fill="{colour}"/>'
            body += text(px + 6, py - 5, f"{corner['length_um']:.0f}", "start")
        body += text(column * PANEL + PANEL / 2, 14, "before [µm]" if column == 0 else "after [µm]")
    return svg(2 * PANEL, 250, body + text(
        PANEL, 242, "X to the right, Y up, Z out of the page; the datum is X 0, Y −1400, Z 0"))
