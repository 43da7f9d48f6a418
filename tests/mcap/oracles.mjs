// The independent programs of these tests, and the recordings and programs of this project.
import { spawn, spawnSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../..");
const modules = path.join(process.env.OCTOSKIN_NPM ?? path.join(root, "build/npm"), "oracles");
const load = createRequire(path.join(modules, "package.json"));

export const { McapIndexedReader, McapStreamReader, McapWriter } = load("@mcap/core");
export const rosmsg = load("@foxglove/rosmsg");
export const { MessageReader, MessageWriter } = load("@foxglove/rosmsg2-serialization");
const fzstd = load("fzstd");
const lz4 = load("lz4js");

export const decompressHandlers = {
  zstd: (packed, size) => fzstd.decompress(packed, new Uint8Array(Number(size))),
  lz4: (packed) => lz4.decompress(packed),
};

export const lz4Frame = (bytes) => lz4.compress(bytes);

/** The content of one frame of zstd with a raw block for each 128 kB: what a writer may make without a compressor. */
export function zstdFrame(bytes) {
  const blockMax = 1 << 17;
  const head = Buffer.alloc(13);
  head.writeUInt32LE(0xfd2fb528, 0);
  head.writeUInt8(0xe0, 4); // a single segment, its size in 64 bits
  head.writeBigUInt64LE(BigInt(bytes.length), 5);
  const parts = [head];
  for (let at = 0; at < bytes.length || at === 0; at += blockMax) {
    const block = bytes.subarray(at, at + blockMax);
    const isLast = at + blockMax >= bytes.length;
    const blockHead = Buffer.alloc(3);
    blockHead.writeUIntLE((block.length << 3) | (isLast ? 1 : 0), 0, 3);
    parts.push(blockHead, block);
  }
  return new Uint8Array(Buffer.concat(parts));
}

/** A file in memory as @mcap/core reads it. */
export class Bytes {
  constructor(bytes) {
    this.bytes = bytes;
  }
  async size() {
    return BigInt(this.bytes.length);
  }
  async read(offset, length) {
    const begin = Number(offset);
    return new Uint8Array(this.bytes.subarray(begin, begin + Number(length)));
  }
}

/** A file that @mcap/core writes to, in memory. */
export class Sink {
  constructor() {
    this.parts = [];
    this.length = 0;
  }
  position() {
    return BigInt(this.length);
  }
  async write(bytes) {
    this.parts.push(Buffer.from(bytes));
    this.length += bytes.length;
  }
  bytes() {
    return Buffer.concat(this.parts);
  }
}

export const recording = (name) => path.join(root, "tests/data/frozen", name);

export function scratchFolder(context) {
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "octoskin-mcap-"));
  context.after(() => fs.rmSync(folder, { recursive: true, force: true }));
  return folder;
}

const program = path.join(process.env.OCTOSKIN_BIN ?? path.join(root, "build/host-release/bin"), "octoskin");

/** Starts `octoskin` with these variables beside those of this process. */
export const startOctoskin = (variables, ...words) =>
  spawn(program, words, { stdio: "ignore", env: { ...process.env, ...variables } });

/** Runs `octoskin`; its exit code, output and errors. */
export function octoskin(...words) {
  const done = spawnSync(program, words, { encoding: "utf-8", timeout: 120_000 });
  return { code: done.status, out: done.stdout, err: done.stderr };
}

/** All messages of a file, decoded, in the order of their times: [{topic, time, type, message, bytes}]. */
export async function readIndexed(bytes) {
  const reader = await McapIndexedReader.Initialize({ readable: new Bytes(bytes), decompressHandlers });
  const readers = new Map();
  const messages = [];
  for await (const one of reader.readMessages()) {
    const channel = reader.channelsById.get(one.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    if (!readers.has(schema.id))
      readers.set(schema.id, new MessageReader(rosmsg.parse(Buffer.from(schema.data).toString(), { ros2: true })));
    messages.push({
      topic: channel.topic,
      time: one.logTime,
      type: schema.name,
      message: readers.get(schema.id).readMessage(one.data),
      bytes: one.data,
      channel,
      schema,
    });
  }
  return { messages, reader };
}

export const stampNs = (stamp) => BigInt(stamp.sec) * 1_000_000_000n + BigInt(stamp.nanosec ?? stamp.nsec);
