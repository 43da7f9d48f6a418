#!/usr/bin/env python3
"""What octoskin's bridge publishes, seen by programs of another maker.

usage: bridge_out_test.py FOLDER_OF_PROGRAMS [unittest's arguments]
"""
import json
import pathlib
import random
import subprocess
import sys
import tempfile
import time
import unittest

import poses
import type_hashes
from bridge_topics import LATE, TOPICS, VOLATILE, pairs
from bridge_world import World
from programs import Programs, events, wait_for

POSTURES = 1000


class Out(unittest.TestCase):
    """One daemon and one bridge for all cases. One of them plays the recording, the others expect its map."""

    @classmethod
    def setUpClass(cls):
        cls.world = cls.enterClassContext(World(FOLDER))
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory())

    def listen(self, *topics, seconds=15, count=1, options=LATE):
        with PROGRAMS.start_listening("--seconds", seconds, "--count", count, *options, *pairs(topics)) as listening:
            return listening.finish("sample")

    def scene_file(self):
        folder = pathlib.Path(self.folder) / "raw"
        self.listen("/planning_scene", options=(*LATE, "--raw", folder))
        return next(folder.glob("*.cdr"))

    def stand_in(self, scene, postures):
        file = pathlib.Path(self.folder) / "postures.json"
        file.write_text(json.dumps(postures))
        ended = PROGRAMS.run("moveit_stand_in", "--root", self.world.ask("describe")["root_link"], "--postures", file,
                             scene)
        return (events(ended.stdout, "scene")[0], [event["collides"] for event in events(ended.stdout, "posture")])

    def test_every_map_topic_arrives_whole(self):
        wanted = [topic for topic in TOPICS if topic not in VOLATILE]
        with PROGRAMS.start_listening("--seconds", 15, *LATE, *pairs(wanted)) as listening:
            arrived = lambda: {event["topic"] for event in listening.events("sample")}
            self.assertTrue(wait_for(lambda: arrived() == set(wanted)), arrived())
            heard = {event["topic"]: event for event in listening.stop("sample")}
        for event in heard.values():
            self.assertNotIn("malformed", event)
            self.assertLess(event["unread"], 4, event["topic"])  # DDS pads to a multiple of four
        occupied = heard["/octoskin/occupied"]["fields"]
        self.assertGreater(occupied["width"], 500)
        self.assertEqual([field["name"] for field in occupied["fields"]],
                         ["x", "y", "z", "size", "occupancy", "age_s", "kind"])
        points = sum((marker["scale"]["x"] / 0.04) ** 3 * len(marker["points"])
                     for marker in heard["/octoskin/occupied_cells_vis_array"]["fields"]["markers"])
        self.assertAlmostEqual(points, occupied["width"], places=3)
        binary, full = (heard["/octoskin/octomap_" + form]["fields"] for form in ("binary", "full"))
        self.assertEqual([(form["binary"], form["id"]) for form in (binary, full)],
                         [(True, "OcTree"), (False, "OcTree")])
        self.assertEqual(binary["header"]["frame_id"], "octoskin_map")
        self.assertLess(abs(heard["/octoskin/octomap_binary"]["at_s"] - binary["header"]["stamp"]["sec"]), 20)

    def test_writers_have_the_types_qos_and_hashes_of_ros(self):
        types = type_hashes.read_types()
        with PROGRAMS.start_listening("--publishers", "--seconds", 6, "/tf_static", "tf2_msgs/TFMessage") as listening:
            wait_for(lambda: len(listening.events("endpoint")) >= len(TOPICS), 5)
            found = {event["topic"]: event for event in listening.stop("endpoint") if event["kind"] == "writer"}
        for topic, name in TOPICS.items():
            with self.subTest(topic):
                package, message = name.split("/")
                self.assertEqual(found[topic]["dds_type"], f"{package}::msg::dds_::{message}_")
                self.assertEqual(found[topic]["type_hash"], type_hashes.type_hash(types, name))
                self.assertEqual(found[topic]["reliability"], "reliable")
                is_kept = topic not in VOLATILE
                self.assertEqual(found[topic]["durability"], "transient_local" if is_kept else "volatile")
                self.assertFalse(found[topic]["has_key"])
        self.assertNotIn("/planning_scene_world", found)
        self.assertNotIn("ros_discovery_info", found)

    def test_frames_hang_from_the_robot(self):
        transforms = self.listen("/tf_static")[0]["fields"]["transforms"]
        described = self.world.ask("describe")
        self.assertEqual(transforms[0]["header"]["frame_id"], described["root_link"])
        self.assertEqual(transforms[0]["child_frame_id"], "octoskin_map")
        for axis, value in zip("xyz", described["T_root_map"]["p"]):
            self.assertAlmostEqual(transforms[0]["transform"]["translation"][axis], value)
        self.assertEqual(len(transforms), 1 + len(described["sensors"]))
        self.assertFalse({one["child_frame_id"] for one in transforms} & set(described["links"]))
        for sensor, one in zip(described["sensors"], transforms[1:]):
            rotation = one["transform"]["rotation"]
            along = poses.turned([rotation[axis] for axis in "xyzw"], [1, 0, 0])
            expected = poses.turned(sensor["T_link_sensor"]["q"], [0, 0, 1])
            for a, b in zip(along, expected):
                self.assertAlmostEqual(a, b, places=9)

    def test_diagnostics_are_the_problems_one_to_one(self):
        heard = self.listen("/diagnostics", options=())[0]["fields"]["status"]
        daemon = [one for one in heard if one["name"] != "octoskin: bridge"]
        problems = self.world.status()["problems"]
        self.assertEqual([dict((pair["key"], pair["value"]) for pair in one["values"])["code"] for one in daemon],
                         [problem["code"] for problem in problems])

    def test_moveit_takes_the_scene_and_collides_where_a_query_says_occupied(self):
        described = self.world.ask("describe")
        joints = [joint for source in described["joint_sources"] for joint in source["joints"]]
        limits = {joint["name"]: (joint["min"], joint["max"]) for joint in described["joints"]}
        chance = random.Random(1)
        configurations = [[chance.uniform(*limits[joint]) for joint in joints] for _ in range(POSTURES)]
        scene, collides = self.stand_in(self.scene_file(), [poses.body(described, dict(zip(joints, one)))
                                                            for one in configurations])
        self.assertEqual((scene["octomap"], scene["errors"], scene["also_changes"]), ("replaced", [], []))
        asked = [self.world.ask("query " + json.dumps({"path": [one], "reach_m": 0, "asks_unmoved_links": True}))
                 for one in configurations]
        self.assertEqual(collides, [answer["state"] == "occupied" for answer in asked])
        self.assertGreater(sum(collides), POSTURES // 20)
        self.assertLess(sum(collides), POSTURES - POSTURES // 20)

    def test_a_scene_with_a_wrong_flag_frame_or_origin_is_noticed(self):
        file = self.scene_file()
        decoded = subprocess.run(PROGRAMS.command("ros_cdr", "decode", "moveit_msgs/PlanningScene", "--all-bytes"),
                                 input=file.read_bytes(), capture_output=True, check=True)
        described = self.world.ask("describe")
        postures = [poses.body(described, {})] + [
            [{"a": [chance.uniform(-1, 1) for _ in range(3)], "radius": 0.05}] for chance in
            [random.Random(seed) for seed in range(300)]]
        _, sound = self.stand_in(file, postures)

        def changed(change):
            scene = json.loads(decoded.stdout)["fields"]
            change(scene)
            mutant = pathlib.Path(self.folder) / "mutant.cdr"
            encoded = PROGRAMS.run("ros_cdr", "encode", "moveit_msgs/PlanningScene", input=json.dumps(scene).encode())
            mutant.write_bytes(encoded.stdout)
            return self.stand_in(mutant, postures)

        self.assertEqual(changed(lambda scene: None)[1], sound)
        self.assertTrue(changed(lambda scene: scene.update(is_diff=False))[0]["errors"])
        self.assertTrue(changed(lambda scene: scene["robot_state"].update(is_diff=False))[0]["errors"])
        octomap = lambda scene: scene["world"]["octomap"]
        self.assertTrue(changed(lambda scene: octomap(scene)["header"].update(frame_id="octoskin_map"))[0]["errors"])
        self.assertNotEqual(changed(lambda scene: octomap(scene)["origin"]["position"].update(z=0.5))[1], sound)
        with_object = changed(lambda scene: scene["world"].update(collision_objects=[{"id": "x"}]))
        self.assertTrue(with_object[0]["also_changes"])

    def test_a_volatile_reader_that_comes_late_gets_the_scene_within_two_seconds(self):
        begun = time.monotonic()
        self.assertTrue(self.listen("/planning_scene", seconds=6, options=()))
        self.assertLess(time.monotonic() - begun, 5)

    def test_nothing_is_made_for_a_topic_without_a_reader(self):
        self.assertTrue(wait_for(lambda: self.world.bridge_status()["network"]["matched_topics"] == 0))
        before = {topic["topic"]: topic["sent"] for topic in self.world.bridge_status()["topics"]}
        time.sleep(2.5)
        self.assertEqual({topic["topic"]: topic["sent"] for topic in self.world.bridge_status()["topics"]}, before)

    def test_readings_arrive_while_they_are_made(self):
        topics = pairs(["/octoskin/range/n1_s0", "/octoskin/points", "/octoskin/octomap_binary"])
        with PROGRAMS.start_listening("--seconds", 30, *topics) as listening:
            self.assertTrue(wait_for(lambda: len(listening.events("matched")) == 3))
            self.assertTrue(wait_for(lambda: self.world.topic("/octoskin/points")["readers"] == 1))
            used = self.world.status()["inputs"]["readings"]["used"]
            self.world.play()
            gained = self.world.status()["inputs"]["readings"]["used"] - used
            heard = listening.stop("sample")
        self.assertGreater(gained, 1000)
        ranges = [event["fields"] for event in heard if event["topic"].startswith("/octoskin/range")]
        self.assertGreater(len(ranges), 5)
        self.assertEqual(ranges[0]["header"]["frame_id"], "octoskin_range_n1_s0")
        self.assertAlmostEqual(ranges[0]["min_range"], 0.04, places=6)
        points = [event["fields"]["width"] for event in heard if event["topic"] == "/octoskin/points"]
        self.assertGreater(sum(points), gained / 4)
        maps = [event["at_s"] for event in heard if event["topic"] == "/octoskin/octomap_binary"]
        self.assertGreater(len(maps), 10, "it changes with the readings")


if __name__ == "__main__":
    FOLDER = sys.argv.pop(1)
    PROGRAMS = Programs(FOLDER)
    unittest.main()
