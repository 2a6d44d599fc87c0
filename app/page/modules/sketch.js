// A part on its track as a sketch: from the side with slope and vibration, along the track where it
// leans, and from above in a bowl. Movements are enlarged alike, the part is not to scale.

import { PARTS, between, platoonsAt } from "./course.js";
import { number } from "./words.js";

const REACH = 0.17; // of the height: the largest movement
const SIZE = 0.19; // of the height: the part
const HATCH = 40; // px between two hatches
const MARGIN = 14; // px
const PER_METRE = 3780; // px of a screen of 96 px an inch
const RADIANS = Math.PI / 180;

// The context of a canvas at the resolution of the screen, cleared.
function prepared(canvas) {
  const ratio = devicePixelRatio || 1;
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.strokeStyle = context.fillStyle = getComputedStyle(canvas).color;
  context.lineWidth = 2;
  context.font = "12px system-ui, sans-serif";
  return { context, width, height };
}

// How much movements are enlarged: the largest of all of them fills its reach.
function enlargement({ height, trackNormal, trackAlong, wall, row }, tall) {
  const sizes = [height, trackNormal, trackAlong, wall ?? [], ...(row?.ahead ?? [])].flatMap((values) => values.map(Math.abs));
  return (tall * REACH) / Math.max(...sizes, 1e-9);
}

// The state at a moment: `turns` are the cycles before it.
function stateOf(course, time, turns) {
  const here = (values) => between(course, values, time);
  const { along, row } = course;
  const travel = (values) => here(values) + turns * (values[values.length - 1] - values[0]);
  return {
    along: travel(along),
    height: here(course.height),
    wall: course.wall ? here(course.wall) : null,
    trackAlong: here(course.trackAlong),
    trackNormal: here(course.trackNormal),
    parts: row ? row.positions.map((values) => travel(values)) : null,
    platoons: row ? platoonsAt(course, time) : null,
  };
}

export function drawSide(canvas, course, time, turns, colour) {
  const { context, width, height: tall } = prepared(canvas);
  if (!width) return;
  const scale = enlargement(course, tall);
  const state = stateOf(course, time, turns);
  context.save();
  // The track climbs from left to right, about the middle of the picture.
  context.translate(width / 2, tall * 0.66);
  context.rotate(-course.climb * RADIANS);
  const half = width; // far enough, however steep
  const floor = -state.trackNormal * scale;
  drawFloor(context, half, floor, state.trackAlong * scale);
  context.fillStyle = colour;
  const size = tall * SIZE;
  if (state.parts) drawRow(context, course.row, state, { scale, floor, size, width });
  else {
    const room = width + 1.4 * size;
    const left = wrapped(0.2 * width + (state.along + state.trackAlong) * scale, room) - width / 2 - 1.4 * size;
    context.fillRect(left, floor - state.height * scale - size, 1.4 * size, size);
  }
  context.restore();
  if (!course.row) drawVibration(context, course, state, scale, tall);
  const told = `${course.row ? "seen from the track, " : ""}movements ${number(scale / PER_METRE, 2)} times enlarged`;
  context.textAlign = "right";
  context.fillText(told, width - MARGIN, tall - 8);
  if (course.wall) drawEnd(context, course, state, { scale, width, colour });
}

function wrapped(value, room) {
  return ((value % room) + room) % room;
}

function drawFloor(context, half, floor, shift) {
  context.beginPath();
  context.moveTo(-half, floor);
  context.lineTo(half, floor);
  for (let x = -Math.ceil(half / HATCH) * HATCH + wrapped(shift, HATCH); x < half; x += HATCH) {
    context.moveTo(x, floor);
    context.lineTo(x - 8, floor + 10);
  }
  context.stroke();
}

// The parts of a row, by number from the rear: gaps between them are enlarged as movements are, so that
// what touches touches; a bar joins it.
function drawRow(context, { positions, length }, { parts, trackAlong, platoons }, { scale, floor, size, width }) {
  const wide = Math.min(size, (0.7 * width) / positions.length);
  let left = -width / 2 + MARGIN;
  const room = width - positions.length * wide - 2 * MARGIN;
  left += wrapped((parts[0] + trackAlong) * scale, Math.max(40, room / 3));
  const fronts = new Set(platoons.flatMap((platoon) => platoon.slice(1)));
  context.textAlign = "center";
  parts.forEach((position, i) => {
    const before = left + wide / 2;
    if (i) left += wide + Math.min(2 * wide, Math.max(0, position - parts[i - 1] - length) * scale);
    context.fillStyle = PARTS[i % PARTS.length];
    context.fillRect(left, floor - size, wide - 1, size);
    context.fillStyle = context.strokeStyle;
    const middle = left + wide / 2;
    context.fillText(String(i + 1), middle, floor - size - 10);
    if (fronts.has(i + 1)) context.fillRect(before, floor - size - 6, middle - before, 3);
  });
}

// The path of the track over a cycle, a line or an ellipse, with its place now.
function drawVibration(context, { trackAlong, trackNormal, climb }, state, scale, tall) {
  const middle = { x: MARGIN + tall * REACH, y: MARGIN + tall * REACH };
  const turned = (x, y) => {
    const [along, normal] = [x * scale, -y * scale];
    const angle = -climb * RADIANS;
    return [
      middle.x + along * Math.cos(angle) - normal * Math.sin(angle),
      middle.y + along * Math.sin(angle) + normal * Math.cos(angle),
    ];
  };
  context.save();
  context.lineWidth = 1.5;
  context.beginPath();
  trackAlong.forEach((x, i) => context.lineTo(...turned(x, trackNormal[i])));
  context.stroke();
  context.beginPath();
  context.arc(...turned(state.trackAlong, state.trackNormal), 4, 0, 2 * Math.PI);
  context.fill();
  context.restore();
  context.textAlign = "left";
  context.fillText("the track's own motion", MARGIN + 2 * tall * REACH + 8, MARGIN + 10);
  if (climb) context.fillText(`climbs ${number(climb, 3)}°`, MARGIN + 2 * tall * REACH + 8, MARGIN + 26);
}

// Seen along the track, where it has a wall: the floor leans by its angle, the wall stands on it.
function drawEnd(context, { lean }, { wall, height }, { scale, width, colour }) {
  const size = 24; // px
  context.save();
  context.translate(width - 3 * size - MARGIN, MARGIN + 2.2 * size);
  context.rotate((lean ?? 0) * RADIANS);
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(-1.5 * size, 0);
  context.lineTo(2 * size, 0);
  context.lineTo(2 * size, -1.6 * size);
  context.stroke();
  context.fillStyle = colour;
  const off = Math.min(2 * size, wall * scale * 0.4);
  context.fillRect(2 * size - off - size, -size - Math.min(size, height * scale * 0.4), size, size);
  context.restore();
  if (lean) {
    context.textAlign = "right";
    context.fillText(`leans ${number(lean, 3)}°`, width - MARGIN, MARGIN + 4 * size);
  }
}

export function drawAbove(canvas, course, time, turns, colour) {
  const { context, width, height } = prepared(canvas);
  if (!width) return;
  const { along } = stateOf(course, time, turns);
  const middle = [width / 2, height / 2];
  const reach = Math.min(width, height) * 0.42;
  for (const [radius, dashes] of [[reach, []], [reach * 0.84, [4, 4]]]) {
    context.setLineDash(dashes);
    context.beginPath();
    context.arc(...middle, radius, 0, 2 * Math.PI);
    context.stroke();
  }
  context.translate(...middle);
  context.rotate(-along / course.radius);
  context.fillStyle = colour;
  context.fillRect(reach * 0.86, -8, reach * 0.12, 16);
}
