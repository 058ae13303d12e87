// Bundles pages in memory (esbuild) and serves them, the Draco decoders and folders of scenes on this machine only.
// Node 18 or later.
import { createReadStream } from 'node:fs';
import { stat } from 'node:fs/promises';
import http from 'node:http';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';

const kHere = path.dirname(fileURLToPath(import.meta.url));
const kTypes = {
  '.html': 'text/html; charset=utf-8', '.css': 'text/css; charset=utf-8', '.js': 'text/javascript; charset=utf-8',
  '.json': 'application/json', '.svg': 'image/svg+xml', '.wasm': 'application/wasm', '.glb': 'model/gltf-binary',
  '.gltf': 'model/gltf+json', '.png': 'image/png', '.jpg': 'image/jpeg',
};

/// Bundles {'/app.js': 'app.mjs', …}; packages are looked for in `modules` (a node_modules folder).
async function bundle(scripts, modules) {
  const { build } = await import(pathToFileURL(path.join(modules, 'esbuild', 'lib', 'main.js')).href);
  const texts = new Map();
  for (const [url, entry] of Object.entries(scripts)) {
    const result = await build({
      entryPoints: [entry], bundle: true, write: false, format: 'esm', target: 'es2022', nodePaths: [modules], minify: true, logLevel: 'error',
    });
    texts.set(url, Buffer.from(result.outputFiles[0].contents));
  }
  return texts;
}

/// Sends a file of `folder`, and nothing outside of it.
async function sendFile(folder, name, request, response) {
  const file = path.join(folder, path.normalize(`/${name}`));
  const facts = await stat(file).catch(() => null);
  if (facts === null || !facts.isFile()) {
    response.writeHead(404, { 'content-type': 'text/plain' }).end(`there is no ${name}\n`);
    return;
  }
  response.writeHead(200, {
    'content-type': kTypes[path.extname(file).toLowerCase()] ?? 'application/octet-stream', 'content-length': facts.size, 'cache-control': 'no-store',
  });
  if (request.method === 'HEAD') response.end();
  else createReadStream(file).pipe(response);
}

/// folders: {'/': 'folder', '/scenes/': 'folder', …}, the longest prefix wins; scripts as for bundle(); port 0: any free one.
/// Promise<{url, close()}>.
export async function serve({ folders = {}, scripts = {}, modules = path.join(kHere, 'node_modules'), port = 0 }) {
  const texts = await bundle(scripts, modules);
  const all = {
    '/vendor/three/': path.join(modules, 'three', 'examples', 'jsm', 'libs', 'draco', 'gltf'),
    '/vendor/babylon/': path.join(modules, '@babylonjs', 'core', 'assets', 'Draco'),
    ...folders,
  };
  const prefixes = Object.keys(all).sort((a, b) => b.length - a.length);
  const server = http.createServer((request, response) => {
    const where = (() => {
      try {
        return decodeURIComponent(new URL(request.url, 'http://localhost').pathname);
      } catch {
        return null;
      }
    })();
    if (where === null || where.includes('\0') || !['GET', 'HEAD'].includes(request.method)) {
      response.writeHead(400).end();
      return;
    }
    if (texts.has(where)) {
      response.writeHead(200, { 'content-type': kTypes['.js'], 'cache-control': 'no-store' }).end(texts.get(where));
      return;
    }
    const prefix = prefixes.find((candidate) => where.startsWith(candidate));
    if (prefix === undefined) response.writeHead(404).end();
    else void sendFile(all[prefix], where === '/' ? 'index.html' : where.slice(prefix.length), request, response);
  });
  await new Promise((resolve, reject) => server.once('error', reject).listen(port, '127.0.0.1', resolve));
  return { url: `http://127.0.0.1:${server.address().port}`, close: () => new Promise((resolve) => { server.closeAllConnections(); server.close(resolve); }) };
}
