// Colour scales: one for magnitudes, one for values of both signs.

// Viridis and a blue-white-red scale, at nine places each.
const ONE_SIGN = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
  [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37],
];
const TWO_SIGNS = [
  [33, 72, 160], [82, 122, 201], [140, 173, 228], [199, 215, 240], [242, 242, 242],
  [244, 207, 187], [230, 152, 119], [202, 92, 69], [160, 26, 38],
];
const STEPS = 256;
const SAMPLE = 4000; // values

function table(stops) {
  const found = new Uint8ClampedArray(STEPS * 3);
  for (let i = 0; i < STEPS; i++) {
    const at = (i / (STEPS - 1)) * (stops.length - 1);
    const low = Math.min(Math.floor(at), stops.length - 2);
    for (let c = 0; c < 3; c++) {
      found[3 * i + c] = stops[low][c] + (at - low) * (stops[low + 1][c] - stops[low][c]);
    }
  }
  return found;
}

const TABLES = { one: table(ONE_SIGN), two: table(TWO_SIGNS) };

// The scale for values: its ends, and the colour of each. What sticks out far is cut.
export function scaleOf(values) {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value < low && value > -Infinity) low = value;
    if (value > high && value < Infinity) high = value;
  }
  if (low > high) return null;
  const most = usualEnds(values);
  if (high - low > 4 * (most[1] - most[0]) && most[1] > most[0]) [low, high] = most;
  if (high - low < 1e-9 * Math.max(Math.abs(low), Math.abs(high), 1e-300)) {
    const room = 0.05 * Math.max(Math.abs(low), Math.abs(high)) || 1;
    low -= room;
    high += room;
  }
  const isTwo = Math.min(-low, high) > 0.1 * Math.max(-low, high);
  const ends = isTwo ? [-Math.max(-low, high), Math.max(-low, high)] : [low, high];
  return { low: ends[0], high: ends[1], lut: TABLES[isTwo ? "two" : "one"], steps: STEPS };
}

// Where all but a hundredth lie at either end, judged by some of the values: sorting all of a fine map
// takes longer than a frame. The step is odd, so that it does not keep to the same columns.
function usualEnds(values) {
  const step = Math.floor(values.length / SAMPLE) | 1;
  const some = new Float64Array(Math.ceil(values.length / step));
  let count = 0;
  for (let i = 0; i < values.length; i += step) {
    if (Number.isFinite(values[i])) some[count++] = values[i];
  }
  const sorted = some.subarray(0, count).sort();
  return [0.01, 0.99].map((share) => sorted[Math.floor(share * (count - 1))]);
}

export function colourOf(scale, value) {
  const at = ((value - scale.low) / (scale.high - scale.low)) * (scale.steps - 1);
  const i = 3 * Math.max(0, Math.min(scale.steps - 1, Math.round(at)));
  return `rgb(${scale.lut[i]} ${scale.lut[i + 1]} ${scale.lut[i + 2]})`;
}
