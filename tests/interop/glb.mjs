// The JSON of a .glb, read and replaced.
import { readFileSync, writeFileSync } from 'node:fs';

const kJson = 0x4e4f534a;

export function readGlbJson(file) {
  const bytes = readFileSync(file);
  return JSON.parse(bytes.subarray(20, 20 + bytes.readUInt32LE(12)));
}

/// Writes `to` as `from` with its JSON changed by `change(json)`.
export function changeGlb(from, to, change) {
  const bytes = readFileSync(from), jsonBytes = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + jsonBytes));
  change(json);
  const text = Buffer.from(JSON.stringify(json));
  const chunk = Buffer.concat([text, Buffer.alloc((4 - text.length % 4) % 4, ' ')]);
  const head = Buffer.alloc(20);
  bytes.copy(head, 0, 0, 8);
  head.writeUInt32LE(20 + chunk.length + bytes.length - 20 - jsonBytes, 8);
  head.writeUInt32LE(chunk.length, 12);
  head.writeUInt32LE(kJson, 16);
  writeFileSync(to, Buffer.concat([head, chunk, bytes.subarray(20 + jsonBytes)]));
}
