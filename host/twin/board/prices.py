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
    'params.config:Config.__init__': (2097730, 0, 0),
    'avoid:Avoid.__init__': (1101060, 1557398960, 0),
    'actuation.drive:Drive.__init__': (472615, 0, 0),
    'robot:Robot.step': (8720, 159710, 0),
    'perception.odometry:Odometry.advance': (2300, 267043, 0),
    'lidar:Lidar.poll': (8007, 4275, 9491),
    'perception.local_map:LocalMap.frame': (20939, 23068, 1977),
    'perception.local_map:LocalMap.view': (9521, 2330, 501),
    'perception.windows:Windows.sort': (3560, 2581, 0),
    'avoid:Avoid.frame': (7757, 0, 0),
    'avoid:Avoid.guard': (30835, 313946, 0),
    'avoid:Avoid.step|work': (157330, 0, 0),
    'avoid:Avoid.observe|watch': (37505, 0, 0),
    'planner.collision:CollisionCheck.prepare|aim': (6265, 0, 0),
    'planner.collision:CollisionCheck.check|test': (4224, 0, 2385),
    'planner.two_step:TwoStep.choose_first|pick': (72037, 0, 0),
    'planner.two_step:TwoStep.try_second|expand': (106417, 0, 0),
    'actuation.drive:Drive.command': (4926, 0, 0),
    'actuation.drive:Drive.update': (2155, 427450, 0),
    'actuation.drive:Drive.stop': (1767, 0, 0),
    'steering:Steering.solve': (42482, 0, 0),
    'actuation.outputs:Outputs.write': (11437, 103568, 0),
    'safety.health:Health.check': (18331, 0, 0),
    'link.link:Link.frame': (11953, 1045, 0),
    'link.link:Link.update': (25000, 296080, 0),
    'link.telemetry:Encoder.seal': (7557, 1072, 0),
    'link.serial_line:SerialLine.go_on': (4755, 42640, 0),
    'link.serial_line:SerialLine.take': (6076, 2286900, 0),
    'core.start:build': (1566340, 0, 0),
}
