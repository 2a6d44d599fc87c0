// Borders of what is true of some cells of a grid, as rings that lie where it ends.
//
// d3 finds the rings along the middles between neighbours. Where values between neighbours are known,
// a ring is moved to where they change; then it is smoothed, by less than such a step.

const { contours } = /** @type {any} */ (window).d3;
// Moved towards the middle of both neighbours and back again, points lose their steps and a ring does not
// shrink (Taubin's filter).
const THERE = 0.5;
const BACK = -0.53;
const TIMES = { known: 6, guessed: 12 };

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
  return coordinates.map((polygon) =>
    polygon.map((ring) => smoothed(edges ? ring.map((point) => moved(point, nx, ny, isIn, edges)) : ring, edges ? TIMES.known : TIMES.guessed)),
  );
}

// A point of a ring lies between two neighbours, of which one is inside.
function moved([x, y], nx, ny, isIn, { times, across, up }) {
  const share = (first, value) => {
    const before = isIn(value(first * times));
    for (let k = 1; k <= times; k++) if (isIn(value(first * times + k)) !== before) return (k - 0.5) / times;
    return 0.5;
  };
  if (Number.isInteger(x)) {
    if (x < 1 || x > nx - 1) return [x, y];
    const row = Math.floor(y);
    return [x - 0.5 + share(x - 1, (i) => across(i, row)), y];
  }
  if (y < 1 || y > ny - 1) return [x, y];
  const column = Math.floor(x);
  return [x, y - 0.5 + share(y - 1, (j) => up(column, j))];
}

// A closed ring without its steps; its first point is its last one, too.
function smoothed(ring, times) {
  let points = ring.slice(0, -1);
  const { length } = points;
  if (length < 8) return ring; // a single cell
  for (let k = 0; k < 2 * times; k++) {
    const part = k % 2 ? BACK : THERE;
    points = points.map(([x, y], i) => {
      const [before, after] = [points[(i + length - 1) % length], points[(i + 1) % length]];
      return [x + part * (0.5 * (before[0] + after[0]) - x), y + part * (0.5 * (before[1] + after[1]) - y)];
    });
  }
  return [...points, points[0]];
}
