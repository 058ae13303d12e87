// Figures of runs in the form of docs/BENCH_FORMAT.md.

const kMostPoints = 500;
const kStudent95 = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.16, 2.145, 2.131, 2.12, 2.11, 2.101, 2.093];

export const mean = (values) => values.reduce((sum, value) => sum + value, 0) / values.length;

/// By linear interpolation between the nearest two.
export function quantile(values, share) {
  const sorted = [...values].sort((a, b) => a - b), place = share * (sorted.length - 1), below = Math.floor(place);
  return sorted[below] + (place - below) * (sorted[Math.min(below + 1, sorted.length - 1)] - sorted[below]);
}

export const spread = (values) => ({
  mean: mean(values), median: quantile(values, 0.5), p25: quantile(values, 0.25), p75: quantile(values, 0.75), p95: quantile(values, 0.95), min: Math.min(...values),
});

/// 95 % interval of the mean of what the runs' means are samples of; nulls for a single run.
function interval(means) {
  if (means.length < 2) return { low: null, high: null };
  const middle = mean(means), variance = means.reduce((sum, value) => sum + (value - middle) ** 2, 0) / (means.length - 1);
  const half = (kStudent95[means.length - 2] ?? 1.96 + 2.5 / (means.length - 1)) * Math.sqrt(variance / means.length);
  return { low: middle - half, high: middle + half };
}

/// Median over the runs, frame by frame; neighbours are averaged where there are more than kMostPoints.
function overTime(runs, times_s) {
  const medians = times_s.map((_, i) => quantile(runs.map((run) => run[i]), 0.5));
  const points = Math.min(times_s.length, kMostPoints);
  const cut = (values) => Array.from({ length: points }, (_, p) =>
    mean(values.slice(Math.floor(p * values.length / points), Math.floor((p + 1) * values.length / points))));
  return { timeS: cut(times_s), frameMs: cut(medians) };
}

/// Members of a case from the milliseconds of its frames, by run.
export function frameFigures(runs, times_s) {
  const means = runs.map(mean), frameMs = { ...spread(runs.flat()), mean: mean(means), ...interval(means), runs: means };
  return { frames: times_s.length, repetitions: runs.length, frameMs, overTime: overTime(runs, times_s), totalMs: frameMs.mean * times_s.length };
}

/// Says of each case how much longer it takes than the best that differs in strategy alone.
export function addVsBest(cases) {
  const key = ({ file, device, camera, framesInFlight }) => JSON.stringify([file, device, camera, framesInFlight]);
  for (const one of cases.filter((c) => c.frameMs !== undefined)) {
    one.vsBest = one.frameMs.mean / Math.min(...cases.filter((c) => c.frameMs !== undefined && key(c) === key(one)).map((c) => c.frameMs.mean));
  }
}

function flat(value, name, into) {
  if (Array.isArray(value)) {
    if (value.every((entry) => typeof entry === 'string')) into[name] = value.join('; ');
  } else if (value !== null && typeof value === 'object') {
    for (const [member, inner] of Object.entries(value)) flat(inner, name === '' ? member : `${name}.${member}`, into);
  } else {
    into[name] = value;
  }
  return into;
}

/// A line a case; members of members are joined by a point, lists of numbers left out.
export function csv(cases) {
  const rows = cases.map((one) => flat(one, '', {})), columns = [...new Set(rows.flatMap((row) => Object.keys(row)))];
  const cell = (value) => (/[",\r\n]/.test(String(value ?? '')) ? `"${String(value).replaceAll('"', '""')}"` : String(value ?? ''));
  return `${[columns, ...rows.map((row) => columns.map((column) => row[column]))].map((row) => row.map(cell).join(',')).join('\n')}\n`;
}
