"""What serves bench/judge and who uses its cases: draws, the methods that it holds the program beside, its table.

The methods are those that a user may have at hand. Each chooses among the same columns beside the same base model, with sigma
known. A candidate is one effect at one value of its nonlinear parameter: a name and its columns, without what the base takes, each
divided by its length. `rest` are the readings without what the base takes, in units of the noise. Every method returns names.
"""
import math
import os
import random

os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np  # noqa: E402

from common import interval  # noqa: E402


class Draw(random.Random):
    def log(self, low, high):
        return low * (high / low) ** self.random()

    def chance(self, share):
        return self.random() < share

    def signed(self, low, high):
        return (1.0 if self.chance(0.5) else -1.0) * self.uniform(low, high)

    def normals(self, count):
        return np.array([self.gauss(0.0, 1.0) for _ in range(count)])


def number(value):
    """Always with a decimal point, as TOML tells numbers from integers; a text as it is."""
    return value if isinstance(value, str) else repr(round(float(value), 6) + 0.0)


def rounded(value, step):
    return (round(value / step, 0) if isinstance(value, float) else np.round(value / step)) * step  # of one number ten times as fast


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


def chosen_by_bic(path, rest):
    """Of several sets of columns (positions) the one whose least squares has the least chi² + parameters · ln n."""
    best, names = rest @ rest, []
    for columns, of in path:
        left = rest - columns @ np.linalg.lstsq(columns, rest, rcond=None)[0] if columns.shape[1] else rest
        score = left @ left + columns.shape[1] * math.log(len(rest))
        if score < best:
            best, names = score, sorted({*of})
    return names


def with_columns(candidates, kept):
    """(columns, names) of the candidates whose places are given."""
    some = [candidates[k] for k in kept]
    return (np.hstack([columns for _, columns in some]) if some else np.zeros((0, 0))), [name for name, _ in some]


def lasso(candidates, rest, steps=20, rounds=20):
    """Group lasso (Yuan and Lin 2006) by block descent over falling penalties; the set by BIC of its least squares."""
    left, sizes, path = rest.copy(), [np.zeros(columns.shape[1]) for _, columns in candidates], []
    most = max((np.linalg.norm(columns.T @ rest) / math.sqrt(columns.shape[1]) for _, columns in candidates), default=0.0)
    for penalty in most * np.geomspace(1.0, 0.02, steps):
        for _ in range(rounds):
            moved = 0.0
            for k, (_, columns) in enumerate(candidates):
                step = 1.0 / columns.shape[1]  # columns have length 1: the greatest eigenvalue is at most their number
                wanted = sizes[k] + step * (columns.T @ left)
                length = np.linalg.norm(wanted)
                new = wanted * max(0.0, 1.0 - step * penalty * math.sqrt(columns.shape[1]) / max(length, 1e-300))
                if np.any(new != sizes[k]):
                    left -= columns @ (new - sizes[k])
                    moved, sizes[k] = max(moved, float(np.abs(new - sizes[k]).max())), new
            if moved < 1e-4:
                break
        kept = [k for k, size in enumerate(sizes) if np.any(size)]
        if len({candidates[k][0] for k in kept}) > 8:
            break
        path.append(with_columns(candidates, kept))
    return chosen_by_bic([one for one in path if one[1]], rest)


def ridge(candidates, rest):
    """Ridge over all columns, penalty by generalized cross-validation (Golub, Heath and Wahba 1979); named is what has a
    size of more than three of its standard deviations, Bonferroni over the columns."""
    columns, names = with_columns(candidates, range(len(candidates)))
    if not names:
        return []
    left, values, right = np.linalg.svd(columns, full_matrices=False)
    along, n, best = left.T @ rest, len(rest), None
    for penalty in np.geomspace(1e-6, 1e3, 40):
        shrink = values**2 / (values**2 + penalty)
        lost = rest @ rest - np.sum((2 * shrink - shrink**2) * along**2)
        score = lost / (n - shrink.sum()) ** 2
        if best is None or score < best[0]:
            best = score, penalty
    gain = values / (values**2 + best[1])
    sizes, sigma = right.T @ (gain * along), np.sqrt(np.sum((right.T * gain) ** 2, axis=1))
    limit = math.sqrt(2.0 * math.log(max(2, 20 * columns.shape[1])))  # of so many normal variables, one in twenty sets
    of = np.repeat(names, [block.shape[1] for _, block in candidates])
    return sorted({str(name) for name, size, one in zip(of, sizes, sigma) if abs(size) > limit * one})


def sparse_regression(candidates, rest):
    """Sequentially thresholded least squares (Brunton, Proctor and Kutz 2016), a little ridge in it; the threshold by BIC."""
    path = []
    for threshold in np.geomspace(1.0, 0.02, 12) * np.linalg.norm(rest):
        kept = list(range(len(candidates)))
        for _ in range(10):
            columns, _ = with_columns(candidates, kept)
            if not kept:
                break
            sizes = np.linalg.solve(columns.T @ columns + 1e-3 * np.eye(columns.shape[1]), columns.T @ rest)
            ends = np.cumsum([candidates[k][1].shape[1] for k in kept])[:-1]
            again = [k for k, size in zip(kept, np.split(sizes, ends)) if np.linalg.norm(size) > threshold]
            if again == kept:
                break
            kept = again
        if kept and len(kept) <= 8:
            path.append(with_columns(candidates, kept))
    return chosen_by_bic(path, rest)


CLEAR_SNR = 3.0
RIVALS = {"lasso": lasso, "ridge": ridge, "sparse": sparse_regression}


def f_tail(f, k, v):
    """The chance that F(k, v) exceeds f: a beta integral, its variable sin².
    >>> [round(f_tail(*one), 4) for one in ((4.9646, 1, 10), (3.3258, 5, 10), (99.0, 2, 2), (0.0, 3, 4))]
    [0.05, 0.05, 0.01, 1.0]
    """
    angle = np.linspace(0.0, math.pi / 2, 20001)
    density = np.sin(angle) ** (v - 1) * np.cos(angle) ** (k - 1)
    below = np.concatenate([[0.0], np.cumsum(density[1:] + density[:-1])])
    return float(np.interp(math.asin(math.sqrt(v / (v + k * f))), angle, below) / below[-1])


def distance(some):
    """To the oracle on the same cases in points, with its 95 % interval (Agresti and Min 2005)."""
    n, lost, won = len(some), *(sum(one["oracle"] == oracle and one["right"] != oracle for one in some) for oracle in (True, False))
    middle, spread = (lost - won) / (n + 2), math.sqrt(lost + won + 1 - (lost - won) ** 2 / (n + 2)) / (n + 2)
    return f"{100 * (lost - won) / n:.1f} ({100 * (middle - 1.96 * spread):.1f} to {100 * (middle + 1.96 * spread):.1f})"


def report(order, results):
    others = ["oracle", *(name for name in ("blind", "stepwise", *RIVALS) if any(name in one for one in results))]
    print(f"{'row':<18}{'right':>10}{'%':>7}{'95 % interval':>16}{'behind the oracle':>21}"
          f"{''.join(f'{name:>10}' for name in others)}{'named':>7}{'median s':>10}{'worst s':>9}")
    rows = {row: [one for one in results if one["row"] == row and "right" in one] for row in order}
    for row, some in ((row, some) for row, some in rows.items() if some):
        right, named, *counts = (sum(one[key] for one in some) for key in ("right", "named", *others))
        low, high = interval(right, len(some))
        seconds = sorted(one["seconds"] for one in some)
        print(f"{row:<18}{f'{right}/{len(some)}':>10}{100 * right / len(some):>7.1f}{f'{low:.1f} to {high:.1f}':>16}{distance(some):>21}"
              f"{''.join(f'{count:>10}' for count in counts)}{named:>7}{seconds[len(seconds) // 2]:>10.2f}{seconds[-1]:>9.2f}")
    print(f"\nBehind the oracle where the ratio of signal to noise is under {CLEAR_SNR:g}, and from there on:")
    for row, some in rows.items():
        unclear, clear = ([one for one in some if (one.get("snr", 0.0) >= CLEAR_SNR) == is_clear] for is_clear in (False, True))
        if unclear and clear:
            print(f"{row:<18}{distance(unclear):>21} of {len(unclear)}{distance(clear):>21} of {len(clear)}")
    print("\nBy kind:")
    for row, some in ((row, some) for row, some in rows.items() if any(one["kind"] for one in some)):
        kinds = {kind: [one["right"] for one in some if one["kind"] == kind] for kind in sorted({one["kind"] for one in some})}
        print(*[f"{row}:"] + [f"{kind} {sum(rights)}/{len(rights)}" for kind, rights in kinds.items()], sep="  ")
    print("\nWrong:", *(one["line"] for one in results if not one.get("right")), sep="\n")
