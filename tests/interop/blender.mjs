// node blender.mjs --programs FOLDER --out FOLDER: files in Debian's Blender, compared with our player. Without Blender it says
// so and ends with 77, which ctest takes for "skipped".
import { execFileSync, spawnSync } from 'node:child_process';
import { mkdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { makeCases } from './cases.mjs';

const { values: options } = parseArgs({ options: { programs: { type: 'string' }, out: { type: 'string' } } });
const here = path.dirname(fileURLToPath(import.meta.url));

const version = spawnSync('blender', ['--version'], { encoding: 'utf8' });
if (version.error !== undefined) {
  console.log('skipped: there is no Blender (apt-get install blender)');
  process.exit(77);
}
console.log(version.stdout.split('\n')[0]);

mkdirSync(options.out, { recursive: true });
let files = 0, failures = 0;
for (const test of makeCases(options.programs, path.join(options.out, 'files'))) {
  // Blender 3.4 knows neither EXT_mesh_gpu_instancing nor KHR_animation_pointer, and one material of a name is one material.
  const playable = test.files.filter((form) => form.layout !== 'instances' && form.visibility === 'scale' && test.color !== 'pointer' && form.color !== 'pointer');
  for (const form of playable) {
    const truth = path.join(options.out, 'truth.json');
    writeFileSync(truth, execFileSync(path.join(options.programs, 'interop_truth'), [form.file, ...test.times.map(String)], { maxBuffer: 2 ** 30 }));
    const run = spawnSync('blender', ['--background', '--factory-startup', '--python-exit-code', '1', '--python', path.join(here, 'blender_check.py'), '--', form.file, truth],
      { encoding: 'utf8', maxBuffer: 2 ** 30 });
    const [, compared, merged, differ] = /blender: (\d+) states compared, (\d+) objects in merged meshes, (\d+) differ/.exec(run.stdout) ?? [];
    const ok = run.status === 0 && Number(compared) > 0 && Number(differ) === 0 && (form.layout === 'merged') === (Number(merged) > 0);
    files += 1;
    failures += ok ? 0 : 1;
    console.log(`${ok ? 'ok  ' : 'FAIL'} ${test.name}, ${form.layout}, ${form.visibility}: ${compared ?? 'no'} states compared, ${merged ?? '?'} objects in merged meshes, ${differ ?? '?'} differ`);
    if (!ok) console.log(run.stdout.split('\n').slice(-14).join('\n'));
  }
}
console.log(`${files} files, ${failures} failures`);
process.exit(failures === 0 && files > 0 ? 0 : 1);
