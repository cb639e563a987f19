"""What several scripts of this folder use: each other as modules, and the interval of a share."""
import math
import os
import sys
from importlib import machinery, util


def script(name):
    """A script of this folder as a module."""
    loader = machinery.SourceFileLoader(name, os.path.join(os.path.dirname(os.path.abspath(__file__)), name))
    module = sys.modules[name] = util.module_from_spec(util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


def interval(right, count):
    """Clopper and Pearson 1934, 95 %, in percent, by bisection of the binomial sums."""
    def at_most(k, p):
        if p >= 1.0:
            return 0.0
        ways = (math.lgamma(count + 1) - math.lgamma(i + 1) - math.lgamma(count - i + 1) for i in range(k + 1))
        return sum(math.exp(way + i * math.log(p) + (count - i) * math.log1p(-p)) for i, way in enumerate(ways))

    def root(below):
        low, high = 0.0, 1.0
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if below(middle) else (low, middle)
        return 100 * low
    return (root(lambda p: 1 - at_most(right - 1, p) < 0.025) if right else 0.0,
            root(lambda p: at_most(right, p) > 0.025) if right < count else 100.0)
