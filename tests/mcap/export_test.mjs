// `octoskin export`, read by @mcap/core and decoded by @foxglove/rosmsg2-serialization: counts, times and values
// are those of the recording's own text files and of its replay.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { test } from "node:test";

import { decompressHandlers, McapStreamReader, octoskin, readIndexed, recording, scratchFolder, stampNs }
  from "./oracles.mjs";

const daemon = recording("daemon");

/** J, R and D lines of order.log: the order in which the daemon made its map, as text. */
function commits() {
  const lines = fs.readFileSync(path.join(daemon, "order.log"), "utf-8").split("\n").map((line) => line.split(" "));
  const of = (kind) => lines.filter((words) => words[0] === kind).map((words) => words.slice(1));
  return { joints: of("J"), readings: of("R"), frames: of("D") };
}

async function exported(context, ...options) {
  const folder = scratchFolder(context);
  const file = path.join(folder, "out.mcap");
  const done = octoskin("export", daemon, file, ...options);
  assert.equal(done.code, 0, done.err);
  const bytes = fs.readFileSync(file);
  return { folder, file, bytes, ...(await readIndexed(bytes)) };
}

const on = (messages, topic) => messages.filter((one) => one.topic === topic);

/** The offset between wall time and the bus, from the first message: all messages must have it. */
function offsetOf(messages, busTimes) {
  const offset = messages[0].time - busTimes[0];
  assert.deepEqual(messages.map((one) => one.time - offset), busTimes);
  return offset;
}

test("joint states, ranges and images are those of order.log, value for value", async (context) => {
  const { messages } = await exported(context);
  const { joints, readings, frames } = commits();

  const states = on(messages, "/joint_states");
  assert.deepEqual(states.map((one) => Array.from(one.message.position)),
    joints.map((one) => one.slice(1).map(Number)));
  const byTime = (times) => times.map(BigInt).sort((a, b) => (a < b ? -1 : a > b ? 1 : 0));
  const offset = offsetOf(states, byTime(joints.map((one) => one[0])));
  for (const one of states) assert.equal(stampNs(one.message.header.stamp), one.time);

  const ranges = messages.filter((one) => one.topic.startsWith("/octoskin/range/"));
  const key = (topic, time, range) => `${topic} ${time} ${range}`;
  const expected = readings.map(([node, sensor, , time, range]) =>
    key(`/octoskin/range/n${node}_s${sensor}`, BigInt(time) + offset,
      range === "-" ? Infinity : Math.fround(Number(range))));
  assert.deepEqual(ranges.map((one) => key(one.topic, one.time, one.message.range)).sort(), expected.sort());

  const images = on(messages, "/octoskin/camera/depth/image_rect_raw");
  assert.deepEqual(images.map((one) => one.time - offset), byTime(frames.map((one) => one[1])));
  for (const { message } of images) {
    assert.equal(message.encoding, "16UC1");
    assert.equal(message.data.length, 2 * message.width * message.height);
  }
  const infos = on(messages, "/octoskin/camera/depth/camera_info");
  assert.equal(infos.length, images.length);
  assert.deepEqual(Array.from(infos[0].message.k), [365, 0, 255.5, 0, 365, 211.5, 0, 0, 1]);
});

test("the last octree is the file that a replay saves", async (context) => {
  const { messages, folder } = await exported(context);
  const replayed = octoskin("replay", daemon, "--fused-only", "--out", path.join(folder, "maps"));
  assert.equal(replayed.code, 0, replayed.err);
  const file = fs.readFileSync(path.join(folder, "maps/fused.bt"));
  const body = file.subarray(file.indexOf("data\n") + 5);
  const octrees = on(messages, "/octoskin/octomap_binary");
  const last = octrees.at(-1).message;
  assert.equal(last.resolution, 0.04);
  assert.ok(Buffer.from(last.data.buffer, last.data.byteOffset, last.data.length).equals(body));
  for (let i = 1; i + 1 < octrees.length; ++i)
    assert.ok(octrees[i].time - octrees[i - 1].time >= 500_000_000n, "a map twice a second at most");
  const cloud = on(messages, "/octoskin/occupied").at(-1).message;
  assert.equal(cloud.data.length, cloud.width * cloud.point_step);
  assert.ok(cloud.width > 1000);
});

test("robot and frames are one tree, from the root link to every frame that messages name", async (context) => {
  const { messages } = await exported(context);
  const description = on(messages, "/robot_description");
  assert.equal(description.length, 1);
  assert.equal(description[0].message.data, fs.readFileSync(path.join(daemon, "robot.urdf"), "utf-8"));
  const parents = new Map();
  for (const { message } of messages.filter((one) => one.topic === "/tf" || one.topic === "/tf_static"))
    for (const frame of message.transforms) {
      const { rotation } = frame.transform;
      const norm = Math.hypot(rotation.x, rotation.y, rotation.z, rotation.w);
      assert.ok(Math.abs(norm - 1) < 1e-9);
      const before = parents.get(frame.child_frame_id);
      assert.ok(before === undefined || before === frame.header.frame_id, "one parent");
      parents.set(frame.child_frame_id, frame.header.frame_id);
    }
  const rootOf = (frame) => {
    let steps = 0;
    while (parents.has(frame) && steps++ < 100) frame = parents.get(frame);
    return frame;
  };
  const links = [...description[0].message.data.matchAll(/<link name="([^"]+)"/g)].map((match) => match[1]);
  const named = messages.map((one) => one.message.header?.frame_id).filter((name) => name);
  assert.ok(named.length > 1000);
  for (const frame of [...links, ...named]) assert.equal(rootOf(frame), "panda_link0", frame);
});

test("CAN frames are the lines of can.log", async (context) => {
  const { messages } = await exported(context, "--topics", "/from_can_bus", "--topics", "/from_can_bus_fd");
  const lines = fs.readFileSync(path.join(daemon, "can.log"), "utf-8").trimEnd().split("\n");
  const hex = (bytes) => Buffer.from(bytes).toString("hex").toUpperCase();
  const text = ({ message, time }) => {
    const stamp = `(${time / 1_000_000_000n}.${String((time % 1_000_000_000n) / 1000n).padStart(6, "0")})`;
    const id = message.id.toString(16).toUpperCase().padStart(message.is_extended ? 8 : 3, "0");
    const flags = message.len !== undefined ? "#1" : "";
    const data = hex(message.data.slice(0, message.len ?? message.dlc));
    return `${stamp} ${message.header.frame_id} ${id}#${flags}${data}`;
  };
  assert.equal(messages.length, lines.length);
  assert.deepEqual(messages.map(text).sort(), lines.sort());
});

test("the file is whole: checksums, statistics, index, profile, schemas, QoS", async (context) => {
  const { bytes, messages, reader } = await exported(context, "--topics", "all");
  assert.equal(reader.header.profile, "ros2");
  assert.equal(reader.statistics.messageCount, BigInt(messages.length));
  assert.equal(reader.statistics.chunkCount, reader.chunkIndexes.length);
  const perChannel = new Map();
  for (const one of messages) perChannel.set(one.channel.id, (perChannel.get(one.channel.id) ?? 0n) + 1n);
  assert.deepEqual(new Map([...reader.statistics.channelMessageCounts].sort()), new Map([...perChannel].sort()));
  for (const { channel, schema } of messages) {
    assert.equal(channel.messageEncoding, "cdr");
    assert.equal(schema.encoding, "ros2msg");
    assert.match(channel.metadata.get("offered_qos_profiles"), /durability: [12]/);
  }
  const topics = new Set(messages.map((one) => one.topic));
  for (const topic of ["/planning_scene", "/octoskin/octomap_full", "/octoskin/projected_map", "/diagnostics"])
    assert.ok(topics.has(topic), topic);
  // Read as a stream, every checksum and every record in its place.
  const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  stream.append(new Uint8Array(bytes));
  const counts = {};
  for (let record = stream.nextRecord(); record; record = stream.nextRecord())
    counts[record.type] = (counts[record.type] ?? 0) + 1;
  assert.ok(stream.done());
  assert.equal(counts.Message, messages.length);
  assert.equal(counts.Footer, 1);
});

test("topics are chosen, a wrong one is refused, and a file is not replaced", async (context) => {
  const { messages, file } = await exported(context, "--topics", "/octoskin/range", "--also", "/planning_scene");
  const topics = new Set(messages.map((one) => one.topic));
  assert.ok([...topics].every((one) => one === "/planning_scene" || one.startsWith("/octoskin/range/")));
  assert.ok(topics.has("/planning_scene"));
  const before = fs.readFileSync(file);
  const again = octoskin("--json-errors", "export", daemon, file);
  assert.equal(again.code, 73);
  assert.deepEqual(fs.readFileSync(file), before);
  assert.equal(octoskin("export", daemon, file, "--topics", "/no_such_topic", "--force").code, 64);
  assert.deepEqual(fs.readdirSync(path.dirname(file)), ["out.mcap"]);
  assert.equal(octoskin("export", path.join(daemon, "none"), `${file}2`).code, 66);
});
