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
    "params.parse:fill": (1731800, 0, 0),
    "avoid:Avoid.__init__": (247490, 1557870480, 0),
    "actuation.drive:Drive.__init__": (384725, 0, 0),
    "robot:Robot.step": (10293, 158572, 0),
    "perception.odometry:Odometry.advance": (2300, 267086, 0),
    "lidar:Lidar.poll": (8074, 3868, 6461),
    "perception.local_map:LocalMap.frame": (45758, 0, 1835),
    "perception.local_map:LocalMap.view": (9513, 2321, 511),
    "perception.windows:Windows.sort": (9559, 2258, 0),
    "avoid:Avoid.frame": (2760, 0, 0),
    "avoid:Avoid.guard": (32047, 723988, 0),
    "avoid:Avoid.step|work": (18809, 1675810, 0),
    "avoid:Avoid.observe|watch": (12645, 0, 0),
    "planner.collision:CollisionCheck.prepare|aim": (6265, 0, 0),
    "planner.collision:CollisionCheck.check|test": (5164, 0, 2482),
    "planner.move_cost:MoveCost.score": (4510, 110070, 0),
    "planner.move_cost:MoveCost.lower_bound|promise": (12199, 154809, 0),
    "planner.move_cost:MoveCost.best_first|keep_promises": (22440, 299010, 0),
    "planner.cost_to_go:CostToGo.follow": (4412, 0, 0),
    "planner.cost_to_go:CostToGo.step|work": (368587, 0, 0),
    "actuation.drive:Drive.command": (6913, 0, 0),
    "actuation.drive:Drive.update": (2155, 435639, 0),
    "actuation.drive:Drive.stop": (1698, 0, 0),
    "steering:Steering.solve": (31077, 0, 0),
    "actuation.outputs:Outputs.write": (11193, 95848, 0),
    "safety.health:Health.check": (18335, 0, 0),
    "link.link:Link.frame": (15847, 852, 0),
    "link.link:Link.update": (34194, 323791, 1391),
    "link.telemetry:Encoder.seal": (9157, 1072, 0),
    "link.serial_line:SerialLine.update": (4558, 296385, 689),
    "link.serial_line:SerialLine.take": (4310, 4112270, 0),
    "core.start:build": (2302571, 0, 0),
}
