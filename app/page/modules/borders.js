// Borders of what is true of some cells of a grid, as rings that lie where it ends.
//
// d3 finds the rings along the middles between neighbours. Where values between neighbours are known,
// a ring is moved to where they change. Then it is smoothed: each point slides between its two neighbours
// as far as nothing is known about where the change lies, so that no cell comes to the other side.

const { contours } = /** @type {any} */ (window).d3;
// Moved towards the line through both neighbours and back again, points lose their steps and a ring does not
// shrink (Taubin's filter): steps of ten cells go, too.
const THERE = 0.67; // below 0.7: else steps of one cell would grow
const BACK = -0.672;
const TIMES = { few: 40, many: 150 }; // of few values, as while something is dragged, less is seen
const FEW = 50; // values of an axis
const REACH = [4, 8]; // points from an end, through which the line goes on to it
const INSIDE = 0.49; // of the way to a neighbour: two borders do not meet in a cell

/**
 * Regimes at (i, j) of two grids, each so many times finer along one axis.
 * @typedef {{times: number, across: (i: number, j: number) => number, up: (i: number, j: number) => number}} Edges
 *
 * Rings around the cells that are in, each of polygons as d3 has them.
 * @param {{nx: number, ny: number, at: (i: number, j: number) => number}} grid
 * @param {(value: number) => boolean} isIn
 * @param {Edges | null} edges
 */
export function ringsAround({ nx, ny, at }, isIn, edges = null) {
  const inside = new Float64Array(nx * ny);
  for (let j = 0; j < ny; j++) for (let i = 0; i < nx; i++) inside[j * nx + i] = isIn(at(i, j)) ? 1 : 0;
  const [{ coordinates }] = contours().size([nx, ny]).smooth(false).thresholds([0.5])(inside);
  const room = edges ? INSIDE / edges.times : INSIDE;
  return coordinates.map((polygon) =>
    polygon.map((ring) => {
      const links = ring.map(([x, y]) => linkAt(x, y, nx, ny));
      const points = edges ? ring.map((point, k) => moved(point, links[k], isIn, edges)) : ring;
      return smoothed(points, links, room, Math.max(nx, ny) > FEW ? TIMES.many : TIMES.few);
    }),
  );
}

// Along which axis a point of a ring may be moved, 0 or 1: it lies between two neighbours, of which one is
// inside. Null at the ends of the grid.
function linkAt(x, y, nx, ny) {
  if (Number.isInteger(x)) return x < 1 || x > nx - 1 ? null : 0;
  return y < 1 || y > ny - 1 ? null : 1;
}

// A point of a ring where the values between its neighbours change.
function moved([x, y], link, isIn, { times, across, up }) {
  const share = (first, value) => {
    const before = isIn(value(first * times));
    for (let k = 1; k <= times; k++) if (isIn(value(first * times + k)) !== before) return (k - 0.5) / times;
    return 0.5;
  };
  if (link === 0) return [x - 0.5 + share(x - 1, (i) => across(i, Math.floor(y))), y];
  if (link === 1) return [x, y - 0.5 + share(y - 1, (j) => up(Math.floor(x), j))];
  return [x, y];
}

// A closed ring without its steps; its first point is its last one, too. What lies along the ends of the grid
// stays; what comes to them goes on as it came.
function smoothed(ring, links, room, times) {
  const length = ring.length - 1;
  if (length < 8) return ring; // a single cell
  const places = [0, 1].map((axis) => Float64Array.from({ length }, (_, k) => ring[k][axis]));
  const around = (k) => (k + length) % length;
  const isLinked = (k) => links[around(k)] !== null;
  const free = []; // [place, place of one beside, of the other]
  for (let k = 0; k < length; k++) {
    if (!isLinked(k)) continue;
    const [before, after] = [isLinked(k - 1), isLinked(k + 1)];
    const [near, far] = REACH.map((steps) => (before ? k - steps : k + steps));
    if (before && after) free.push([k, around(k - 1), around(k + 1)]);
    else if ((before || after) && isLinked(near) && isLinked(far)) free.push([k, around(near), around(far)]);
  }
  const steps = new Float64Array(length);
  for (let turn = 0; turn < 2 * times; turn++) {
    for (const [k, one, other] of free) steps[k] = (turn % 2 ? BACK : THERE) * bent(one, k, other, links[k], places);
    for (const [k] of free) {
      const middle = ring[k][links[k]];
      const place = places[links[k]];
      place[k] = Math.max(middle - room, Math.min(middle + room, place[k] + steps[k]));
    }
  }
  const points = Array.from({ length }, (_, k) => [places[0][k], places[1][k]]);
  return [...points, points[0]];
}

// How far a point lies, along its axis, from the line through two others.
function bent(one, at, other, axis, places) {
  const along = places[axis];
  const aside = places[1 - axis];
  const wide = aside[other] - aside[one];
  const share = Math.abs(wide) > 0.01 ? Math.max(-2, Math.min(1, (aside[at] - aside[one]) / wide)) : 0.5;
  return along[one] + share * (along[other] - along[one]) - along[at];
}
