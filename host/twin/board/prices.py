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
    "params.config:Config.__init__": (2159042, 0, 0),
    "avoid:Avoid.__init__": (336365, 1166662000, 0),
    "actuation.drive:Drive.__init__": (393225, 0, 0),
    "robot:Robot.step": (12584, 86762, 0),
    "perception.odometry:Odometry.advance": (2440, 288510, 0),
    "lidar:Lidar.poll": (7766, 4552, 9700),
    "perception.local_map:LocalMap.frame": (0, 28073, 2598),
    "perception.local_map:LocalMap.view": (9512, 2321, 511),
    "perception.windows:Windows.sort": (5395, 2635, 0),
    "avoid:Avoid.frame": (3330, 0, 0),
    "avoid:Avoid.guard": (27956, 348068, 818),
    "avoid:Avoid.step": (21163, 546835, 0),
    "avoid:Avoid.observe": (37104, 0, 0),
    "planner.collision:CollisionCheck.prepare": (2380, 0, 0),
    "planner.collision:CollisionCheck.check": (0, 45128, 2720),
    "planner.move_cost:MoveCost.score": (15330, 86571, 0),
    "planner.move_cost:MoveCost.lower_bound": (0, 187692, 0),
    "planner.move_cost:MoveCost.best_first": (48784, 475334, 0),
    "planner.two_step:TwoStep.choose_first": (145108, 0, 0),
    "planner.two_step:TwoStep.try_second": (50882, 0, 0),
    "planner.cost_to_go:CostToGo.follow": (5058, 0, 0),
    "planner.cost_to_go:CostToGo.step": (301531, 77630, 2490563),
    "actuation.drive:Drive.command": (6295, 0, 0),
    "actuation.drive:Drive.update": (27580, 0, 0),
    "actuation.drive:Drive.stop": (1661, 0, 0),
    "steering:Steering.solve": (42462, 0, 0),
    "actuation.outputs:Outputs.write": (10531, 105516, 0),
    "safety.health:Health.check": (18246, 0, 0),
    "link.link:Link.frame": (1805, 0, 0),
    "link.link:Link.update": (20750, 411630, 0),
    "link.telemetry:Encoder.seal": (7557, 1072, 0),
    "link.serial_line:SerialLine.go_on": (5055, 42640, 0),
    "link.serial_line:SerialLine.take": (4345, 66772, 0),
    "link.screen:Screen.update": (5465, 5120, 1335755),
    "core.start:build": (7307859, 0, 0),
    "perception.windows:Windows.sort_near": (3004, 1720, 0),
    "link.serial_line:SerialLine.idle": (1660, 0, 0),
    "link.telemetry:Decoder.add": (3625, 0, 0),
    "link.telemetry:Decoder.take": (1731, 11441, 0),
    "link.commands:Commands.obey": (19840, 0, 0),
    "link.messages:text": (4220, 560, 0),
    "link.messages:decision": (5545, 0, 0),
    "link.messages:wheels": (10400, 0, 0),
    "link.messages:points": (9031, 490, 0),
    "link.messages:health": (10430, 0, 0),
    "link.watched:candidates": (9898, 4493, 0),
    "link.watched:ScanGatherer.take": (4715, 560, 0),
    "link.watched:ScanGatherer.add": (9730, 1070, 0),
    "link.screen:crc16": (3, 1933, 0),
}
