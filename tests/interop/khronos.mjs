// The Khronos glTF validator on files: errors and warnings as lines of text. Node 18 or later.
import { readFile } from 'node:fs/promises';
import path from 'node:path';
import validator from 'gltf-validator';

// External resources are read beside the file.
export async function findingsOf(file) {
  const report = await validator.validateBytes(new Uint8Array(await readFile(file)), {
    uri: path.basename(file),
    maxIssues: 0,
    externalResourceFunction: async (uri) =>
      new Uint8Array(await readFile(path.join(path.dirname(file), decodeURIComponent(uri)))),
  });
  return report.issues.messages
    .filter((message) => message.severity <= 1)
    .map((m) => `${file}: ${m.severity === 0 ? 'error' : 'warning'} ${m.code} ${m.pointer ?? ''}: ${m.message}`);
}

export function printFindings(findings) {
  for (const line of findings.slice(0, 20)) console.log(line);
  if (findings.length > 20) console.log(`… and ${findings.length - 20} more`);
}
