// node pictures.mjs --source FOLDER --programs FOLDER --out FOLDER: the pictures of docs/INTEROP.md, written into
// docs/images. Not a test: look at them.
import { execFileSync } from 'node:child_process';
import { copyFileSync, mkdirSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { openStage } from './stage.mjs';

const { values: options } = parseArgs({ options: { source: { type: 'string' }, programs: { type: 'string' }, out: { type: 'string' } } });
const kSize = [560, 360], kTime_s = 90;
const kCamera = { eye_m: [21, 14, 24], target_m: [0, 3.2, 0], yfov_rad: 0.5 };

mkdirSync(options.out, { recursive: true });
const images = path.join(options.source, 'docs', 'images');
const town = path.join(options.out, 'town.glb'), cameraPath = path.join(options.out, 'camera.json');
const run = (program, args) => execFileSync(path.join(options.programs, program), args, { stdio: ['ignore', 'ignore', 'inherit'] });
run('scenegen', ['--grid', '2x2', '--coherence', '0.95', '--interval', '0.05', '--profile', 'construct', '--quiet', '-o', town]);
writeFileSync(cameraPath, JSON.stringify({ keys: [{ time_s: 0, ...kCamera }] }));
run('sceneplay', ['frames', town, '-o', options.out, '--times', String(kTime_s), '--size', kSize.join('x'), '--format', 'jpg', '--camera-path', cameraPath, '--quiet']);
copyFileSync(path.join(options.out, 'frame_00000.jpg'), path.join(images, 'interop_sceneplay.jpg'));

const here = path.dirname(fileURLToPath(import.meta.url));
const stage = await openStage({ source: options.source, here, files: options.out, size: kSize });
for (const viewer of ['three', 'babylon', 'model-viewer']) {
  await stage.open(viewer, { background: viewer === 'model-viewer' ? null : [198, 212, 226] });
  await stage.page.addStyleTag({ content: 'body { background: rgb(198, 212, 226) } model-viewer { background: none }' });
  await stage.load(town);
  await stage.setCamera(kCamera);
  await stage.page.evaluate(async (time_s) => { window.viewer.seek(time_s); await window.viewer.render(); }, kTime_s);
  await stage.page.screenshot({ path: path.join(images, `interop_${viewer}.jpg`), type: 'jpeg', quality: 85 });
}
await stage.close();
