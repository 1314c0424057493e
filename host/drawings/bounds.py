"""The drawing of candidates that are checked best first."""

import numpy as np
from matplotlib import pyplot

from . import style

_TYPICAL = 15  # checked candidates: with fewer there is nothing to see


def best_first(found, path):
    """Lower bounds of all candidates, best first, and what those cost that were checked. found: moments.BestFirst of some runs, of which one is drawn."""
    one = min(found, key=lambda moment: abs(int(moment.checked.sum()) - _TYPICAL))
    order = np.argsort(one.bounds, kind="stable")
    bounds, costs, checked = one.bounds[order], one.costs[order], one.checked[order]
    at = np.arange(1, len(order) + 1)
    seen = checked & np.isfinite(costs)
    shut = checked & ~np.isfinite(costs)
    best = costs[seen].min()
    pyplot.rcParams.update(style.RULES)
    figure, axes = pyplot.subplots(figsize=(8.4, 3.4), layout="constrained")
    axes.plot(at[~checked], bounds[~checked], ".", color=style.PALE, label="lower bound; never checked")
    axes.plot(at[checked], bounds[checked], ".", color=style.BLUE, label="lower bound, of those that were checked")
    axes.vlines(at[seen], bounds[seen], costs[seen], color=style.RED, linewidth=0.8)
    axes.plot(at[seen], costs[seen], ".", color=style.RED, label="what it costs with the points counted")
    if shut.any():
        axes.plot(at[shut], bounds[shut], "x", color=style.RED, label="checked: no way at all")
    axes.axhline(best, color=style.RED, linewidth=0.8, linestyle=":")
    axes.text(len(order), best, "the best ", color=style.RED, ha="right", va="bottom")
    axes.set(xlabel="candidates ahead, by their lower bounds", ylabel="cost, mm", xlim=(0, len(order) + 1))
    axes.set_title(f"{int(checked.sum())} of {len(order)} candidates had to be checked")
    axes.legend(loc="lower right", frameon=False)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    style.save(figure, path)
