// `octoskin replay FILE.mcap`: files that @mcap/core's writer made of a recording's messages give the map of that
// recording, byte for byte; cut, damaged and foreign ones are read as far as they are whole, or refused by a code.
import assert from "node:assert/strict";
import { once } from "node:events";
import fs from "node:fs";
import path from "node:path";
import { before, test } from "node:test";
import { setTimeout as sleep } from "node:timers/promises";

import {
  lz4Frame, McapWriter, MessageWriter, octoskin, readIndexed, recording, rosmsg, scratchFolder, Sink, startOctoskin,
  zstdFrame,
} from "./oracles.mjs";

const source = recording("moving_cones");
const rig = path.join(source, "rig.yaml");
const images = "/octoskin/camera/depth/image_rect_raw";
const info = "/octoskin/camera/depth/camera_info";
const second = 1_000_000_000n;

let messages; // of an export of the recording, decoded
let maps; // of a replay of the recording: name -> bytes

function mapsOf(folder) {
  const names = ["depth.ot", "fused.ot", "proximity.ot"].filter((name) => fs.existsSync(path.join(folder, name)));
  return Object.fromEntries(names.map((name) => [name, fs.readFileSync(path.join(folder, name))]));
}

before(async (context) => {
  const folder = fs.mkdtempSync(path.join(process.env.TMPDIR ?? "/tmp", "octoskin-mcap-"));
  try {
    const file = path.join(folder, "all.mcap");
    const wanted = ["/from_can_bus", "/from_can_bus_fd", "/joint_states", "/octoskin/camera"];
    const done = octoskin("export", source, file, ...wanted.flatMap((topic) => ["--topics", topic]));
    assert.equal(done.code, 0, done.err);
    ({ messages } = await readIndexed(fs.readFileSync(file)));
    const replayed = octoskin("replay", source, "--out", path.join(folder, "maps"));
    assert.equal(replayed.code, 0, replayed.err);
    maps = mapsOf(path.join(folder, "maps"));
  } finally {
    fs.rmSync(folder, { recursive: true, force: true });
  }
});

/** A file of these messages by @mcap/core's writer. */
async function write(list, options = {}) {
  const sink = new Sink();
  const writer = new McapWriter({ writable: sink, ...options });
  await writer.start({ profile: "ros2", library: "another maker" });
  const channels = new Map();
  for (const one of list) {
    if (!channels.has(one.topic)) {
      const schemaId = await writer.registerSchema({ name: one.type, encoding: "ros2msg", data: one.schema.data });
      channels.set(one.topic, await writer.registerChannel(
        { topic: one.topic, messageEncoding: "cdr", schemaId, metadata: new Map() }));
    }
    await writer.addMessage({ channelId: channels.get(one.topic), sequence: 0, logTime: one.time, publishTime: one.time,
      data: one.bytes });
  }
  await writer.end();
  return sink.bytes();
}

/** The same message with other fields. */
function changed(one, change) {
  const message = structuredClone(one.message);
  change(message);
  const writer = new MessageWriter(rosmsg.parse(Buffer.from(one.schema.data).toString(), { ros2: true }));
  return { ...one, message, bytes: writer.writeMessage(message) };
}

function replay(context, bytes, ...options) {
  const folder = scratchFolder(context);
  const file = path.join(folder, "bag.mcap");
  fs.writeFileSync(file, bytes);
  const done = octoskin("--json-errors", "replay", file, "--rig", rig, ...options);
  return { ...done, maps: mapsOf(path.join(folder, "bag.maps")) };
}

/** Imports a bag: {code, error, topics: {topic: {messages, used, reasons}}}. */
function imported(context, bytes, ...options) {
  const folder = scratchFolder(context);
  const file = path.join(folder, "bag.mcap");
  fs.writeFileSync(file, bytes);
  const out = path.join(folder, "recording");
  const done = octoskin("--json-errors", "bridge", "import", file, out, "--rig", rig, ...options);
  const topics = {};
  let newest;
  for (const line of done.out.split("\n")) {
    const topic = line.match(/^(\/\S*) +(\d+) messages = (\d+) used/);
    const reason = line.match(/^ +(\w+) +(\d+)$/);
    if (topic) newest = topics[topic[1]] = { messages: Number(topic[2]), used: Number(topic[3]), reasons: {} };
    else if (reason) newest.reasons[reason[1]] = Number(reason[2]);
  }
  const error = done.code === 0 ? undefined : JSON.parse(done.err.trim().split("\n").at(-1)).error;
  return { code: done.code, error, topics, recording: out };
}

const bus = (list) => list.filter((one) => one.topic !== "/joint_states");
const withoutBus = (list) => list.filter((one) => !one.topic.startsWith("/from_can_bus"));

const layouts = {
  "chunks without compression": {},
  "small chunks of lz4": {
    chunkSize: 50_000,
    compressChunk: (bytes) => ({ compression: "lz4", compressedData: lz4Frame(bytes) }),
  },
  "chunks of zstd": { compressChunk: (bytes) => ({ compression: "zstd", compressedData: zstdFrame(bytes) }) },
  "messages outside chunks": { useChunks: false },
  "no index, no statistics, no summary": {
    useStatistics: false, useSummaryOffsets: false, useMessageIndex: false, useChunkIndex: false,
    repeatSchemas: false, repeatChannels: false, useAttachmentIndex: false, useMetadataIndex: false,
  },
};

for (const [layout, options] of Object.entries(layouts))
  test(`the map is that of the recording: ${layout}`, async (context) => {
    const done = replay(context, await write(bus(messages), options));
    assert.equal(done.code, 0, done.err);
    for (const name of ["depth.ot", "fused.ot", "proximity.ot"]) assert.ok(done.maps[name].equals(maps[name]), name);
  });

test("messages that were written late are sorted by their times, if the file has an index", async (context) => {
  // Each second's images behind its frames of the bus.
  const late = [...bus(messages)].sort((a, b) => {
    const order = (one) => (one.time / second) * 2n + (one.topic.startsWith("/from") ? 0n : 1n);
    return order(a) < order(b) ? -1 : order(a) > order(b) ? 1 : 0;
  });
  const done = replay(context, await write(late, { chunkSize: 20_000 }));
  assert.equal(done.code, 0, done.err);
  assert.ok(done.maps["fused.ot"].equals(maps["fused.ot"]));
});

test("joint states and images without a bus give the map of the camera", async (context) => {
  const done = replay(context, await write(withoutBus(messages)));
  assert.equal(done.code, 0, done.err);
  assert.match(done.err, /no CAN frames \(\/from_can_bus, .*--also \/from_can_bus --also \/from_can_bus_fd/);
  assert.ok(done.maps["depth.ot"].equals(maps["depth.ot"]));
});

test("joint states are taken by name, in any order, with others between them", async (context) => {
  const shuffled = withoutBus(messages).map((one) => one.topic !== "/joint_states" ? one : changed(one, (message) => {
    message.name = ["gripper", ...message.name.reverse()];
    message.position = [0.04, ...Array.from(message.position).reverse()];
    message.velocity = message.name.map(() => 0);
  }));
  const done = replay(context, await write(shuffled));
  assert.equal(done.code, 0, done.err);
  assert.ok(done.maps["depth.ot"].equals(maps["depth.ot"]));
});

test("images in metres (32FC1, big-endian 16UC1) give the same map", async (context) => {
  let isOdd = false;
  const others = withoutBus(messages).map((one) => one.topic !== images ? one : changed(one, (message) => {
    const mm = new Uint16Array(new Uint8Array(message.data).buffer);
    isOdd = !isOdd;
    if (isOdd) {
      message.encoding = "32FC1";
      message.step = 4 * message.width;
      message.data = new Uint8Array(Float32Array.from(mm, (depth) => (depth === 0 ? NaN : depth / 1000)).buffer);
    } else {
      message.is_bigendian = 1;
      message.data = new Uint8Array(Buffer.from(mm.buffer).swap16());
    }
  }));
  const done = replay(context, await write(others));
  assert.equal(done.code, 0, done.err);
  assert.ok(done.maps["depth.ot"].equals(maps["depth.ot"]));
});

test("of a cut file, what is whole before the cut is used", async (context) => {
  const list = withoutBus(messages).filter((one) => one.time - messages[0].time < 4n * second);
  const whole = await write(list, { useChunks: false });
  // The end of each message in the file: behind its 9 bytes of head, 22 of fields and its data.
  const ends = [];
  let at = 8;
  while (at + 9 <= whole.length - 8) {
    const length = Number(whole.readBigUInt64LE(at + 1));
    if (whole[at] === 5) ends.push(at + 9 + length);
    at += 9 + length;
  }
  assert.equal(ends.length, list.length);
  for (let i = 1; i <= 12; ++i) {
    const cut = Math.floor((whole.length * i) / 13) + i;
    const done = imported(context, whole.subarray(0, cut));
    assert.equal(done.code, 0, JSON.stringify(done.error));
    const sum = Object.values(done.topics).reduce((all, topic) => all + topic.messages, 0);
    const infos = list.slice(0, ends.filter((end) => end <= cut).length).filter((one) => one.topic === info).length;
    assert.equal(sum, ends.filter((end) => end <= cut).length - infos, `cut at ${cut}`);
  }
  const chunked = await write(list, {
    chunkSize: 20_000,
    compressChunk: (bytes) => ({ compression: "lz4", compressedData: lz4Frame(bytes) }),
  });
  const used = (one) => Object.values(one.topics).reduce((all, topic) => all + topic.used, 0);
  const steps = new Set([0]);
  for (let i = 1; i <= 12; ++i) {
    const done = imported(context, chunked.subarray(0, Math.floor((chunked.length * i) / 12)));
    if (done.code !== 0) assert.deepEqual([done.code, done.error.code, used(done)], [65, "no_content", 0]);
    assert.ok(used(done) >= Math.max(...steps));
    steps.add(used(done));
  }
  assert.equal(Math.max(...steps), used(imported(context, whole)));
  assert.ok(steps.size > 4);
});

test("each message that is not used has a reason", async (context) => {
  const list = withoutBus(messages);
  const joints = list.filter((one) => one.topic === "/joint_states");
  const pictures = list.filter((one) => one.topic === images);
  const replaced = new Map([
    [joints[10], { ...joints[10], bytes: joints[10].bytes.subarray(0, 40) }],
    [joints[11], changed(joints[11], (message) => (message.position[0] = NaN))],
    [joints[12], changed(joints[12], (message) => (message.position = message.position.slice(1)))],
    [joints[13], changed(joints[13], (message) => (message.header.stamp = { sec: 5, nsec: 0 }))],
    [joints[14], changed(joints[14], (message) => (message.name[0] = "other"))],
    [joints[15], changed(joints[15], (message) => (message.header.stamp = joints[9].message.header.stamp))],
    [pictures[3], changed(pictures[3], (message) => (message.encoding = "rgb8"))],
    [pictures[4], changed(pictures[4], (message) => (message.width += 1))],
    [pictures[5], changed(pictures[5], (message) => (message.data = message.data.subarray(2)))],
    [pictures[6], { ...pictures[6], bytes: new Uint8Array(3) }],
  ]);
  const done = imported(context, await write(list.map((one) => replaced.get(one) ?? one)));
  assert.equal(done.code, 0);
  assert.deepEqual(done.topics["/joint_states"].reasons,
    { malformed: 1, not_finite: 1, partial: 1, stamp_off: 1, still: 1, wrong_size: 1 });
  assert.deepEqual(done.topics[images].reasons, { encoding: 1, malformed: 1, short_data: 1, wrong_size: 1 });
  for (const topic of Object.values(done.topics))
    assert.equal(topic.messages, topic.used + Object.values(topic.reasons).reduce((a, b) => a + b, 0));
});

test("messages of odd times are counted and cost no others", async (context) => {
  const list = withoutBus(messages);
  const joint = list.find((one) => one.topic === "/joint_states");
  const picture = list.find((one) => one.topic === images);
  const early = { ...picture, time: 30n * second };
  const odd = [30n * second, 2n ** 63n - 1n, 2n ** 64n - 1n].map((time) => ({ ...joint, time }));
  const done = imported(context, await write([early, odd[0], ...list, odd[1], odd[2]]));
  assert.equal(done.code, 0);
  assert.deepEqual(done.topics["/joint_states"].reasons, { stamp_off: 3 });
  assert.deepEqual(done.topics[images].reasons, { stamp_off: 1 });
});

test("a bag that has nothing for the rig is refused by a code", async (context) => {
  const others = withoutBus(messages).filter((one) => one.topic === "/joint_states").slice(0, 50)
    .map((one) => changed(one, (message) => (message.name = message.name.map((name) => `${name}_of_another`))));
  const done = imported(context, await write(others));
  assert.deepEqual([done.code, done.error.code], [65, "no_content"]);
  assert.ok(!fs.existsSync(path.join(done.recording, "can.log")));
  const none = imported(context, await write([]));
  assert.deepEqual([none.code, none.error.code], [65, "no_content"]);
  for (const option of ["--can", "--joint-states"]) {
    const unknown = imported(context, await write(messages.slice(0, 500)), option, "/joint_statess");
    assert.deepEqual([unknown.code, unknown.error.code], [64, "unknown_name"]);
  }
  const foreign = imported(context, Buffer.from("SQLite format 3"));
  assert.deepEqual([foreign.code, foreign.error.code], [65, "foreign_format"]);
});

test("times of the log replace stamps of another clock", async (context) => {
  const shifted = withoutBus(messages).map((one) => one.topic === info ? one :
    changed(one, (message) => (message.header.stamp.sec -= 1_000_000_000)));
  const bytes = await write(shifted);
  const refused = imported(context, bytes);
  assert.deepEqual([refused.code, refused.error.code], [65, "no_content"]);
  const done = replay(context, bytes, "--log-time");
  assert.equal(done.code, 0, done.err);
  assert.ok(done.maps["depth.ot"].equals(maps["depth.ot"]));
});

test("a damaged chunk loses its messages and no others", async (context) => {
  const list = withoutBus(messages);
  const bytes = await write(list, { chunkSize: 100_000 });
  const whole = imported(context, bytes);
  const place = bytes.indexOf(Buffer.from("16UC1"), bytes.length >> 1);
  bytes[place] ^= 1;
  const done = imported(context, bytes);
  assert.equal(done.code, 0);
  const used = (one) => Object.values(one.topics).reduce((all, topic) => all + topic.used, 0);
  assert.ok(used(done) < used(whole));
  assert.ok(used(done) > 0.9 * used(whole));
});

test("a replay needs a rig, and cannot go onto a bus", async (context) => {
  const folder = scratchFolder(context);
  const file = path.join(folder, "bag.mcap");
  fs.writeFileSync(file, await write(messages.slice(0, 10)));
  assert.equal(octoskin("replay", file).code, 64);
  assert.equal(octoskin("replay", file, "--rig", rig, "--onto", "can0").code, 64);
  assert.equal(octoskin("replay", source, "--log-time").code, 64);
  // A folder of `ros2 bag`: with one file it is that file, with two of them one must be named.
  fs.writeFileSync(path.join(folder, "metadata.yaml"), "rosbag2_bagfile_information: {}\n");
  const one = octoskin("replay", folder, "--rig", rig, "--out", path.join(folder, "out"));
  assert.notEqual(one.code, 66);
  assert.match(one.out, /^\/from_can_bus /m);
  fs.copyFileSync(file, path.join(folder, "bag_1.mcap"));
  assert.equal(octoskin("replay", folder, "--rig", rig, "--out", path.join(folder, "out")).code, 64);
});

test("an interrupted replay leaves nothing behind, nor does the program that imports", async (context) => {
  const folder = scratchFolder(context);
  const file = path.join(folder, "bag.mcap");
  fs.writeFileSync(file, await write(bus(messages)));
  const temporary = path.join(folder, "temporary");
  fs.mkdirSync(temporary);
  const running = startOctoskin({ TMPDIR: temporary }, "replay", file, "--rig", rig);
  const ended = once(running, "exit");
  while (fs.readdirSync(temporary).length === 0 && running.exitCode === null) await sleep(1);
  running.kill("SIGTERM");
  assert.equal((await ended)[0], 143);
  await sleep(500); // in which the other program would have gone on
  assert.deepEqual(fs.readdirSync(temporary), []);
});

test("links in a folder of ros2 bag are not followed, neither to its file nor to its maps", async (context) => {
  const [folder, elsewhere] = [scratchFolder(context), scratchFolder(context)];
  fs.writeFileSync(path.join(folder, "metadata.yaml"), "rosbag2_bagfile_information: {}\n");
  fs.writeFileSync(path.join(folder, "x.mcap"), await write(bus(messages)));
  fs.symlinkSync(elsewhere, path.join(folder, "x.maps"));
  const maps = octoskin("replay", folder, "--rig", rig);
  assert.notEqual(maps.code, 0);
  assert.match(maps.err, /x\.maps.*link/);
  assert.deepEqual(fs.readdirSync(elsewhere), []);
  fs.renameSync(path.join(folder, "x.mcap"), path.join(elsewhere, "other"));
  fs.symlinkSync(path.join(elsewhere, "other"), path.join(folder, "x.mcap"));
  const file = octoskin("bridge", "import", folder, path.join(folder, "out"), "--rig", rig);
  assert.notEqual(file.code, 0);
  assert.match(file.err, /x\.mcap.*link/);
});
