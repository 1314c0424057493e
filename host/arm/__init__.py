"""A planar arm and its planner: python -m host.arm plan|check|play|home ...

The trajectory from one pose to another past obstacles is found by a genetic algorithm that weighs torque, joint travel, path and time (paper D: "obstacle-avoiding path
planning of a planar manipulator with a genetic algorithm", 2017), and polished by CMA-ES.

`model`       arm.json: joints, limits, servos                 `scenes`      obstacles and the paper's scenes
`kinematics`  forward and inverse                              `dynamics`    torques
`trajectory`  genes -> angles, speeds, accelerations           `clearance`   links against obstacles
`problem`     what a trajectory costs and breaks, for a whole population at once
`genetic`, `polish`, `search`   the genetic algorithm (DEAP), CMA-ES (cma), and the two of them in a row
`refuse`      what is impossible, said before anything is searched
`reach`       reach.json: a plan in a file                     `check`       an independent look at it
`cli`         the command line

Inside: metres, radians, seconds, kilograms. Files and command line: mm and degrees.
"""
