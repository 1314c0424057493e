"""The genetic algorithm of the paper, by DEAP: real coding, selection by tournament or roulette, crossover (blend), mutation (gaussian), the best one kept."""

import random
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from deap import base, creator, tools

from .problem import Found, Problem

SELECTIONS = ("tournament", "roulette")
_ALPHA = 0.5  # of the blend: children up to half a distance beyond their parents
_SIGMA = 0.1  # of the mutation, share of a gene's range
_TOURNAMENT = 3

creator.create("ArmCost", base.Fitness, weights=(-1.0,))
creator.create("ArmGenes", list, fitness=creator.ArmCost)


@dataclass(frozen=True)
class Settings:
    """The paper's by default."""

    population: int = 200
    generations: int = 300
    crossover: float = 0.8
    mutation: float = 0.05
    selection: str = "tournament"
    seed: int = 0


@dataclass(frozen=True)
class Generation:
    """What there is to tell of one generation: its number, genes and cost of the best, Found of the best alone."""

    number: int
    genes: np.ndarray
    cost: float
    found: Found


def evolve(problem: Problem, settings: Settings, judge: Callable[[Found], np.ndarray], tell: Callable[[Generation], bool]) -> np.ndarray:
    """Genes (P, G) of the last generation, the best first.

    judge: cost (P,) of a Found, infinite for fitness 0. tell: called with each Generation; True ends the search.
    """
    chance = random.Random(settings.seed)
    state = random.getstate()
    random.seed(chance.random())  # DEAP's operators use the module's own; it is put back at the end
    try:
        return _evolve(problem, settings, judge, tell, chance)
    finally:
        random.setstate(state)


def _evolve(problem, settings, judge, tell, chance):
    low, high = problem.bounds()
    spans = (high - low).tolist()
    lows, highs = low.tolist(), high.tolist()
    tools_of = base.Toolbox()
    tools_of.register("cross", tools.cxBlend, alpha=_ALPHA)
    tools_of.register("mutate", tools.mutGaussian, mu=[0.0] * len(spans), sigma=[_SIGMA * span for span in spans], indpb=settings.mutation)
    roulette = settings.selection == "roulette"
    people = [creator.ArmGenes(chance.uniform(a, b) for a, b in zip(lows, highs)) for _ in range(settings.population)]
    best = None
    for number in range(settings.generations + 1):
        genes = np.array(people)
        found = problem.look(genes)
        costs = judge(found)
        for one, cost in zip(people, costs):
            one.fitness.values = (float(cost),)
        k = int(np.argmin(costs))
        if best is not None and best.fitness.values[0] < costs[k]:  # the elite takes the worst one's place
            worst = int(np.argmax(costs))
            people[worst] = _copy(best)
            genes[worst] = best
        else:
            best = _copy(people[k])
        row = problem.look(np.array([best]))
        if tell(Generation(number, np.array(best), best.fitness.values[0], row)) or number == settings.generations:
            break
        people = [_copy(one) for one in _select(people, settings.population, roulette)]
        for one, other in zip(people[::2], people[1::2]):
            if random.random() < settings.crossover:
                tools_of.cross(one, other)
        for one in people:
            tools_of.mutate(one)
            for i, value in enumerate(one):
                one[i] = lows[i] if value < lows[i] else highs[i] if value > highs[i] else value
    return np.array(sorted(people, key=lambda one: one.fitness.values[0]))


def _select(people, count, roulette):
    if not roulette:
        return tools.selTournament(people, count, tournsize=_TOURNAMENT)
    # A wheel whose shares are the paper's fitness 1 / cost; DEAP's own takes the objective as the share, which would favour the expensive.
    shares = [1.0 / one.fitness.values[0] for one in people]
    return random.choices(people, shares, k=count) if sum(shares) > 0 else random.choices(people, k=count)


def _copy(one):
    other = creator.ArmGenes(one)
    other.fitness.values = one.fitness.values
    return other
