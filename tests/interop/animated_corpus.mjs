// node animated_corpus.mjs SCENEGEN MODELS: animates every glTF 2.0 model below MODELS that the Khronos validator passes, in every visibility
// encoding, and wants the validator to pass the result too.
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readdirSync, rmSync } from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import process from 'node:process';
import { findingsOf, printFindings } from './khronos.mjs';

const [program, models] = process.argv.slice(2);
const folder = mkdtempSync(path.join(os.tmpdir(), 'scenegen_animated_'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
const files = readdirSync(models, { recursive: true })
  .filter((name) => /\.(gltf|glb)$/.test(name))
  .sort();
let checked = 0, failures = 0, skipped = 0;
for (const name of files) {
  const model = path.join(models, name);
  const before = await findingsOf(model).catch(() => ['unreadable']);
  if (before.length > 0) {
    skipped += 1;
    continue;
  }
  for (const visibility of ['scale', 'pointer', 'both']) {
    const file = path.join(folder, 'out.glb');
    const run = spawnSync(program, ['animate', model, '-q', '--visibility', visibility, '-o', file]);
    if (run.status === 1 && /--visibility pointer|has no objects/.test(run.stderr.toString())) continue;  // a skin; nothing drawn
    let findings = run.status === 0 ? await findingsOf(file) : [`${model}: ${run.stderr}`];
    findings = findings.filter((line) => !line.includes('DATA_URI_GLB'));  // an image of the model that stays where it was
    printFindings(findings.map((line) => `${name} (${visibility}): ${line}`));
    failures += findings.length > 0 ? 1 : 0;
    checked += 1;
  }
}
console.log(`${checked} animated files, ${skipped} models the validator does not pass as they are, ${failures} failures`);
process.exit(failures === 0 && checked > 60 ? 0 : 1);
