"""Adds up what the counted blocks cost; apart, as it is needed before any of the firmware is loaded."""

import micropython


@micropython.viper
def sum_counters(counters: ptr32, costs: ptr32, count: int) -> int:
    total = 0
    i = 0
    while i < count:
        n = counters[i]
        if n:
            total += n * costs[i]
        i += 1
    return total


@micropython.viper
def clear_counters(counters: ptr32, count: int):
    i = 0
    while i < count:
        counters[i] = 0
        i += 1
