#!/usr/bin/env python3
"""octoskin's bridge, seen and fed by programs of another maker.

usage: bridge_test.py FOLDER_OF_PROGRAMS [unittest's arguments]
"""
import json
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import poses
import type_hashes
from bridge_world import SOURCE, World
from programs import Programs, events, wait_for

TOPICS = {"/planning_scene": "moveit_msgs/PlanningScene", "/octoskin/octomap_binary": "octomap_msgs/Octomap",
          "/octoskin/octomap_full": "octomap_msgs/Octomap", "/octoskin/occupied": "sensor_msgs/PointCloud2",
          "/octoskin/occupied_cells_vis_array": "visualization_msgs/MarkerArray",
          "/octoskin/projected_map": "nav_msgs/OccupancyGrid", "/diagnostics": "diagnostic_msgs/DiagnosticArray",
          "/tf_static": "tf2_msgs/TFMessage", "/octoskin/points": "sensor_msgs/PointCloud2",
          "/octoskin/range/n1_s0": "sensor_msgs/Range"}
VOLATILE = ("/diagnostics", "/octoskin/points", "/octoskin/range/n1_s0")
LATE = ("--durability", "transient_local")


def pairs(topics):
    return [word for topic in topics for word in (topic, TOPICS[topic])]


class Out(unittest.TestCase):
    """One daemon and one bridge for all cases: none of them changes the map."""

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
        heard = {event["topic"]: event for event in self.listen(*wanted, seconds=8, count=40)}
        self.assertEqual(sorted(heard), sorted(wanted), self.world.log("bridge"))
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
        self.assertEqual((binary["binary"], full["binary"], binary["id"], full["id"]), (True, False, "OcTree", "OcTree"))
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
        self.assertTrue(changed(lambda scene: scene["world"].update(collision_objects=[{"id": "x"}]))[0]["also_changes"])

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
        with PROGRAMS.start_listening("--seconds", 30, *pairs(["/octoskin/range/n1_s0", "/octoskin/points"])) as listening:
            self.assertTrue(wait_for(lambda: len(listening.events("matched")) == 2))
            self.assertTrue(wait_for(lambda: self.world.topic("/octoskin/points")["readers"] == 1))
            used = self.world.status()["inputs"]["readings"]["used"]
            self.world.play()
            gained = self.world.status()["inputs"]["readings"]["used"] - used
            heard = listening.stop("sample")
        if gained == 0:
            self.skipTest("the daemon takes no recording twice")
        ranges = [event["fields"] for event in heard if event["topic"].startswith("/octoskin/range")]
        self.assertGreater(len(ranges), 5)
        self.assertEqual(ranges[0]["header"]["frame_id"], "octoskin_range_n1_s0")
        self.assertAlmostEqual(ranges[0]["min_range"], 0.04, places=6)
        points = [event["fields"]["width"] for event in heard if event["topic"] == "/octoskin/points"]
        self.assertGreater(sum(points), gained / 4)


RIG = f"""extends: {SOURCE}/hw/rigs/experiment.yaml
name: fed
camera:
  device: "ros:/camera/depth/image_rect_raw"
  width_px: 640
  height_px: 480
  fx_px: 500
  fy_px: 501
  cx_px: 320.5
  cy_px: 240.5
  rate_hz: 30
"""
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
POSTURE = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
INFO = {"width": 640, "height": 480, "distortion_model": "plumb_bob", "d": [0.0] * 5,
        "k": [500, 0, 320, 0, 501, 240, 0, 0, 1], "p": [500, 0, 320, 0, 0, 501, 240, 0, 0, 0, 1, 0]}


def joint_line(**fields):
    return {"topic": "/joint_states", "type": "sensor_msgs/JointState",
            "fields": {"name": JOINTS, "position": POSTURE, **fields}}


def info_line(**fields):
    return {"topic": "/camera/depth/camera_info", "type": "sensor_msgs/CameraInfo", "durability": "transient_local",
            "fields": {**INFO, **fields}}


class In(unittest.TestCase):
    def setUp(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "rig.yaml").write_text(RIG)
        self.world = self.enterContext(World(FOLDER, rig=folder / "rig.yaml", plays=False, daemon_options=[]))

    def counts(self):
        return self.world.bridge_status()["joint_states"]

    def camera(self):
        return self.world.bridge_status()["cameras"][0]

    def problems(self):
        return " ".join(self.world.bridge_status()["problems"])

    def say_joints(self, *options, **fields):
        said = PROGRAMS.say([joint_line(**fields)], "--settle", 0.5, *options)
        self.assertEqual(said.returncode, 0, said.stderr)

    def test_joint_states_and_images_make_the_map(self):
        with PROGRAMS.start_saying([joint_line()], "--stamp-now", "--rate", 100, "--repeat", 1500), \
                PROGRAMS.start_saying([info_line()], "--linger", 15):
            self.assertTrue(wait_for(lambda: self.counts()["forwarded"] > 400, 15), self.counts())
            said = PROGRAMS.run("ros_say", "--images", "640x480", "--rate", 30, "--count", 90, "--stamp-now", "--topic",
                                "/camera/depth/image_rect_raw", "--depth-m", 1.5, "--settle", 1, "--until-read")
            self.assertEqual(said.returncode, 0, said.stderr)
            self.assertTrue(wait_for(lambda: self.camera()["received"] >= 90), self.camera())
            camera, status = self.camera(), self.world.status()
        self.assertEqual((camera["received"], camera["forwarded"], camera["lost"]), (90, 90, 0))
        self.assertEqual(camera["sent"] + camera["displaced"], 90)
        self.assertGreater(camera["sent"], 80)
        self.assertEqual(status["cameras"][0]["why"], "")
        self.assertGreater(status["map"]["known_voxels"], 1000)
        counts = self.counts()
        self.assertEqual(counts["received"], sum(value for key, value in counts.items()
                                                 if key not in ("received", "unsent")))

    def test_each_image_that_does_not_come_is_counted(self):
        with PROGRAMS.start_saying([info_line()], "--linger", 30), \
                PROGRAMS.start_saying([], "--images", "640x480", "--rate", 30, "--count", 120, "--stamp-now", "--topic",
                                      "/camera/depth/image_rect_raw", "--settle", 1, "--qos", "best_effort") as images:
            self.assertTrue(wait_for(lambda: self.camera()["received"] > 20), self.camera())
            self.world.bridge.send_signal(signal.SIGSTOP)
            time.sleep(1.5)  # 27 MB: more than a socket's buffer
            self.world.bridge.send_signal(signal.SIGCONT)
            images.finish()
            self.assertTrue(wait_for(lambda: self.camera()["received"] + self.camera()["lost"] == 120), self.camera())
        self.assertGreater(self.camera()["lost"], 10)

    def test_several_publishers_and_other_names_are_one_robot(self):
        self.say_joints("--stamp-now", "--rate", 50, "--repeat", 20, name=["wheel", *reversed(JOINTS)],
                        position=[9.0, *reversed(POSTURE)])
        self.assertTrue(wait_for(lambda: self.counts()["forwarded"] == 20), self.counts())
        self.say_joints("--stamp-now", "--rate", 50, "--repeat", 5, name=JOINTS[:3], position=POSTURE[:3])
        self.assertTrue(wait_for(lambda: self.counts()["partial"] == 5), self.counts())

    def test_joint_states_that_are_wrong_are_counted_and_the_bridge_goes_on(self):
        lines = [joint_line(position=POSTURE[:6]), joint_line(position=["nan", *POSTURE[1:]]),
                 joint_line(name=[JOINTS[0]] * 7), joint_line(name=["x"] * 7),
                 {"topic": "/joint_states", "type": "sensor_msgs/JointState", "cdr": "0001000001"},
                 {"topic": "/joint_states", "type": "sensor_msgs/JointState", "cdr": "00000000" + "00" * 40}]
        said = PROGRAMS.say(lines, "--settle", 0.5, "--rate", 100)
        self.assertEqual(said.returncode, 0, said.stderr)
        self.assertTrue(wait_for(lambda: self.counts()["received"] == 6), self.counts())
        counts = self.counts()
        self.assertEqual([counts[name] for name in ("wrong_size", "not_finite", "repeated_name", "other_joints",
                                                    "malformed", "forwarded")], [1, 1, 1, 1, 2, 0])
        self.say_joints()  # a stamp of 0: from its arrival
        self.assertTrue(wait_for(lambda: self.counts()["forwarded"] == 1), self.counts())

    def test_a_clock_that_is_off_is_named_with_the_remedy(self):
        for offset in (-3600, 3600):
            stamp = {"stamp": {"sec": int(time.time()) + offset, "nanosec": 0}}
            self.say_joints(header=stamp)
        self.assertTrue(wait_for(lambda: (self.counts()["ahead"], self.counts()["behind"]) == (1, 1)), self.counts())
        self.assertIn("chrony", self.problems())

    def test_every_cut_of_a_message_is_counted(self):
        with tempfile.NamedTemporaryFile() as file:
            encoded = PROGRAMS.run("ros_cdr", "encode", "sensor_msgs/JointState",
                                   input=json.dumps(joint_line()["fields"]).encode())
            file.write(encoded.stdout)
            file.flush()
            said = PROGRAMS.run("ros_say", "--raw", file.name, "sensor_msgs/JointState", "/joint_states", "--truncated",
                                "--settle", 0.5, "--depth", 1000)
            self.assertEqual(said.returncode, 0, said.stderr)
        cuts = len(encoded.stdout) - 1
        # DDS pads to a multiple of four: the last cuts have all of the message's bytes but padding.
        self.assertTrue(wait_for(lambda: self.counts()["received"] == cuts), self.counts())
        self.assertGreaterEqual(self.counts()["malformed"], cuts - 16)

    def test_images_without_their_camera_info_are_not_used(self):
        PROGRAMS.run("ros_say", "--images", "640x480", "--count", 5, "--topic", "/camera/depth/image_rect_raw",
                     "--settle", 1)
        self.assertTrue(wait_for(lambda: self.camera()["no_camera_info"] == 5), self.camera())

    def test_two_publishers_of_one_image_topic_are_not_used(self):
        images = ("ros_say", "--images", "640x480", "--stamp-now", "--topic", "/camera/depth/image_rect_raw")
        with PROGRAMS.start_saying([info_line()], "--linger", 20):
            first = subprocess.Popen(PROGRAMS.command(*images, "--count", 120, "--rate", 20), stdout=subprocess.DEVNULL)
            try:
                self.assertTrue(wait_for(lambda: self.camera()["forwarded"] > 5, 15), self.camera())
                PROGRAMS.run(*images, "--count", 20, "--rate", 10)
                self.assertTrue(wait_for(lambda: self.camera()["second_sender"] > 10, 5), self.camera())
                self.assertTrue(wait_for(lambda: "two programs publish" in self.problems(), 3), self.problems())
            finally:
                first.kill()
                first.wait()

    def test_another_camera_is_named(self):
        with PROGRAMS.start_saying([info_line(k=[600, 0, 320, 0, 601, 240, 0, 0, 1],
                                              p=[600, 0, 320, 0, 0, 601, 240, 0, 0, 0, 1, 0])], "--linger", 20):
            PROGRAMS.run("ros_say", "--images", "320x240", "--count", 3, "--topic", "/camera/depth/image_rect_raw",
                         "--settle", 1)
            self.assertTrue(wait_for(lambda: self.camera()["wrong_size"] == 3), self.camera())
            self.assertTrue(wait_for(lambda: "fx_px: 600.00" in self.problems(), 15), self.problems())

    def test_what_the_planner_has_and_what_the_robot_holds_are_taken(self):
        box = {"id": "table", "header": {"frame_id": "panda_link0"}, "operation": 0,
               "primitives": [{"type": 1, "dimensions": [1, 1, 1]}], "primitive_poses": [{"orientation": {"w": 1}}]}
        cup = {"link_name": "panda_hand", "object": {**box, "id": "cup", "header": {"frame_id": "nowhere"}}}
        line = {"topic": "/monitored_planning_scene", "type": "moveit_msgs/PlanningScene",
                "fields": {"is_diff": True, "world": {"collision_objects": [box]},
                           "robot_state": {"is_diff": True, "attached_collision_objects": [cup]}}}
        with PROGRAMS.start_saying([line], "--settle", 0.5, "--linger", 4) as planner:
            objects = lambda: self.world.bridge_status()["objects"]
            self.assertTrue(wait_for(lambda: (objects()["world"], objects()["held"]) == (1, 1)), objects())
            self.assertTrue(wait_for(lambda: "'nowhere'" in self.problems()), self.problems())
            planner.finish()
        self.assertTrue(wait_for(lambda: objects()["world"] == 0), "with the planner go its objects")

    def test_an_end_of_the_daemon_is_named_and_its_return_noticed(self):
        self.world.daemon.terminate()
        self.world.daemon.wait(10)
        self.assertTrue(wait_for(lambda: not self.world.bridge_status()["daemon"]["connected"], 2))
        self.assertIn("no daemon", self.problems())
        self.world.start_daemon()
        self.assertTrue(wait_for(lambda: self.world.bridge_status()["daemon"]["connected"], 5))


class Commands(unittest.TestCase):
    def octoskin(self, world, *arguments):
        return subprocess.run([world.bin / "octoskin", "bridge", *arguments], env=world.environment,
                              capture_output=True, text=True, timeout=60, check=False)

    def test_the_planners_objects_are_left_out_and_unknown_space_is_filled(self):
        """A box about everything leaves no obstacle; a box of unknown space is one."""
        world = self.enterContext(World(FOLDER, bridge_options=["--unknown-box", "0", "0", "1", "0.4", "0.4", "1.4"]))
        box = {"id": "all", "header": {"frame_id": world.ask("describe")["root_link"]},
               "primitives": [{"type": 1, "dimensions": [20, 20, 20]}], "primitive_poses": [{"orientation": {"w": 1}}]}
        line = {"topic": "/monitored_planning_scene", "type": "moveit_msgs/PlanningScene",
                "fields": {"is_diff": True, "robot_state": {"is_diff": True}, "world": {"collision_objects": [box]}}}

        def clouds(count):
            topic = "/octoskin/occupied"
            with PROGRAMS.start_listening("--seconds", 10, "--count", count, *LATE, *pairs([topic])) as listening:
                return listening.finish("sample")[-1]["fields"]["width"]

        self.assertGreater(clouds(1), 500)
        with PROGRAMS.start_saying([line], "--settle", 0.5, "--linger", 12), tempfile.TemporaryDirectory() as folder:
            self.assertTrue(wait_for(lambda: world.bridge_status()["objects"]["world"] == 1))
            self.assertTrue(wait_for(lambda: clouds(1) == 0, 10))
            with PROGRAMS.start_listening("--seconds", 10, "--count", 1, "--raw", folder, *LATE,
                                          *pairs(["/planning_scene"])) as listening:
                listening.finish()
            postures = pathlib.Path(folder) / "postures.json"
            T_root_map = world.ask("describe")["T_root_map"]
            postures.write_text(json.dumps([[{"a": poses.moved(T_root_map, place), "radius": 0.01}]
                                            for place in ([0.2, 0.2, 1.2], [0.2, 0.2, 2.5])]))
            ended = PROGRAMS.run("moveit_stand_in", "--root", world.ask("describe")["root_link"], "--postures", postures,
                                 *pathlib.Path(folder).glob("*.cdr"))
        self.assertEqual([event["collides"] for event in events(ended.stdout, "posture")], [True, False])

    def test_robot_and_pose_are_taken_from_ros(self):
        world = self.enterContext(World(FOLDER))
        described = world.ask("describe")
        urdf = (world.recording / "robot.urdf").read_text()
        kept = {"durability": "transient_local"}
        tree = [{"header": {"frame_id": parent}, "child_frame_id": child,
                 "transform": {"translation": {"x": 0.5}, "rotation": {"w": 1}}}
                for parent, child in (("camera", "camera_optical"), ("panda_link0", "camera"))]
        lines = [{"topic": "/robot_description", "type": "std_msgs/String", "fields": {"data": urdf}, **kept},
                 {"topic": "/tf_static", "type": "tf2_msgs/TFMessage", "fields": {"transforms": tree}, **kept}]
        with PROGRAMS.start_saying(lines, "--wait", 0.1, "--linger", 25):
            file = world.path / "saved.urdf"
            ended = self.octoskin(world, "robot", str(file))
            self.assertEqual((ended.returncode, file.read_text()), (0, urdf), ended.stderr)
            ended = self.octoskin(world, "pose", "camera_optical", "--socket", str(world.path / "control"))
            self.assertEqual(ended.stdout, 'link: "panda_link0"\npose: {xyz_m: [1.000000, 0.000000, 0.000000], '
                             'quaternion_wxyz: [1.000000000, 0.000000000, 0.000000000, 0.000000000]}\n', ended.stderr)
            ended = self.octoskin(world, "pose", "lamp", "--seconds", "2", "--socket", str(world.path / "control"))
            self.assertEqual(ended.returncode, 69)
            self.assertIn("no frame 'lamp'", ended.stderr)
            self.assertEqual([one for one in world.bridge_status()["problems"] if "robot" in one], [])

    def test_another_robot_is_named(self):
        world = self.enterContext(World(FOLDER))
        line = {"topic": "/robot_description", "type": "std_msgs/String", "durability": "transient_local",
                "fields": {"data": '<robot><link name="panda_link0"/><link name="gripper"/></robot>'}}
        with PROGRAMS.start_saying([line], "--linger", 10):
            named = lambda: any("gripper" in problem for problem in world.bridge_status()["problems"])
            self.assertTrue(wait_for(named))


if __name__ == "__main__":
    FOLDER = sys.argv.pop(1)
    PROGRAMS = Programs(FOLDER)
    POSTURES = 1000
    unittest.main()
