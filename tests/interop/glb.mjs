// The JSON of a .glb.
import { readFileSync } from 'node:fs';

export function readGlbJson(file) {
  const bytes = readFileSync(file);
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
}
