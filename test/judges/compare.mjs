// What a program found in a GLB against what it must find. `found` maps names to one list of places for each time,
// each place in metres with +Y up. Returns sentences, one for each fault, and the largest distance.
export function compare(expected, found) {
  const faults = [];
  let largest_m = 0;
  let compared = 0;
  const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
  for (const item of [...expected.organs, ...expected.bodies]) {
    const places = found[item.name];
    if (!places) {
      faults.push(`${item.name} is missing`);
      continue;
    }
    item.positions.forEach((wanted, i) => {
      const time = expected.times_s[i];
      if (wanted === null) {
        // Not born: all its vertices in one point.
        const spread = Math.max(...places[i].map((p) => distance(p, places[i][0])));
        if (!(spread <= 1e-9)) {
          faults.push(`${item.name} at ${time} s is not born and yet ${spread} m wide`);
        }
        return;
      }
      wanted.forEach((point, v) => {
        const gap = places[i][v] ? distance(point, places[i][v]) : NaN;
        ++compared;
        largest_m = Math.max(largest_m, gap);
        if (!(gap <= item.tolerance_m)) {
          faults.push(`${item.name} vertex ${item.vertices[v]} at ${time.toFixed(3)} s is ` +
            `${(1000 * gap).toPrecision(3)} mm off, more than ${(1000 * item.tolerance_m).toPrecision(3)}`);
        }
      });
    });
  }
  return {faults, largest_m, compared};
}

export function report(who, expected, found, faults) {
  const result = compare(expected, found);
  const all = [...faults, ...result.faults];
  console.log(`${who}: ${expected.organs.length} organs, ${result.compared} vertices at times ` +
    `${expected.times_s.map((t) => t.toFixed(3)).join(', ')} s, largest distance ` +
    `${(1000 * result.largest_m).toPrecision(3)} mm, ${all.length} faults`);
  all.slice(0, 10).forEach((fault) => console.log(`  ${fault}`));
  if (all.length > 10) {
    console.log(`  and ${all.length - 10} more`);
  }
  return all.length === 0;
}
