// Camera paths (docs/CAMERA_PATH.md), as `sceneplay` moves along them.
import { readFileSync } from 'node:fs';

const kInterpolations = ['catmull-rom', 'linear', 'step'];

/// {interpolation, keys}; throws what is wrong with the file.
export function readCameraPath(file) {
  const json = JSON.parse(readFileSync(file, 'utf8'));
  const interpolation = json.interpolation ?? 'catmull-rom';
  if (!kInterpolations.includes(interpolation)) throw new Error(`/interpolation must be one of ${kInterpolations.join(', ')}`);
  if (!Array.isArray(json.keys) || json.keys.length === 0) throw new Error('/keys must be a list of at least one key');
  const isPoint = (value) => Array.isArray(value) && value.length === 3 && value.every(Number.isFinite);
  const keys = json.keys.map(({ time_s, eye_m, target_m, yfov_rad = 0.6 }, i) => {
    if (![time_s, yfov_rad].every(Number.isFinite) || !isPoint(eye_m) || !isPoint(target_m)) throw new Error(`/keys/${i} needs time_s, eye_m and target_m`);
    if (i > 0 && !(time_s > json.keys[i - 1].time_s)) throw new Error(`/keys/${i}/time_s must be greater than the key's before it`);
    return { time_s, values: [...eye_m, ...target_m, yfov_rad] };
  });
  return { interpolation, keys };
}

/// {eye_m, target_m, yfov_rad} at a time.
export function cameraAt({ interpolation, keys }, time_s) {
  const camera = (values) => ({ eye_m: values.slice(0, 3), target_m: values.slice(3, 6), yfov_rad: Math.min(Math.max(values[6], 0.01), 3) });
  if (time_s <= keys[0].time_s) return camera(keys[0].values);
  if (time_s >= keys.at(-1).time_s) return camera(keys.at(-1).values);
  const i = keys.findIndex((key) => key.time_s > time_s) - 1;
  const a = keys[i], b = keys[i + 1], length = b.time_s - a.time_s, u = (time_s - a.time_s) / length;
  if (interpolation === 'step') return camera(a.values);
  if (interpolation === 'linear') return camera(a.values.map((value, c) => value + u * (b.values[c] - value)));
  const slope = (k, c) => {
    const before = keys[Math.max(k - 1, 0)], after = keys[Math.min(k + 1, keys.length - 1)];
    return (after.values[c] - before.values[c]) / (after.time_s - before.time_s);
  };
  const u2 = u * u, u3 = u2 * u;
  return camera(a.values.map((value, c) => (2 * u3 - 3 * u2 + 1) * value + (u3 - 2 * u2 + u) * length * slope(i, c)
    + (3 * u2 - 2 * u3) * b.values[c] + (u3 - u2) * length * slope(i + 1, c)));
}
