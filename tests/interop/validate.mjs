// node validate.mjs FILE…: the Khronos validator on each; prints every error and warning, exits 1 when there is one,
// 2 when nothing was checked.
import process from 'node:process';
import { findingsOf, printFindings } from './khronos.mjs';

const files = process.argv.slice(2);
if (files.length === 0) {
  console.error('usage: node validate.mjs FILE.glb|FILE.gltf …');
  process.exit(2);
}

let count = 0;
for (const file of files) {
  const findings = await findingsOf(file);
  printFindings(findings);
  count += findings.length;
}
console.log(`${files.length} files, ${count} errors and warnings`);
process.exit(count === 0 ? 0 : 1);
