// The course of a row: which neighbours touch, and the platoons that they form.

import assert from "node:assert/strict";
import { test } from "node:test";

import { courseOf, platoonsAt } from "../../../app/page/modules/course.js";

// Three parts of 10 mm: the middle one leaves the rear and meets the front.
const dataset = {
  coordinates: { cycle_time: { data: [0, 0.1, 0.2] } },
  variables: {
    length: { data: 0.01 },
    part_position_1: { data: [0, 0.001, 0.002] },
    part_position_2: { data: [0.01, 0.012, 0.014] },
    part_position_3: { data: [0.021, 0.0225, 0.024] },
  },
};

test("parts of a row touch where nothing is between them but rounding", () => {
  const { row } = courseOf(dataset);
  assert.deepEqual(row.closed, [[true, false, false], [false, false, true]]);
});

test("platoons are parts that touch at a time, numbered from the rear", () => {
  const course = courseOf(dataset);
  assert.deepEqual(platoonsAt(course, 0), [[1, 2], [3]]);
  assert.deepEqual(platoonsAt(course, 0.15), [[1], [2], [3]]);
  assert.deepEqual(platoonsAt(course, 0.2), [[1], [2, 3]]);
});

test("a single part is no row", () => {
  assert.equal(courseOf({ coordinates: { cycle_time: { data: [0, 1] } }, variables: {} }).row, null);
});
