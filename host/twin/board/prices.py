"""What the firmware's methods take on the ESP32, in instructions: fitted to executed ones by `python -m host.bench --calibrate --write`.

See charge.py for how they are charged, docs/bench.md for how they are counted.
"""

# Loading a module: `import avoid` of 22 November, with what it imports, took 1.5 s on the emulated chip at 8 ns an instruction.
IMPORT = 20000
IMPORT_BYTE = 3000  # of its .mpy
FILE_BYTE = 200  # of a file that is read as it is
COLLECT = 1000000  # a collection of garbage, or a question for the size of the heap, which takes as long

# {method: (a call, each of its first kind of work in 16ths, each of its second in 16ths)}
OF = {
    "params.config:Config.__init__": (2098266, 0, 0),
    "avoid:Avoid.__init__": (351500, 1569997840, 0),
    "actuation.drive:Drive.__init__": (472915, 0, 0),
    "robot:Robot.step": (12609, 89772, 0),
    "perception.odometry:Odometry.advance": (2300, 266957, 0),
    "lidar:Lidar.poll": (8329, 4076, 9420),
    "perception.local_map:LocalMap.frame": (23741, 22071, 1953),
    "perception.local_map:LocalMap.view": (9547, 2354, 476),
    "perception.windows:Windows.sort": (5385, 2643, 0),
    "avoid:Avoid.frame": (3330, 0, 0),
    "avoid:Avoid.guard": (30962, 0, 0),
    "avoid:Avoid.step": (19367, 650768, 0),
    "avoid:Avoid.observe": (37055, 0, 0),
    "planner.collision:CollisionCheck.prepare": (2380, 0, 0),
    "planner.collision:CollisionCheck.check": (26280, 220096, 0),
    "planner.move_cost:MoveCost.score": (16271, 100518, 0),
    "planner.move_cost:MoveCost.lower_bound": (489, 184604, 0),
    "planner.move_cost:MoveCost.best_first": (44577, 307755, 0),
    "planner.two_step:TwoStep.choose_first": (76551, 0, 0),
    "planner.two_step:TwoStep.try_second": (55549, 0, 0),
    "planner.cost_to_go:CostToGo.follow": (4879, 0, 0),
    "planner.cost_to_go:CostToGo.step": (438582, 0, 0),
    "actuation.drive:Drive.command": (4129, 0, 0),
    "actuation.drive:Drive.update": (14390, 230241, 0),
    "actuation.drive:Drive.stop": (1660, 0, 0),
    "steering:Steering.solve": (42522, 0, 0),
    "actuation.outputs:Outputs.write": (11821, 90487, 0),
    "safety.health:Health.check": (18646, 0, 0),
    "link.link:Link.frame": (11983, 1034, 0),
    "link.link:Link.update": (25547, 293112, 0),
    "link.telemetry:Encoder.seal": (7557, 1072, 0),
    "link.serial_line:SerialLine.go_on": (4755, 42640, 0),
    "link.serial_line:SerialLine.take": (6076, 2286900, 0),
    "link.screen:Screen.update": (10148, 33716, 0),
    "core.start:build": (1584507, 0, 0),
    "perception.windows:Windows.sort_near": (3299, 1695, 0),
}
