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
    "avoid:Avoid.__init__": (343280, 1602587280, 0),
    "actuation.drive:Drive.__init__": (473680, 0, 0),
    "robot:Robot.step": (12689, 86235, 0),
    "perception.odometry:Odometry.advance": (2440, 288439, 0),
    "lidar:Lidar.poll": (7856, 4417, 9666),
    "perception.local_map:LocalMap.frame": (0, 26706, 2938),
    "perception.local_map:LocalMap.view": (9532, 2356, 475),
    "perception.windows:Windows.sort": (5563, 2626, 0),
    "avoid:Avoid.frame": (3330, 0, 0),
    "avoid:Avoid.guard": (27957, 0, 1084),
    "avoid:Avoid.step": (22019, 521671, 0),
    "avoid:Avoid.observe": (37076, 0, 0),
    "planner.collision:CollisionCheck.prepare": (2380, 0, 0),
    "planner.collision:CollisionCheck.check": (0, 0, 2960),
    "planner.move_cost:MoveCost.score": (11077, 93381, 0),
    "planner.move_cost:MoveCost.lower_bound": (0, 186829, 0),
    "planner.move_cost:MoveCost.best_first": (48270, 480319, 0),
    "planner.two_step:TwoStep.choose_first": (108169, 0, 0),
    "planner.two_step:TwoStep.try_second": (50282, 0, 0),
    "planner.cost_to_go:CostToGo.follow": (4850, 0, 0),
    "planner.cost_to_go:CostToGo.step": (427239, 0, 0),
    "actuation.drive:Drive.command": (3599, 0, 0),
    "actuation.drive:Drive.update": (27849, 0, 0),
    "actuation.drive:Drive.stop": (1660, 0, 0),
    "steering:Steering.solve": (42511, 0, 0),
    "actuation.outputs:Outputs.write": (10798, 109767, 0),
    "safety.health:Health.check": (18565, 0, 0),
    "link.link:Link.frame": (12027, 1016, 0),
    "link.link:Link.update": (31818, 233347, 0),
    "link.telemetry:Encoder.seal": (7557, 1072, 0),
    "link.serial_line:SerialLine.go_on": (5055, 42640, 0),
    "link.serial_line:SerialLine.take": (6082, 1067044, 0),
    "link.screen:Screen.update": (24370, 28224, 0),
    "core.start:build": (7325774, 0, 0),
    "perception.windows:Windows.sort_near": (2518, 1768, 0),
}
