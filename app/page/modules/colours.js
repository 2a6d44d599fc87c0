// Colours of values: one rule for all of them, so that colours change only as much as values do.
//
// Values from 0 on are viridis; values below 0 have a warm scale that begins with the same dark colour
// at 0. Where both signs occur, both sides have the same measure, and 0 is the darkest.

const FROM_ZERO = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
  [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37],
];
const BELOW_ZERO = [
  [68, 1, 84], [99, 8, 94], [132, 20, 97], [165, 36, 92], [196, 58, 82],
  [222, 87, 69], [241, 124, 58], [250, 169, 72], [252, 219, 130],
];
const STEPS = 256;
const SAMPLE = 4000; // values

function mixed(stops, share) {
  const at = share * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  return stops[low].map((first, c) => first + (at - low) * (stops[low + 1][c] - first));
}

// The colours between two ends, at STEPS places.
function table(low, high) {
  const found = new Uint8ClampedArray(STEPS * 3);
  const measure = low < 0 && high > 0 ? Math.max(-low, high) : high - low;
  const nearest = low < 0 && high > 0 ? 0 : low >= 0 ? low : high; // what is as dark as can be
  for (let i = 0; i < STEPS; i++) {
    const value = low + (i / (STEPS - 1)) * (high - low);
    const share = Math.min(1, Math.abs(value - nearest) / measure);
    found.set(mixed(value >= nearest && high > 0 ? FROM_ZERO : BELOW_ZERO, share), 3 * i);
  }
  return found;
}

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
  return { low, high, lut: table(low, high), steps: STEPS };
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
