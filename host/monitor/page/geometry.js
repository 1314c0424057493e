// Geometry of the body frame: x right, y forward, mm; angles in degrees, clockwise from forward.

const RAD = Math.PI / 180;

export const BODY = {
  width: 250, length: 600, track: 230, spacings: [115, 150, 117, 115], first: 248.5,
};

export function bodyOf(hello) {
  return { ...BODY, ...(hello || {}) };
}

// Positions of the wheels: axle 1 left, axle 1 right, axle 2 left, ...
export function wheels(body) {
  let y = body.first;
  const out = [];
  for (let axle = 0; axle <= body.spacings.length; axle++) {
    out.push({ x: -body.track / 2, y }, { x: body.track / 2, y });
    y -= body.spacings[axle] || 0;
  }
  return out;
}

// Twist of the body for steering (AF, AR), up to scale: vx, vy mm and w rad clockwise, the fastest wheel going 1 mm.
export function twist(body, af, ar) {
  const f = af * RAD, r = ar * RAD;
  const base = body.spacings.reduce((sum, gap) => sum + gap, 0);
  const middle = body.first - base / 2; // the form holds at the middle of the wheelbase
  let vx = Math.sin(f + r) / 2, vy = Math.cos(f) * Math.cos(r), w = Math.sin(f - r) / base;
  // One form serves every mode but spinning, where it comes to nothing.
  if (Math.abs(af) === 90 && ar === -af) [vx, vy, w] = [0, 0, Math.sign(af) / base];
  vx -= w * middle;
  const fastest = Math.max(...wheels(body).map((p) => Math.hypot(vx + w * p.y, vy - w * p.x)));
  if (fastest < 1e-9) return { vx: 0, vy: 0, w: 0 };
  return { vx: vx / fastest, vy: vy / fastest, w: w / fastest };
}

// Pose after the fastest wheel went `distance` mm (negative: backward) with a steady twist.
export function pose(t, distance) {
  const turn = t.w * distance;
  if (Math.abs(turn) < 1e-6) return { x: t.vx * distance, y: t.vy * distance, heading: turn };
  // Integral of the velocity, which turns with the body.
  const s = Math.sin(turn) / t.w, c = (1 - Math.cos(turn)) / t.w;
  return { x: t.vx * s + t.vy * c, y: t.vy * s - t.vx * c, heading: turn };
}

// A point of the body, seen from where the body was at first.
export function carry(p, at) {
  const s = Math.sin(at.heading), c = Math.cos(at.heading);
  return { x: at.x + p.x * c + p.y * s, y: at.y - p.x * s + p.y * c };
}

export function corners(body) {
  const w = body.width / 2, l = body.length / 2;
  return [{ x: -w, y: l }, { x: w, y: l }, { x: w, y: -l }, { x: -w, y: -l }];
}

// Outlines of the body along a way of `distance` mm of the fastest wheel.
export function sweep(body, af, ar, distance, steps = 24) {
  const t = twist(body, af, ar);
  const outline = corners(body);
  const out = [];
  for (let i = 0; i <= steps; i++) {
    const at = pose(t, distance * i / steps);
    out.push(outline.map((p) => carry(p, at)));
  }
  return out;
}

// How far a way of `distance` mm (negative: backward) leads before the body, grown by the margin, meets a point it does not touch at the start, or
// meets one a little further on: { way, point }, point being its number, or -1.
export function firstHit(body, t, distance, points, margin, step = 30, further = 60) {
  const w = body.width / 2 + margin, l = body.length / 2 + margin;
  const sign = Math.sign(distance) || 1, end = Math.abs(distance) + further;
  const ahead = points.x.map((x, i) => i).filter((i) => Math.abs(points.x[i]) > w || Math.abs(points.y[i]) > l);
  for (let way = step; way <= end; way += step) {
    const at = pose(t, sign * way);
    const s = Math.sin(at.heading), c = Math.cos(at.heading);
    for (const i of ahead) {
      const dx = points.x[i] - at.x, dy = points.y[i] - at.y;
      if (Math.abs(dx * c - dy * s) <= w && Math.abs(dx * s + dy * c) <= l) return { way: sign * Math.min(way - step / 2, Math.abs(distance)), point: i };
    }
  }
  return { way: distance, point: -1 };
}

// The ten zones as polygons round the body, a band of `margin` mm: 0 front, then clockwise.
export function zones(body, margin) {
  const w = body.width / 2, l = body.length / 2, W = w + margin, L = l + margin;
  const box = (x1, y1, x2, y2) => [{ x: x1, y: y1 }, { x: x2, y: y1 }, { x: x2, y: y2 }, { x: x1, y: y2 }];
  return [
    box(-w, l, w, L), box(w, l, W, L), box(w, 0, W, l), box(w, -l, W, 0), box(w, -L, W, -l),
    box(-w, -L, w, -l), box(-W, -L, -w, -l), box(-W, -l, -w, 0), box(-W, 0, -w, l), box(-W, l, -w, L),
  ];
}
