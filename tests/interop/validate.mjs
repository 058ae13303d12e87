// node validate.mjs FILE…: the Khronos validator on each; prints every error and warning, exits 1 when there is one,
// 2 when nothing was checked. External resources are read beside the file. Node 18 or later.
import { readFile } from 'node:fs/promises';
import path from 'node:path';
import process from 'node:process';
import validator from 'gltf-validator';

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate.mjs FILE.glb|FILE.gltf …');
  process.exit(2);
}

let findings = 0;
for (const file of files) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: path.basename(file),
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  const bad = report.issues.messages.filter((message) => message.severity <= 1);
  findings += bad.length;
  for (const m of bad.slice(0, 20)) console.log(`${file}: ${m.severity === 0 ? 'error' : 'warning'} ${m.code} ${m.pointer ?? ''}: ${m.message}`);
  if (bad.length > 20) console.log(`${file}: … and ${bad.length - 20} more`);
}
console.log(`${files.length} files, ${findings} errors and warnings`);
process.exit(findings === 0 ? 0 : 1);
