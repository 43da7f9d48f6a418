#!/usr/bin/env python3
"""What octoskin's bridge takes, said by programs of another maker.

usage: bridge_in_test.py FOLDER_OF_PROGRAMS [unittest's arguments]
"""
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from bridge_world import SOURCE, World
from programs import Programs, wait_for

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
        self.world = self.enterContext(World(FOLDER, rig=folder / "rig.yaml", is_mapped=False, daemon_options=[]))

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
            self.assertTrue(wait_for(lambda: self.counts()["forwarded"] > 100, 15), self.counts())
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
        lines = [joint_line(header={"stamp": {"sec": int(time.time()) + offset, "nanosec": 0}})
                 for offset in (-3600, 3600)]
        self.assertEqual(PROGRAMS.say(lines, "--settle", 0.5).returncode, 0)
        self.assertTrue(wait_for(lambda: (self.counts()["ahead"], self.counts()["behind"]) == (1, 1)), self.counts())
        self.assertIn("chrony", self.problems())

    def test_every_cut_of_a_message_is_counted(self):
        with tempfile.NamedTemporaryFile() as file:
            encoded = PROGRAMS.run("ros_cdr", "encode", "sensor_msgs/JointState",
                                   input=json.dumps(joint_line()["fields"]).encode())
            file.write(encoded.stdout)
            file.flush()
            said = PROGRAMS.run("ros_say", "--raw", file.name, "sensor_msgs/JointState", "/joint_states", "--truncated",
                                "--settle", 0.5, "--depth", 1000, "--rate", 400)
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
        with PROGRAMS.start_saying([line], "--settle", 0.5, "--linger", 30) as planner:
            objects = lambda: self.world.bridge_status()["objects"]
            self.assertTrue(wait_for(lambda: (objects()["world"], objects()["held"]) == (1, 1)), objects())
            self.assertTrue(wait_for(lambda: "'nowhere'" in self.problems()), self.problems())
            planner.stop()
        self.assertTrue(wait_for(lambda: objects()["world"] == 0), "with the planner go its objects")

    def test_an_end_of_the_daemon_is_named_and_its_return_noticed(self):
        self.world.daemon.terminate()
        self.world.daemon.wait(10)
        self.assertTrue(wait_for(lambda: not self.world.bridge_status()["daemon"]["connected"], 2))
        self.assertIn("no daemon", self.problems())
        self.world.start_daemon()
        self.assertTrue(wait_for(lambda: self.world.bridge_status()["daemon"]["connected"], 5))


if __name__ == "__main__":
    FOLDER = sys.argv.pop(1)
    PROGRAMS = Programs(FOLDER)
    unittest.main()
