"""CMA-ES (the library cma) from what the genetic algorithm has found."""

from collections.abc import Callable

import cma
import numpy as np

from .problem import Found, Problem

_SIGMA = 0.06  # of a gene's range


def polish(
    problem: Problem,
    genes: np.ndarray,
    tell: Callable[[np.ndarray, np.ndarray, Found], Problem | None],
    seed: int,
    population: int = 16,
    generations: int = 400,
    sigma: float = _SIGMA,
) -> None:
    """tell: called with genes (P, G), their costs and Found of each generation; returns the Problem to go on with (its guard may have been widened), None ends the search."""
    low, high = problem.bounds()
    span = high - low
    start = np.clip((genes - low) / span, 0, 1)
    options = {"popsize": population, "seed": seed % 2**31 + 1, "verbose": -9, "bounds": [0, 1], "maxiter": generations, "tolfun": 1e-6, "tolx": 1e-7}
    strategy = cma.CMAEvolutionStrategy(start.tolist(), sigma, options)
    going: Problem | None = problem
    while going is not None and not strategy.stop():
        scaled = strategy.ask()
        tried = low + np.array(scaled) * span
        found = going.look(tried)
        costs = going.led(found)
        strategy.tell(scaled, costs.tolist())
        going = tell(tried, costs, found)
