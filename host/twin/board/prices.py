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
    "avoid:Avoid.__init__": (352060, 1602271520, 0),
    "actuation.drive:Drive.__init__": (473680, 0, 0),
    "robot:Robot.step": (12625, 87455, 0),
    "perception.odometry:Odometry.advance": (2440, 288453, 0),
    "lidar:Lidar.poll": (8346, 4051, 9591),
    "perception.local_map:LocalMap.frame": (22751, 22496, 1935),
    "perception.local_map:LocalMap.view": (9522, 2337, 494),
    "perception.windows:Windows.sort": (5700, 2616, 0),
    "avoid:Avoid.frame": (3330, 0, 0),
    "avoid:Avoid.guard": (12941, 288185, 1104),
    "avoid:Avoid.step": (21246, 582899, 0),
    "avoid:Avoid.observe": (37055, 0, 0),
    "planner.collision:CollisionCheck.prepare": (2380, 0, 0),
    "planner.collision:CollisionCheck.check": (5048, 9446, 2483),
    "planner.move_cost:MoveCost.score": (12024, 92563, 0),
    "planner.move_cost:MoveCost.lower_bound": (196798, 0, 0),
    "planner.move_cost:MoveCost.best_first": (44772, 300200, 0),
    "planner.two_step:TwoStep.choose_first": (80319, 0, 0),
    "planner.two_step:TwoStep.try_second": (52067, 0, 0),
    "planner.cost_to_go:CostToGo.follow": (4862, 0, 0),
    "planner.cost_to_go:CostToGo.step": (477281, 0, 0),
    "actuation.drive:Drive.command": (3944, 0, 0),
    "actuation.drive:Drive.update": (14345, 229525, 0),
    "actuation.drive:Drive.stop": (1699, 0, 0),
    "steering:Steering.solve": (42490, 0, 0),
    "actuation.outputs:Outputs.write": (11412, 101928, 0),
    "safety.health:Health.check": (18646, 0, 0),
    "link.link:Link.frame": (11983, 1034, 0),
    "link.link:Link.update": (27441, 289695, 0),
    "link.telemetry:Encoder.seal": (7557, 1072, 0),
    "link.serial_line:SerialLine.go_on": (4755, 42640, 0),
    "link.serial_line:SerialLine.take": (6076, 2286900, 0),
    "link.screen:Screen.update": (9826, 33740, 0),
    "core.start:build": (7303612, 0, 0),
    "perception.windows:Windows.sort_near": (3254, 1687, 0),
}
