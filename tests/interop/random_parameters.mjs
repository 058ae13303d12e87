// node random_parameters.mjs SCENEGEN [COUNT] [SEED]: files of COUNT random parameter sets of the program before the
// Khronos validator and before our own reader (`scenegen inspect`). The sets are the same for the same SEED. A set that
// contradicts itself may be refused (exit code 2, one line) and is drawn again.
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdtempSync, rmSync, statSync, writeFileSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { findingsOf, printFindings } from './khronos.mjs';

const [program, countText = '100', seedText = '1'] = process.argv.slice(2);
if (program === undefined) {
  console.error('usage: node random_parameters.mjs SCENEGEN [COUNT] [SEED]');
  process.exit(2);
}
const wanted = Number(countText);

// SplitMix64 (Steele, Lea, Flood 2014).
let state = BigInt(seedText);
function random() {
  state = BigInt.asUintN(64, state + 0x9e3779b97f4a7c15n);
  let z = state;
  z = BigInt.asUintN(64, (z ^ (z >> 30n)) * 0xbf58476d1ce4e5b9n);
  z = BigInt.asUintN(64, (z ^ (z >> 27n)) * 0x94d049bb133111ebn);
  return Number((z ^ (z >> 31n)) >> 11n) / 2 ** 53;
}
const between = (low, high) => low + Math.floor(random() * (high - low + 1));
const real = (low, high) => (low + random() * (high - low)).toFixed(3);
const pick = (...choices) => choices[between(0, choices.length - 1)];

// Options that belong to another are given only together with it: else the program refuses them.
function townArguments() {
  const windows = random() < 0.7 ? ['--windows', 'on', '--window', `${real(0.3, 1.2)}x${real(0.3, 1.2)}`] : ['--windows', 'off'];
  const extras = random() < 0.3 ? ['--extras', String(between(1, 5)), '--extra-model', pick('box', 'sphere:8')] : [];
  return [
    '--grid', `${between(1, 2)}x${between(1, 2)}`, '--spacing', real(0, 20), '--ground', pick('on', 'off'),
    '--brick', `${real(0.2, 0.8)}x${real(0.1, 0.3)}x${real(0.05, 0.4)}`,
    '--building-size', `${between(3, 8)}x${between(3, 8)}`, '--floor-courses', String(between(4, 12)),
    '--floors', String(between(1, 3)), '--partitions', pick('on', 'off'), ...windows,
    '--roof', pick('mixed', 'gabled', 'flat', 'none'), ...extras,
    ...(random() < 0.3 ? ['--machines', String(between(1, 5))] : []),
  ];
}

function appearanceArguments() {
  if (random() < 0.1) return ['--curve', 'none'];
  const axes = pick('xyz', 'xzy', 'yxz', 'yzx', 'zxy', 'zyx');
  return [
    '--curve', pick('hilbert', 'morton', 'row-prime'), '--order', [...axes].map((axis) => pick('+', '-') + axis).join(''),
    '--cells', `${between(1, 20)}x${between(1, 20)}x${between(2, 20)}`, '--interval', real(0.001, 2),
    '--hold', pick('0', '1', '2.5'), '--coherence', pick('1', '0', real(0, 1)),
    '--visibility', pick('scale', 'pointer', 'both'),
  ];
}

function profileArguments() {
  const profile = pick('construct', 'demolish', 'temporary', 'drop', 'move', 'operate', 'neutral');
  const highlighted = !['drop', 'neutral'].includes(profile);
  return [
    '--profile', profile, ...(profile !== 'neutral' && random() < 0.5 ? ['--profile-duration', real(0.01, 5)] : []),
    ...(highlighted && random() < 0.5 ? ['--color', pick('swap', 'pointer')] : []),
    ...(highlighted && random() < 0.3 ? ['--highlight', `${profile}=${pick('#ff8000', '#3060a080')}`] : []),
    ...(profile === 'move' ? ['--move-offset', `${real(-9, 9)},0,${real(-9, 9)}`] : []),
  ];
}

function drawArguments() {
  return [
    ...(random() < 0.1 ? ['--test-set', String(between(41, 48))] : townArguments()), ...appearanceArguments(),
    ...(random() < 0.4 ? profileArguments() : []),
    '--seed', String(between(0, 1e9)), '--layout', pick('auto', 'nodes', 'groups', 'instances', 'merged'),
    '--threads', String(between(0, 4)), ...(random() < 0.2 ? ['--draco', '--draco-level', String(between(0, 10))] : []),
  ];
}

const folder = mkdtempSync(path.join(os.tmpdir(), 'scenegen_random_'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
const reasons = new Set();
let checked = 0, refused = 0, failures = 0, bytes = 0;
while (checked < wanted && failures < 10) {
  const args = drawArguments();
  const form = pick('.glb', '.gltf', '-');
  const file = path.join(folder, `scene_${checked}${form === '-' ? '.glb' : form}`);
  const run = spawnSync(program, [...args, '--quiet', '-o', form === '-' ? '-' : file], { maxBuffer: 2 ** 30 });
  const problem = (text) => {
    failures += 1;
    console.log(`${text}\n  scenegen ${args.join(' ')} -o ${form}`);
  };
  if (run.status === 2 && /^error: [^\n]+\n$/.test(run.stderr.toString()) && refused < wanted) {
    refused += 1;
    reasons.add(run.stderr.toString().trim().replace(/[0-9.]+/g, 'N'));
    continue;
  }
  checked += 1;
  if (run.status !== 0) {
    problem(`exit code ${run.status ?? run.signal}: ${run.stderr}`);
    continue;
  }
  if (form === '-') writeFileSync(file, run.stdout);
  bytes += statSync(file).size;
  const findings = await findingsOf(file);
  if (findings.length > 0) {
    printFindings(findings);
    problem('the validator has findings');
  }
  try {
    execFileSync(program, ['inspect', file], { stdio: ['ignore', 'ignore', 'pipe'] });
  } catch (error) {
    problem(`inspect: ${error.stderr}`);
  }
  rmSync(file);
}
for (const reason of reasons) console.log(`refused: ${reason}`);
console.log(`${checked} parameter sets, ${(bytes / 1e6).toFixed(1)} MB, ${refused} refused as contradictory, ${failures} failures`);
process.exit(failures === 0 && checked === wanted ? 0 : 1);
