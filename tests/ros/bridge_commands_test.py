#!/usr/bin/env python3
"""Options and commands of octoskin's bridge, beside programs of another maker.

usage: bridge_commands_test.py FOLDER_OF_PROGRAMS [unittest's arguments]
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import poses
from bridge_topics import LATE, pairs
from bridge_world import SOURCE, World
from programs import Programs, events, wait_for

KEPT = {"durability": "transient_local"}
POSE = "{xyz_m: [1.000000, 0.000000, 0.000000], quaternion_wxyz: [1.000000000, 0.000000000, 0.000000000, 0.000000000]}"
AT_A_METRE = "{xyz_m: [0, 0, 1], rpy_deg: [0, 0, 0]}"
RIG = f"extends: {SOURCE}/hw/rigs/experiment.yaml\ncamera: ~\ncameras:\n"


def frame(parent, child):
    return {"header": {"frame_id": parent}, "child_frame_id": child,
            "transform": {"translation": {"x": 0.5}, "rotation": {"w": 1}}}


FRAMES = {"topic": "/tf_static", "type": "tf2_msgs/TFMessage", **KEPT, "fields": {"transforms": [
    frame("camera", "camera_optical"), frame("panda_link0", "camera"),
    frame("hand", "hand_optical"), frame("panda_link8", "hand")]}}


def camera(name, pose):
    """Its keys in a rig."""
    return (f"name: {name}, device: \"ros:/{name}/image\", width_px: 64, height_px: 48, fx_px: 60, fy_px: 60, "
            f"cx_px: 32, cy_px: 24, rate_hz: 10, {pose}")


def info_line(name, frame_id):
    return {"topic": f"/{name}/camera_info", "type": "sensor_msgs/CameraInfo", **KEPT,
            "fields": {"header": {"frame_id": frame_id}}}


def error(program):
    """The fields of its error, once it has ended."""
    return json.loads(program.communicate(timeout=60)[1].splitlines()[-1])["error"]


class Commands(unittest.TestCase):
    def octoskin(self, world, *arguments):
        return subprocess.run([world.bin / "octoskin", "bridge", *arguments], env=world.environment,
                              capture_output=True, text=True, timeout=60, check=False)

    def start(self, world, *arguments):
        """With errors as data."""
        return subprocess.Popen([world.bin / "octoskin-bridge", "--json-errors", *arguments], env=world.environment,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)

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
            ended = PROGRAMS.run("moveit_stand_in", "--root", box["header"]["frame_id"], "--postures", postures,
                                 *pathlib.Path(folder).glob("*.cdr"))
        self.assertEqual([event["collides"] for event in events(ended.stdout, "posture")], [True, False])

    def test_robot_and_pose_are_taken_from_ros(self):
        world = self.enterContext(World(FOLDER))
        urdf = (world.recording / "robot.urdf").read_text()
        lines = [{"topic": "/robot_description", "type": "std_msgs/String", "fields": {"data": urdf}, **KEPT}, FRAMES]
        control = ("--socket", str(world.path / "control"))
        with PROGRAMS.start_saying(lines, "--wait", 0.1, "--linger", 25):
            file = world.path / "saved.urdf"
            ended = self.octoskin(world, "robot", str(file))
            self.assertEqual((ended.returncode, file.read_text()), (0, urdf), ended.stderr)
            ended = self.octoskin(world, "pose", "camera_optical", *control)
            self.assertEqual(ended.stdout, f'link: "panda_link0"\npose: {POSE}\n', ended.stderr)
            unknown = [self.start(world, "pose", name, "--seconds", "4", *control)
                       for name in ("lamp", "camera_optcal")]
            errors = [error(ended) for ended in unknown]
            self.assertEqual([one["code"] for one in errors], ["no_data"] * 2, errors)
            self.assertIn("no frame 'lamp'", errors[0]["message"])
            self.assertIn("'camera_optical'", errors[1]["remedy"])
            self.assertEqual([one for one in world.bridge_status()["problems"] if "robot" in one], [])

    def test_poses_of_a_rig_are_taken_from_ros(self):
        """Without a daemon. The camera on the hand hangs from a link that joints move."""
        world = self.enterContext(World(FOLDER))
        rig = world.path / "rig.yaml"
        cameras = [camera("left", "pose: tf"), camera("hand", "pose: tf"), camera("right", "pose: " + AT_A_METRE)]
        rig.write_text(RIG + "".join(f"  - {{{one}}}  # kept\n" for one in cameras))
        left = info_line("left", "camera_optical")
        image = {"topic": "/hand/image", "type": "sensor_msgs/Image",
                 "fields": {"header": {"frame_id": "hand_optical"}}}
        with PROGRAMS.start_saying([FRAMES, left], "--wait", 0.1, "--linger", 25), \
                PROGRAMS.start_saying([image], "--wait", 0.1, "--rate", 10, "--repeat", 250):
            posed = self.octoskin(world, "pose", "--rig", str(rig))
            self.assertEqual(posed.returncode, 0, posed.stderr)
            moved = self.start_posing(world, "left", "pose: tf, link: panda_link8")
            silent = self.start_posing(world, "silent", "pose: tf", "--seconds", "2")
            errors = [error(ended) for ended in (moved, silent)]
        on_hand = f'link: "panda_link8", pose: {POSE}'
        expected = [camera("left", "pose: " + POSE), camera("hand", on_hand), cameras[2]]
        self.assertEqual(posed.stdout, RIG + "".join(f"  - {{{one}}}  # kept\n" for one in expected))
        rig.write_text(posed.stdout)
        checked = subprocess.run([world.bin / "octoskin", "rig", rig], capture_output=True, text=True, check=False)
        self.assertEqual(checked.returncode, 0, checked.stderr)
        self.assertEqual([(one["code"], one.get("key")) for one in errors],
                         [("conflict", "link"), ("no_data", None)])

    def start_posing(self, world, name, pose, *options):
        """With a rig of one camera of this name."""
        file = world.path / f"{name}.yaml"
        file.write_text(f"{RIG}  - {{{camera(name, pose)}}}\n")
        return self.start(world, "pose", "--rig", str(file), *options)

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
    unittest.main()
