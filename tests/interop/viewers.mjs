// node viewers.mjs --source FOLDER --programs FOLDER --out FOLDER [--all] [--docs FILE] [--only TEXT] [--keep]
// Plays our files in other people's viewers, in Chromium, and compares the pixels with what our own player says, on keys,
// between them and backwards. A viewer that does not play what expectations.mjs says is a failure, and so is one that plays
// what it is said not to play. --all: every layout and visibility encoding in every viewer; else
// each of them once.
// --docs: the tables of docs/INTEROP.md: with --all they are written, else compared with what is expected.
// --only: cases, files and viewers whose name holds TEXT; --keep: writes every image.
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { PNG } from 'pngjs';
import { makeCases } from './cases.mjs';
import { kLayouts, kViewers, kVisibilities, plays } from './expectations.mjs';
import { readGlbJson } from './glb.mjs';
import { judge, ownersOf } from './judge.mjs';
import { tables, tablesIn, writeTables } from './matrix.mjs';
import { openStage } from './stage.mjs';
import { truthOf } from './truth.mjs';

const kSize = [320, 240];
const kBackground = [255, 0, 255];
const kTolerance = { 'model-viewer': 42 };  // it lights what it shows; the others draw the colours of the file
const kDefaultTolerance = 12;
const kFewStray = 8;  // pixels

const { values: options } = parseArgs({ options: {
  source: { type: 'string' }, programs: { type: 'string' }, out: { type: 'string' }, all: { type: 'boolean', default: false },
  docs: { type: 'string' },
  only: { type: 'string', default: '' }, keep: { type: 'boolean', default: false },
} });
if (options.source === undefined || options.programs === undefined || options.out === undefined) {
  console.error('usage: node viewers.mjs --source FOLDER --programs FOLDER --out FOLDER [--all] [--docs FILE] [--only TEXT] [--keep]');
  process.exit(2);
}

/// Without --all a Latin square of the grid: every viewer sees every layout and every encoding, but not all pairs of them; and
/// one file of each other kind, in turn of another layout.
function chosen(test, { layout, visibility }, viewer) {
  if (options.all) return true;
  const row = kLayouts.indexOf(layout), column = kVisibilities.indexOf(visibility), number = kViewers.indexOf(viewer);
  return (row + column + number) % kVisibilities.length === 0 && (test.features || row === (number + cases.indexOf(test)) % kLayouts.length);
}

function keep(label, image) {
  const png = new PNG({ width: image.width, height: image.height });
  image.data.copy(png.data);
  writeFileSync(path.join(options.out, `${label.replace(/[^a-z0-9.+-]+/gi, '_')}.png`), PNG.sync.write(png));
}

/// {feature: {objects: Set, wrong: Map(name → times)}} of one file in one viewer.
async function play(stage, test, form, viewer, { truth, owners }) {
  await stage.open(viewer, { flat: true, background: kBackground });
  await stage.load(form.file);
  await stage.setCamera(JSON.parse(readFileSync(test.camera)).keys[0]);
  const features = new Map();
  const of = (feature) => {
    if (!features.has(feature)) features.set(feature, { objects: new Set(), wrong: new Map() });
    return features.get(feature);
  };
  const blame = (feature, name, time_s) => of(feature).wrong.set(name, [...(of(feature).wrong.get(name) ?? []), time_s]);
  for (const time_s of test.times) {
    const image = await stage.shot(time_s);
    if (options.keep) keep(`${test.name} ${form.layout} ${form.visibility} ${viewer} ${time_s}`, image);
    const found = judge(truth, owners, time_s, image, { background: kBackground, tolerance: kTolerance[viewer] ?? kDefaultTolerance });
    const featureOf = (id) => (test.features ? truth.names[id].split(':')[0] : 'all');
    for (const id of found.judged) of(featureOf(id)).objects.add(id);
    for (const id of found.wrong) blame(featureOf(id), truth.names[id], time_s);
    // What is seen where no object ever is: one that is hidden all the time, or that went astray.
    if (found.stray > kFewStray) blame(test.features ? 'visibility' : 'all', `${found.stray} pixels where nothing is`, time_s);
  }
  return features;
}

function hasBarePointers(file) {
  const json = readGlbJson(file);
  return (json.animations ?? []).flatMap((animation) => animation.channels).some(({ target }) => {
    const node = /^\/nodes\/(\d+)\/extensions\/KHR_node_visibility\//.exec(target.extensions?.KHR_animation_pointer?.pointer ?? '');
    return node !== null && json.nodes[node[1]].mesh === undefined;
  });
}

/// Lines that say how a result differs from what was expected.
function complaints(form, viewer, features) {
  const lines = [];
  for (const [feature, { objects, wrong }] of features) {
    const should = plays(viewer, { ...form, bare: hasBarePointers(form.file) }, feature);
    if (should && wrong.size > 0) {
      const some = [...wrong].slice(0, 3).map(([name, times]) => `"${name}" at ${times.join(', ')} s`);
      lines.push(`${feature}: ${wrong.size} of ${objects.size} objects are not as our player says: ${some.join('; ')}`);
    }
    if (!should && wrong.size === 0) lines.push(`${feature}: plays, though expectations.mjs says it does not`);
  }
  return lines;
}

/// Writes or checks the tables; a line that says what is wrong, or none.
function tend(docs, measured, modules) {
  if (!options.all) return tablesIn(docs) === tables(plays, modules).trim() ? [] : [`${docs}: its tables are not what expectations.mjs says`];
  const key = (viewer, { layout, visibility }, feature) => `${viewer} ${layout} ${visibility} ${feature}`;
  writeTables(docs, tables((viewer, form, feature) => {
    if (!measured.has(key(viewer, form, feature))) throw new Error(`not measured: ${key(viewer, form, feature)}`);
    return measured.get(key(viewer, form, feature));
  }, modules));
  return [];
}

const here = path.dirname(fileURLToPath(import.meta.url));
const files = path.join(options.out, 'files');
const cases = makeCases(options.programs, files);
const stage = await openStage({ source: options.source, here, files, size: kSize });
const measured = new Map();  // "viewer layout visibility feature" → plays
let played = 0, checks = 0, failures = 0;
for (const test of cases) {
  const wanted = test.files.flatMap((form) => kViewers.filter((viewer) => chosen(test, form, viewer)).map((viewer) => ({ form, viewer })))
    .filter(({ form, viewer }) => `${test.name} ${form.layout} ${form.visibility} ${viewer}`.includes(options.only));
  if (wanted.length === 0) continue;
  const truth = truthOf(test.files[0].file, { programs: options.programs, times: test.times, size: kSize, cameraPath: test.camera, folder: path.join(options.out, 'truth') });
  const owners = ownersOf(truth);
  for (const { form, viewer } of wanted) {
    const label = `${test.name}, ${form.layout}, ${form.visibility}: ${viewer}`, start = Date.now();
    let lines;
    try {
      const features = await play(stage, test, form, viewer, { truth, owners });
      for (const [feature, { objects, wrong }] of features) {
        checks += objects.size * test.times.length;
        const key = `${viewer} ${form.layout} ${form.visibility} ${feature}`;
        measured.set(key, (measured.get(key) ?? true) && wrong.size === 0);
      }
      lines = complaints(form, viewer, features);
      if (features.size === 0) lines.push('nothing was judged');
    } catch (error) {
      lines = [error.message.split('\n')[0]];
    }
    played += 1;
    failures += lines.length > 0 ? 1 : 0;
    console.log(`${lines.length === 0 ? 'ok  ' : 'FAIL'} ${label} (${Date.now() - start} ms)${lines.map((line) => `\n       ${line}`).join('')}`);
  }
}
for (const fault of new Set(stage.faults)) console.log(`FAIL ${fault}`);
failures += stage.faults.length;
if (options.docs !== undefined) {
  const lines = tend(options.docs, measured, path.join(here, 'node_modules'));
  for (const line of lines) console.log(`FAIL ${line}`);
  failures += lines.length;
}
await stage.close();
console.log(`${played} files played, ${checks} states of objects compared, ${failures} failures`);
process.exit(failures === 0 && played > 0 ? 0 : 1);
