// What the service found: one design, or a front of them, with what is told of each.

// The designs of a dataset: {at, values, margins, ends, rates, regime, status, isKnee}, of
// `at` {name: value} of what was chosen, `values` {name: {value, unit}} of outputs,
// `margins` [{name, long, value, unit, binds}] to contacts and limits,
// `ends` [{name, end}] of ranges that were reached, and `rates` [{name, value}], per cent of the
// criterion for one per cent of a parameter. A front without a trade-off is one design.
export function designsOf(dataset, names) {
  const { variables } = dataset;
  const isFront = variables[`best_${names[0]}`].dims.includes("front");
  const isOne = variables.front_points?.data[0] === 1;
  const count = isFront && !isOne ? variables[`best_${names[0]}`].data.length : 1;
  return Array.from({ length: count }, (_, i) => designOf(variables, names, (one) => (one.dims.includes("front") ? one.data[i] : one.data)));
}

function designOf(variables, names, at) {
  const value = (name) => (variables[name] ? at(variables[name]) : null);
  const flag = (name) => {
    const found = Object.entries(variables[name]?.flags ?? {}).find(([, number]) => number === value(name));
    return found?.[0] ?? "";
  };
  const design = {
    at: Object.fromEntries(names.map((name) => [name, value(`best_${name}`)])),
    values: {},
    margins: [],
    ends: [],
    rates: [],
    regime: { name: flag("regime"), value: value("regime") },
    status: flag("optimum_status"),
    isKnee: flag("knee") === "knee",
  };
  design.isThere = names.every((name) => Number.isFinite(design.at[name]));
  for (const [name, variable] of Object.entries(variables)) {
    const [first] = name.split("_");
    const rest = name.slice(first.length + 1);
    const known = { name: rest, long: variable.long_name, value: at(variable), unit: variable.units ?? "1" };
    if (first === "margin") {
      design.margins.push({ ...known, binds: value(`binds_${rest}`) === 1 });
    } else if (first === "sensitivity") design.rates.push({ name: rest, value: known.value });
    else if (!variable.flags && !["best", "binds"].includes(first)) {
      design.values[name] = { value: known.value, unit: known.unit, long: known.long };
    }
  }
  for (const name of names) {
    for (const end of ["lower", "upper"]) {
      if (value(`binds_${name}_${end}`) === 1) design.ends.push({ name, end });
    }
  }
  return design;
}
