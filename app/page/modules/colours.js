// Colours of values: blue forwards, orange backwards, light at zero, in steps at round values.

const { extent, quantile } = /** @type {any} */ (window).d3;
const FORWARDS = ["F4F5F5", "CFE1F0", "97C0E2", "5596CB", "1F68AE", "0A3F77", "061F42"].map(channels);
const BACKWARDS = ["F4F5F5", "F7DBBE", "EDB27A", "D4833A", "A85610", "703403", "3D1B00"].map(channels);
const STEPS = 18;
const FROM_ZERO = 0.5; // of the largest value: what begins below it begins at zero

function channels(hex) {
  return [0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

function mixed(stops, share) {
  const at = Math.min(1, share) * (stops.length - 1);
  const low = Math.min(Math.floor(at), stops.length - 2);
  return stops[low].map((first, c) => Math.round(first + (at - low) * (stops[low + 1][c] - first)));
}

// The next round number: 1, 2 or 5 times a power of ten.
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value) + 1e-9);
  return [1, 2, 5, 10].map((one) => one * power).find((one) => one >= value * (1 - 1e-9));
}

// The scale of values: {low, high, step, bands}, the colour of each step. What sticks out far is cut.
export function scaleOf(values) {
  let [low, high] = extent(values, (value) => (Number.isFinite(value) ? value : NaN));
  if (low === undefined) return null;
  const most = [0.01, 0.99].map((share) => quantile(values, share)); // of all but what sticks out far
  if (high - low > 4 * (most[1] - most[0]) && most[1] > most[0]) [low, high] = most;
  if (high - low < 1e-9 * Math.max(Math.abs(low), Math.abs(high), 1e-300)) {
    const room = 0.05 * Math.max(Math.abs(low), Math.abs(high)) || 1;
    [low, high] = low === 0 ? [0, room] : [low - room, high + room];
  }
  if (low > 0 && low < FROM_ZERO * high) low = 0;
  if (high < 0 && high > FROM_ZERO * low) high = 0;
  const step = roundUp((high - low) / STEPS);
  const first = Math.floor(low / step + 1e-9);
  const last = Math.max(first + 1, Math.ceil(high / step - 1e-9));
  const isSigned = first < 0 && last > 0;
  const measure = isSigned ? Math.max(-first, last) : last - first;
  const bands = Array.from({ length: last - first }, (_, k) => {
    const middle = first + k + 0.5;
    if (isSigned || first >= 0) {
      const from = isSigned ? 0 : first;
      return mixed(middle >= 0 ? FORWARDS : BACKWARDS, Math.abs(middle - from) / measure);
    }
    return mixed(BACKWARDS, (last - middle) / measure);
  });
  return { low: first * step + 0, high: last * step + 0, step, bands }; // no -0
}

// The place of a value among the bands; what lies beyond the ends is in the outermost.
export function bandOf({ low, step, bands }, value) {
  const at = Math.floor((value - low) / step + 1e-9);
  return at < 0 ? 0 : at >= bands.length ? bands.length - 1 : at;
}
