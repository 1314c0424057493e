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
    "params.config:Config.__init__": (2159131, 0, 0),
    "avoid:Avoid.__init__": (339035, 1166662000, 0),
    "actuation.drive:Drive.__init__": (393225, 0, 0),
    "robot:Robot.step": (12598, 86744, 0),
    "perception.odometry:Odometry.advance": (2440, 288477, 0),
    "lidar:Lidar.poll": (7862, 4461, 9689),
    "perception.local_map:LocalMap.frame": (0, 27517, 2656),
    "perception.local_map:LocalMap.view": (9515, 2340, 492),
    "perception.windows:Windows.sort": (5548, 2625, 0),
    "avoid:Avoid.frame": (3330, 0, 0),
    "avoid:Avoid.guard": (27956, 350199, 820),
    "avoid:Avoid.step": (22841, 554681, 0),
    "avoid:Avoid.observe": (37076, 0, 0),
    "planner.collision:CollisionCheck.prepare": (2380, 0, 0),
    "planner.collision:CollisionCheck.check": (0, 0, 3081),
    "planner.move_cost:MoveCost.score": (5942, 101514, 0),
    "planner.move_cost:MoveCost.lower_bound": (0, 185448, 0),
    "planner.move_cost:MoveCost.best_first": (49210, 460513, 0),
    "planner.two_step:TwoStep.choose_first": (149431, 0, 0),
    "planner.two_step:TwoStep.try_second": (50264, 0, 0),
    "planner.cost_to_go:CostToGo.follow": (4843, 0, 0),
    "planner.cost_to_go:CostToGo.step": (425511, 0, 0),
    "actuation.drive:Drive.command": (6655, 0, 0),
    "actuation.drive:Drive.update": (27714, 0, 0),
    "actuation.drive:Drive.stop": (1666, 0, 0),
    "steering:Steering.solve": (42498, 0, 0),
    "actuation.outputs:Outputs.write": (10524, 106551, 0),
    "safety.health:Health.check": (18265, 0, 0),
    "link.link:Link.frame": (12029, 1014, 0),
    "link.link:Link.update": (31770, 236534, 0),
    "link.telemetry:Encoder.seal": (7557, 1072, 0),
    "link.serial_line:SerialLine.go_on": (5055, 42640, 0),
    "link.serial_line:SerialLine.take": (6082, 1067044, 0),
    "link.screen:Screen.update": (24688, 27759, 0),
    "core.start:build": (7310080, 0, 0),
    "perception.windows:Windows.sort_near": (4087, 1591, 0),
}
