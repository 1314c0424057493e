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
    "params.config:Config.__init__": (2210057, 0, 0),
    "avoid:Avoid.__init__": (345650, 1062353360, 0),
    "actuation.drive:Drive.__init__": (393225, 0, 0),
    "robot:Robot.step": (22274, 59837, 0),
    "perception.odometry:Odometry.advance": (2440, 288442, 0),
    "lidar:Lidar.poll": (8381, 4049, 10099),
    "perception.local_map:LocalMap.frame": (0, 41372, 2222),
    "perception.local_map:LocalMap.view": (9487, 2070, 508),
    "perception.windows:Windows.sort": (5416, 2632, 0),
    "avoid:Avoid.frame": (3330, 0, 0),
    "avoid:Avoid.guard": (27963, 345295, 850),
    "avoid:Avoid.step": (20338, 550370, 0),
    "avoid:Avoid.observe": (37204, 0, 0),
    "planner.collision:CollisionCheck.prepare": (2380, 0, 0),
    "planner.collision:CollisionCheck.check": (0, 29175, 2940),
    "planner.move_cost:MoveCost.score": (15070, 88946, 0),
    "planner.move_cost:MoveCost.lower_bound": (0, 185022, 0),
    "planner.move_cost:MoveCost.best_first": (46070, 454522, 0),
    "planner.two_step:TwoStep.choose_first": (135096, 0, 0),
    "planner.two_step:TwoStep.try_second": (0, 3064, 0),
    "planner.cost_to_go:CostToGo.follow": (5044, 0, 0),
    "planner.cost_to_go:CostToGo.step": (256705, 100426, 2614407),
    "actuation.drive:Drive.command": (6612, 0, 0),
    "actuation.drive:Drive.update": (29048, 0, 0),
    "actuation.drive:Drive.stop": (1701, 0, 0),
    "steering:Steering.solve": (42498, 0, 0),
    "actuation.outputs:Outputs.write": (13090, 181179, 0),
    "safety.health:Health.check": (11389, 0, 0),
    "link.link:Link.frame": (1804, 0, 0),
    "link.link:Link.update": (21155, 408283, 0),
    "link.telemetry:Encoder.seal": (7519, 976, 0),
    "link.serial_line:SerialLine.go_on": (5055, 42640, 0),
    "link.serial_line:SerialLine.take": (4345, 66772, 0),
    "link.screen:Screen.update": (2854, 27995, 19583),
    "core.start:build": (8922827, 0, 0),
    "perception.windows:Windows.sort_near": (3019, 1745, 0),
    "link.serial_line:SerialLine.idle": (1660, 0, 0),
    "link.telemetry:Decoder.add": (3625, 0, 0),
    "link.telemetry:Decoder.take": (1731, 10195, 0),
    "link.commands:Commands.obey": (19875, 0, 0),
    "link.messages:text": (4220, 560, 0),
    "link.messages:decision": (5545, 0, 0),
    "link.messages:wheels": (10400, 0, 0),
    "link.messages:points": (9031, 490, 0),
    "link.messages:health": (10120, 0, 0),
    "link.watched:candidates": (9567, 1689, 0),
    "link.watched:ScanGatherer.take": (4715, 560, 0),
    "link.watched:ScanGatherer.add": (9729, 1070, 0),
    "link.screen:crc16": (1938, 976, 0),
    "perception.scan_trust:ScanTrust.frame": (139521, 0, 0),
    "safety.safety:Safety.check": (19356, 0, 0),
    "goal.layer:Goal.frame": (8000, 44800, 0),
    "goal.layer:Goal.step": (2000, 160000, 4800),
    "link.screen:emit": (5615, 913, 0),
    "link.screen:box": (4531, 651, 57273),
    "link.screen:way": (11187, 0, 0),
}
