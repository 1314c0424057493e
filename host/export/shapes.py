"""What the robot says, in Foxglove's schemas. Arguments are in the robot's units (mm, degrees, heading clockwise from +y)."""

import struct
from math import cos, pi, radians, sin

from host.twin.console import WINDOWS

from . import ExportError, frames

try:
    from foxglove_schemas_protobuf.FrameTransform_pb2 import FrameTransform
    from foxglove_schemas_protobuf.LaserScan_pb2 import LaserScan
    from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
    from foxglove_schemas_protobuf.Log_pb2 import Log
    from foxglove_schemas_protobuf.PackedElementField_pb2 import PackedElementField
    from foxglove_schemas_protobuf.PointCloud_pb2 import PointCloud
    from foxglove_schemas_protobuf.PoseInFrame_pb2 import PoseInFrame
    from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
except ImportError as error:
    raise ExportError(f"{error.name} is not installed: pip install 'gapseeker[export]' (or .venv/bin/pip install -e '.[export]')") from None

_COLOURS = {"none": (160, 160, 160), "green": (40, 190, 80), "red": (230, 50, 50), "blue": (60, 120, 240), "yellow": (240, 200, 40)}
_POINT = struct.Struct("<ffBBBBB3x")
_POINT_FIELDS = (("x", 0), ("y", 4), ("red", 8), ("green", 9), ("blue", 10), ("alpha", 11), ("window", 12))
_LEVELS = (Log.INFO, Log.WARNING, Log.ERROR)
_HEIGHT = 0.1  # m, of the body in the picture
_WALL = 0.02  # m
_EDGE, _PLAN, _PLAN_COLOUR = 0.004, 0.012, (0.83, 0.25, 0.84)  # m, m, magenta as on the robot's screen
_WHEEL = 0.065, 0.03, 0.065  # m, drawn


def laser_scan(ranges: list[float], signals: list[float], x: float, y: float) -> LaserScan:
    """One revolution of a lidar at (x, y) of the body; ranges in m, evenly spaced counter-clockwise from -pi."""
    last = -pi + 2 * pi * (len(ranges) - 1) / max(len(ranges), 1)
    scan = LaserScan(frame_id="body", start_angle=-pi, end_angle=last, ranges=ranges, intensities=signals)
    _place(scan.pose, *frames.body_point(x, y))
    return scan


def pose(frame: str, x: float, y: float, heading: float) -> PoseInFrame:
    """The body in a frame."""
    message = PoseInFrame(frame_id=frame)
    _place(message.pose, *frames.world_point(x, y), frames.yaw(heading))
    return message


def transform(parent: str, child: str, x: float, y: float, heading: float) -> FrameTransform:
    """A frame in its parent."""
    message = FrameTransform(parent_frame_id=parent, child_frame_id=child)
    message.translation.x, message.translation.y = frames.world_point(x, y)
    _turn(message.rotation, frames.yaw(heading))
    return message


def points(xs: list[int], ys: list[int], windows: list[int]) -> PointCloud:
    """Points of the body frame, each in its window's colour, and with the window's number as a field to colour or sort by."""
    cloud = PointCloud(frame_id="body", point_stride=_POINT.size)
    _place(cloud.pose, 0, 0)
    for name, offset in _POINT_FIELDS:
        cloud.fields.add(name=name, offset=offset, type=PackedElementField.FLOAT32 if offset < 8 else PackedElementField.UINT8)
    colours = [_COLOURS[name] for name in WINDOWS]
    cloud.data = b"".join(_POINT.pack(*frames.body_point(x, y), *colours[window], 255, window) for x, y, window in zip(xs, ys, windows))
    return cloud


def body(width: float, length: float) -> SceneUpdate:
    """The robot as a box that moves with its frame."""
    scene = SceneUpdate()
    cube = scene.entities.add(id="body", frame_id="body", frame_locked=True).cubes.add()
    _place(cube.pose, 0, 0)
    cube.size.x, cube.size.y, cube.size.z = length * frames.MM, width * frames.MM, _HEIGHT
    _paint(cube.color, 0.4, 0.5, 0.6, 0.7)
    return scene


def wheels(places: list[tuple[float, float]], angles: list[float]) -> SceneUpdate:
    """Wheels at their places in the body (mm), each turned by its angle (degrees clockwise)."""
    scene = SceneUpdate()
    entity = scene.entities.add(id="wheels", frame_id="body", frame_locked=True)
    for (x, y), angle in zip(places, angles):
        cube = entity.cubes.add()
        _place(cube.pose, *frames.body_point(x, y), frames.body_angle(angle))
        cube.size.x, cube.size.y, cube.size.z = _WHEEL
        _paint(cube.color, 0.1, 0.1, 0.1, 1)
    return scene


def windows(width: float, length: float, margins: dict[str, tuple[float, float]]) -> SceneUpdate:
    """The edges of the windows round the body. margins: {window: mm beside, mm ahead and behind}."""
    scene = SceneUpdate()
    entity = scene.entities.add(id="windows", frame_id="body", frame_locked=True)
    for name, (beside, ahead) in margins.items():
        x, y = width / 2 + beside, length / 2 + ahead
        red, green, blue = _COLOURS[name]
        _line(entity, [(-x, -y), (-x, y), (x, y), (x, -y)], LinePrimitive.LINE_LOOP, _EDGE, (red / 255, green / 255, blue / 255))
    return scene


def plan(way: list[tuple[float, float, float]], width: float, length: float) -> SceneUpdate:
    """The way of the body's centre, and its outline where the way ends; poses of the body frame. An empty way takes the plan away."""
    scene = SceneUpdate()
    entity = scene.entities.add(id="plan", frame_id="body", frame_locked=True)
    if way:
        x, y, heading = way[-1]
        s, c = sin(radians(heading)), cos(radians(heading))
        corners = [(x + a * c + b * s, y + b * c - a * s) for a, b in ((-width, -length), (-width, length), (width, length), (width, -length))]
        corners = [((x + cx) / 2, (y + cy) / 2) for cx, cy in corners]
        _line(entity, [(px, py) for px, py, _ in way], LinePrimitive.LINE_STRIP, _PLAN, _PLAN_COLOUR)
        _line(entity, corners, LinePrimitive.LINE_LOOP, _PLAN, _PLAN_COLOUR)
    return scene


def _line(entity, places, kind, thickness, colour):
    line = entity.lines.add(type=kind, thickness=thickness)
    _place(line.pose, 0, 0)
    red, green, blue = colour
    _paint(line.color, red, green, blue, 1)
    for place in places:
        x, y = frames.body_point(*place)
        line.points.add(x=x, y=y)


def walls(segments: list) -> SceneUpdate:
    """Walls of the world: [[x1, y1, x2, y2], ...]."""
    scene = SceneUpdate()
    lines = scene.entities.add(id="walls", frame_id="world").lines.add(type=LinePrimitive.LINE_LIST, thickness=_WALL)
    _place(lines.pose, 0, 0)
    _paint(lines.color, 0.2, 0.2, 0.2, 1)
    for x1, y1, x2, y2 in segments:
        for end in ((x1, y1), (x2, y2)):
            x, y = frames.world_point(*end)
            lines.points.add(x=x, y=y)
    return scene


def log(level: int, text: str) -> Log:
    """level: 0 information, 1 warning, 2 error."""
    return Log(level=_LEVELS[min(level, 2)], message=text, name="robot")


def _place(pose, x, y, angle=0.0):
    pose.position.x, pose.position.y = x, y
    _turn(pose.orientation, angle)


def _turn(orientation, angle):
    for name, value in frames.quaternion(angle).items():
        setattr(orientation, name, value)


def _paint(colour, red, green, blue, alpha):
    colour.r, colour.g, colour.b, colour.a = red, green, blue, alpha
