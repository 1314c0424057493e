"""The picture of a run, as PNG."""

import numpy as np


def draw(result, path):
    """Draw walls, body outlines, the tracks of the body's front and rear and every touch. result: run.Result."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot
    from matplotlib.collections import LineCollection

    figure, axes = pyplot.subplots(figsize=(9, 8))
    segments = result.layout.segments.reshape(-1, 2, 2)
    axes.add_collection(LineCollection(segments, colors="black", linewidths=2))
    track = result.track
    half_width, half_length = result.vehicle.width / 2, result.vehicle.length / 2
    for i in range(0, len(track), 50):
        axes.plot(*outline(track[i, 1:], half_width, half_length).T, color="tab:blue", linewidth=0.6, alpha=0.6)
    h = np.radians(track[:, 3])
    forward = np.stack([np.sin(h), np.cos(h)], axis=1) * half_length
    axes.plot(*(track[:, 1:3] + forward).T, color="tab:red", label="A, front")
    axes.plot(*(track[:, 1:3] - forward).T, color="tab:green", label="B, rear")
    for _, *pose in result.touches:
        axes.plot(*outline(pose, half_width, half_length).T, color="red", linewidth=1.5)
    axes.set_aspect("equal")
    axes.autoscale()
    axes.legend()
    axes.set_title(f"{result.course} {result.width_mm:g} mm: {result.result}, {result.time_s:.1f} s")
    figure.savefig(path, dpi=110)
    pyplot.close(figure)


def outline(pose, half_width, half_length):
    """Closed outline of the body, (5, 2). pose: x, y, heading in degrees."""
    x, y, heading = pose
    s, c = np.sin(np.radians(heading)), np.cos(np.radians(heading))
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1), (-1, -1)]) * (half_width, half_length)
    return np.array([x, y]) + corners @ np.array([(c, -s), (s, c)])
