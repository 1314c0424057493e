"""python -m host.arm plan: from options to reach.json."""

import json
import math
import sys
import time
from dataclasses import replace

from . import model, reach, refuse, scenes, search, tree
from .errors import ArmError
from .problem import Problem

_OTHER_WAYS = 4  # pairs of branches tried, at most
_SECOND_NODES = 2  # between start and end, where the wanted number does not do


def prepare(options) -> tuple[model.Arm, scenes.Scene, list]:
    """(arm, scene with poses and obstacles, [(start, end)] in joint angles, the most promising first). ArmError where it is impossible."""
    arm = model.load(options.arm)
    scene = scenes.scene(options.scene) if options.scene else scenes.Scene("own")
    obstacles = [*scene.obstacles]
    obstacles += [scenes.disc(v, "--obstacle") for v in options.obstacle]
    obstacles += [scenes.box(v, "--box") for v in options.box]
    obstacles += [scenes.half_plane(v, "--half-plane") for v in options.half_plane]
    if options.floor:
        obstacles.append(scenes.half_plane([0, options.floor[0], 90], "--floor"))
    clear = options.clearance / 1000
    starts, start = _place(arm, "start", options.start, options.from_joints, scene.start, obstacles, clear, "--from")
    ends, end = _place(arm, "end", options.end, options.to_joints, scene.end, obstacles, clear, "--to")
    return arm, replace(scene, obstacles=tuple(obstacles), start=start, end=end), refuse.pairs(arm, starts, ends)


def _place(arm, where, given, joints, of_scene, obstacles, clear, option):
    """(joint angles of each branch, pose)."""
    from .kinematics import pose

    if joints is not None:
        found = refuse.joints(arm, where, joints, obstacles, clear)
        return found, pose(arm, found[0])
    wanted = (given[0] / 1000, given[1] / 1000, math.radians(given[2])) if given else of_scene
    if wanted is None:
        raise ArmError(f"no {where}: give {option} X,Y,ANGLE or {option}-joints Q,.. or a --scene")
    return refuse.place(arm, where, wanted, obstacles, clear), wanted


def find(arm, obstacles, pairs, options: search.Options, nodes: int = 1, watch=None) -> search.Plan:
    """A Plan of the first pair of branches for which one is found, with more nodes where the wanted number does not do; else by a way that a tree finds, which is valid but
    not cheap; genes and way None if there is none."""
    last: search.Plan | None = None
    seconds, evaluations = 0.0, 0
    tries = [(pair, nodes) for pair in pairs[:_OTHER_WAYS]]
    tries[1:1] = [(pairs[0], max(nodes, _SECOND_NODES))] if nodes < _SECOND_NODES else []
    for (start, end), count in tries:
        problem = Problem(arm, start, end, tuple(obstacles), count)
        found = search.plan(problem, replace(options, limit_s=max(options.limit_s - seconds, 0.05)), watch)
        seconds, evaluations = seconds + found.seconds, evaluations + found.evaluations
        found.seconds, found.evaluations = seconds, evaluations
        if last is None or found.genes is not None:
            last = found
        if found.genes is not None or found.broken_off or options.method == "ga":
            break
    assert last is not None
    if last.genes is None and not last.broken_off and options.method != "ga":
        began = time.process_time()
        for k, (start, end) in enumerate(pairs[:_OTHER_WAYS]):
            corners = tree.way(arm, obstacles, start, end, options.seed + k, options.clearance)
            times = None if corners is None else tree.timed(arm, corners)
            if times is not None:
                last.way = corners, times
                break
        seconds += time.process_time() - began
    last.seconds, last.evaluations = seconds, evaluations
    return last


def as_reach(plan: search.Plan, told: dict) -> reach.Reach:
    """The Reach of a Plan that found something."""
    return tree.as_reach(plan.problem, plan.way, told) if plan.way is not None else reach.of_plan(plan.problem, plan.genes, plan.found, told)


def run(options) -> int:
    """The exit code."""
    arm, scene, pairs = prepare(options)
    settings = search.Options(
        options.method, options.selection, options.seed, options.limit_time, options.population, options.generations, options.crossover, options.mutation,
        options.clearance / 1000,
    )  # fmt: skip
    plan = find(arm, scene.obstacles, pairs, settings, options.nodes, None if options.json else tell)
    if not options.json:
        print(file=sys.stderr)
    if plan.genes is None and plan.way is None:
        return _nothing(plan, options)
    told = {"seconds": round(plan.seconds, 3), "method": options.method, "selection": options.selection, "seed": options.seed, "scene": scene.name}
    if plan.broken_off:
        told["broken_off"] = plan.broken_off
    found = as_reach(plan, told)
    if options.out:
        reach.write(found, options.out)
    if options.csv:
        reach.write_csv(found, options.csv)
    if options.picture:
        from .picture import draw

        draw(found, options.picture)
    if options.json:
        print(json.dumps(found.told))
    else:
        print(words(found.told) + (f"; broken off by {plan.broken_off}: the best so far" if plan.broken_off else ""))
        for path in (options.out, options.csv, options.picture):
            if path:
                print(f"written: {path}")
    return 0


def _nothing(plan, options) -> int:
    why = _broken(plan)
    if plan.broken_off:
        why = f"broken off by {plan.broken_off}; {why}"
    if options.json:
        print(json.dumps({"found": False, "why": why, "seconds": round(plan.seconds, 3)}))
    print(f"python -m host.arm: no valid trajectory found in {plan.seconds:.1f} s: {why}", file=sys.stderr)
    return 1


def _broken(plan) -> str:
    """What the best that was found still breaks."""
    return "the best one " + (violations(plan.best_broken, plan.problem) or "is valid on the planner's grid only")


def violations(found, problem) -> str:
    """What a Found of one trajectory violates, in words; "" if nothing."""
    parts = []
    clear = float(found.clearance[0])
    wanted = problem.guard.clearance
    if clear < wanted:
        parts.append(f"is {-1000 * clear:.1f} mm inside an obstacle" if clear < 0 else f"comes within {1000 * clear:.1f} mm of an obstacle")
    if found.load[0] > 1:
        parts.append(f"needs {100 * found.load[0]:.0f} % of a joint's torque")
    if found.speed[0] > 0:
        parts.append(f"turns a joint {math.degrees(found.speed[0]):.1f} deg/s too fast")
    if found.angle[0] > 0:
        parts.append(f"leaves a joint's limits by {math.degrees(found.angle[0]):.1f} deg")
    return ", ".join(parts)


def tell(progress: search.Progress) -> None:
    """One line of progress, written over."""
    if progress.generation % 10 and progress.stage == "ga":
        return
    found = progress.found
    parts = []
    if found.clearance[0] < 0:
        parts.append(f"{-1000 * found.clearance[0]:.0f} mm inside an obstacle")
    if found.load[0] > 1:
        parts.append(f"torque {100 * found.load[0]:.0f} %")
    if found.angle[0] > 0 or found.speed[0] > 0:
        parts.append("limits")
    line = f"{progress.stage} {progress.generation:4d}   cost {progress.cost:8.3f}   {', '.join(parts) or 'nothing violated'}"
    print(f"\r{line:<78}" if sys.stderr.isatty() else line, end="" if sys.stderr.isatty() else "\n", file=sys.stderr, flush=True)


def words(figures: dict) -> str:
    """The figures in one line."""
    clear = "no obstacle" if figures["clearance_m"] is None else f"clearance {1000 * figures['clearance_m']:.1f} mm"
    took = f", planned in {figures['seconds']:.2f} s" if "seconds" in figures else ""
    return (
        f"cost {figures['cost']:.2f}: {figures['time_s']:.2f} s, joint travel {figures['travel_rad']:.3f} rad, path {figures['path_m']:.3f} m, {clear}, "
        f"torque over its limit {figures['torque_over_nm']:g} N m{took}"
    )
