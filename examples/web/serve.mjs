// node serve.mjs [FILE.glb] [--port N]: serves the page on this machine, with a file to begin with. Packages that are
// missing are installed first (npm ci). Node 18 or later.
import { spawnSync } from 'node:child_process';
import { existsSync, statSync } from 'node:fs';
import path from 'node:path';
import process from 'node:process';
import { fileURLToPath } from 'node:url';
import { parseArgs } from 'node:util';
import { serve } from './server.mjs';

const kHere = path.dirname(fileURLToPath(import.meta.url));

function fail(code, message) {
  console.error(`error: ${message}`);
  process.exit(code);
}

function readArguments() {
  try {
    const { values, positionals } = parseArgs({ allowPositionals: true, options: {
      port: { type: 'string', default: '8080' }, modules: { type: 'string', default: path.join(kHere, 'node_modules') }, help: { type: 'boolean', short: 'h', default: false },
    } });
    const port = Number(values.port);
    if (values.help) return { help: true };
    if (positionals.length > 1) fail(2, `one file at most, not ${positionals.length}`);
    if (!Number.isInteger(port) || port < 0 || port > 65535) fail(2, `--port: '${values.port}' is not a number from 0 to 65535`);
    return { file: positionals[0], port, modules: values.modules };
  } catch (error) {
    return fail(2, error.message.split('\n')[0]);
  }
}

const { help, file, port, modules } = readArguments();
if (help) {
  console.log('Usage: node serve.mjs [FILE.glb|FILE.gltf] [--port N]\n\nServes the player on http://127.0.0.1:8080/ (--port 0: any free port).');
  process.exit(0);
}
if (file !== undefined && !/\.(glb|gltf)$/i.test(file)) fail(2, `${file}: a .glb or .gltf file is expected`);
if (file !== undefined && !(existsSync(file) && statSync(file).isFile())) fail(3, `${file}: there is no such file`);
if (!existsSync(path.join(modules, 'esbuild'))) {
  console.error('Installing three.js and Babylon.js (npm ci) …');
  const npm = spawnSync('npm', ['ci', '--ignore-scripts', '--no-audit', '--no-fund'], { cwd: kHere, stdio: ['ignore', 'ignore', 'inherit'] });
  if (npm.status !== 0) fail(3, 'npm ci failed; is npm installed, and the registry in reach?');
}
const folders = { '/': path.join(kHere, 'page') };
if (file !== undefined) folders['/files/'] = path.dirname(path.resolve(file));
try {
  const { url } = await serve({ scripts: { '/app.js': path.join(kHere, 'app.mjs') }, folders, modules, port });
  console.log(file === undefined ? `${url}/` : `${url}/?file=files/${encodeURIComponent(path.basename(file))}`);
} catch (error) {
  if (error.code !== 'EADDRINUSE') throw error;
  fail(3, `port ${port} is taken; --port 0 finds a free one`);
}
