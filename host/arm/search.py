"""Planning: the genetic algorithm, then CMA-ES, then a look at what comes out on a grid ten times as dense.

What is given out is valid on the dense grid. The search looks at the nodes only, so what it misses between them is measured and kept as a guard for one more round.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from . import genetic, polish
from .problem import CLEARANCE, Found, Guard, Problem

METHODS = ("ga", "ga+cma", "cma")
DENSE = 10  # times as many intervals
_COARSE = 12  # intervals of a segment for the genetic algorithm that leads to a polish
_LEAD_GENERATIONS, _PAPER_GENERATIONS = 60, 300
_LOOK = 20  # generations of the polish between two looks at the dense grid
_LEAST, _STALE = 240, 120  # generations: it ends no earlier, and not while the last STALE of them were WORTH it
_SPARE = 1e-4  # added to a guard: share or rad
_SPARE_M = 2e-5
_WORTH = 0.0003  # of cost


@dataclass(frozen=True)
class Options:
    """method: of METHODS; limit_s: of searching; generations: None for 300 (ga) or 100 (before a polish)."""

    method: str = "ga+cma"
    selection: str = "tournament"
    seed: int = 0
    limit_s: float = 60.0
    population: int = 200
    generations: int | None = None
    crossover: float = 0.8
    mutation: float = 0.05
    clearance: float = CLEARANCE


@dataclass(frozen=True)
class Progress:
    """What is told while it searches: stage ("ga" or "cma"), generation in it, cost (with prices for what is broken) and Found of the best."""

    stage: str
    generation: int
    cost: float
    found: Found


@dataclass
class Plan:
    """genes: None if nothing valid was found. found: on the dense grid. broken_off: by Ctrl-C or the time limit. history: [(generation, cost, time, travel, path)]."""

    problem: Problem
    genes: np.ndarray | None
    found: Found | None
    seconds: float  # of the processor
    evaluations: int
    best_broken: Found  # what led at the end, valid or not
    broken_off: str = ""
    history: list = field(default_factory=list)
    way: tuple | None = None  # (corners, times) of `tree`, where nothing cheaper was found


class _Search:
    """One search: counts, keeps the best that is valid on the dense grid, and knows when to end."""

    def __init__(self, problem: Problem, options: Options, watch: Callable[[Progress], None] | None):
        self.problem = replace(problem, guard=Guard(options.clearance))
        self.options = options
        self.watch = watch
        self.began, self.began_working = time.monotonic(), time.process_time()
        self.evaluations = 0
        self.genes: np.ndarray | None = None
        self.found: Found | None = None
        self.history: list = []
        self.leading = problem.straight()  # the best so far of the stage, valid or not
        self.leading_cost = np.inf
        self.broken_off = ""

    def over(self) -> bool:
        if time.monotonic() - self.began > self.options.limit_s:
            self.broken_off = self.broken_off or "time"
        return bool(self.broken_off)

    def propose(self, genes: np.ndarray) -> Found:
        """Take genes (G,) for the best if they are valid on the dense grid, and cheaper than what there is."""
        found = self.problem.look(genes[None], self.problem.intervals * DENSE)
        if found.valid(self.options.clearance)[0] and (self.found is None or found.cost[0] < self.found.cost[0]):
            self.genes, self.found = genes.copy(), found
        return found

    def evolve(self, problem: Problem, judge, generations: int) -> np.ndarray:
        options = self.options
        settings = genetic.Settings(options.population, generations, options.crossover, options.mutation, options.selection, options.seed)

        def tell(generation: genetic.Generation) -> bool:
            self.evaluations += options.population
            f = generation.found
            better = generation.cost < self.leading_cost
            self._lead(generation.genes, generation.cost)
            if options.method == "ga" and better and f.valid(options.clearance)[0]:
                self.propose(generation.genes)
            self.history.append((generation.number, *(float(v[0]) for v in (f.cost, f.time, f.travel, f.path))))
            self._watch("ga", generation.number, generation.cost, f)
            return self.over()

        return genetic.evolve(problem, settings, judge, tell)

    def polish(self, problem: Problem, start: np.ndarray, **settings) -> None:
        """CMA-ES; every LOOK generations what leads is looked at on the dense grid, and the guard grows by what the nodes do not see."""
        self.leading_cost = np.inf  # the stage before looked at another grid
        lowest: list[float] = []

        def tell(genes, costs, found) -> Problem | None:
            nonlocal problem
            self.evaluations += len(genes)
            number = len(lowest) + 1
            k = int(np.argmin(costs))
            self._lead(genes[k], costs[k])
            lowest.append(self.leading_cost)
            if number % _LOOK == 0:
                nodes = problem.look(self.leading[None])
                self._watch("cma", number, self.leading_cost, nodes)
                dense = self.propose(self.leading)
                stale = number >= _LEAST and min(lowest[:-_STALE]) - self.leading_cost < _WORTH
                if stale and dense.valid(self.options.clearance)[0]:
                    return None
                if not dense.valid(self.options.clearance)[0]:
                    problem = replace(problem, guard=_missed(nodes, dense, self.options.clearance))
                    self.leading_cost = float(problem.led(problem.look(self.leading[None]))[0])
            return None if self.over() else problem

        polish.polish(problem, start, tell, self.options.seed, **settings)
        self.propose(self.leading)

    def _lead(self, genes, cost):
        if cost < self.leading_cost:
            self.leading, self.leading_cost = np.array(genes), float(cost)

    def _watch(self, stage, generation, cost, found):
        if self.watch is not None:
            self.watch(Progress(stage, generation, float(cost), found))


def plan(problem: Problem, options: Options, watch: Callable[[Progress], None] | None = None) -> Plan:
    """Search; Ctrl-C ends it and keeps the best so far. The Plan says whether there is a valid one."""
    search = _Search(problem, options, watch)
    try:
        if options.method == "ga":
            _paper(search)
        else:
            _led(search)
    except KeyboardInterrupt:
        search.broken_off = "Ctrl-C"
    if search.broken_off:
        search.propose(search.leading)  # what leads may be valid as it is
    seconds = time.process_time() - search.began_working
    broken = search.problem.look(search.leading[None], search.problem.intervals * DENSE)
    return Plan(search.problem, search.genes, search.found, seconds, search.evaluations, broken, search.broken_off, search.history)


def _paper(search: _Search) -> None:
    """The paper's algorithm alone: fitness 0 for what meets an obstacle. The cheapest that is valid on the dense grid is taken.

    What lies between two nodes of a path 3 m long is up to half a millimetre nearer to a disc of 0.35 m; the guard leaves room for it.
    """
    problem = replace(search.problem, guard=Guard(search.options.clearance + 0.001, 0.0005))
    for genes in search.evolve(problem, problem.strict, search.options.generations or _PAPER_GENERATIONS)[:20]:
        search.propose(genes)


def _led(search: _Search) -> None:
    options = search.options
    start, settings = search.problem.straight(), {"sigma": 0.2, "population": 40, "generations": 800}
    if options.method == "ga+cma":
        coarse = replace(search.problem, intervals=_COARSE)
        start, settings = search.evolve(coarse, coarse.led, options.generations or _LEAD_GENERATIONS)[0], {}
    if not search.over():
        search.polish(search.problem, start, **settings)


def _missed(nodes: Found, dense: Found, clearance: float) -> Guard:
    """A guard as large as what the nodes do not see of one trajectory."""
    return Guard(
        clearance + max(float(nodes.clearance[0] - dense.clearance[0]), 0) + _SPARE_M if np.isfinite(dense.clearance[0]) else clearance,
        max(float(dense.load[0] - nodes.load[0]), 0) + _SPARE,
        max(float(dense.speed[0] - nodes.speed[0]), 0) + _SPARE,
        max(float(dense.angle[0] - nodes.angle[0]), 0) + _SPARE,
    )
