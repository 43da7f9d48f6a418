#!/usr/bin/env python3
"""moveit_stand_in: which planning scenes MoveIt 2 would take, and what then collides.

usage: moveit_stand_in_test.py FOLDER_OF_PROGRAMS [unittest's arguments]
"""
import json
import math
import pathlib
import sys
import tempfile
import unittest

import samples
from programs import Programs, events

SCENE = "moveit_msgs/PlanningScene"
RESOLUTION_M = 0.05
VOXEL_M = [0.525, -0.275, 0.325]  # the centre of an occupied voxel, in the map


def scene(position_m=VOXEL_M, data=None, binary=True, **octomap):
    """A planning scene as octoskin should publish it: both flags, a map of one voxel, its frame the robot's root."""
    if data is None:
        data = samples.binary_octree(position_m, RESOLUTION_M)
    content = {"binary": binary, "id": "OcTree", "resolution": RESOLUTION_M, "data": {"hex": data.hex()}, **octomap}
    return {"is_diff": True, "robot_state": {"is_diff": True},
            "world": {"octomap": {"header": {"frame_id": "base_link"}, "origin": pose(), "octomap": content}}}


def pose(position_m=(0, 0, 0), quaternion=(0, 0, 0, 1)):
    return {"position": dict(zip("xyz", position_m)), "orientation": dict(zip("xyzw", quaternion))}


def sphere(position_m, radius_m=0.01):
    return [{"a": list(position_m), "radius": radius_m}]


class StandIn(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def apply(self, *scenes, postures=(), options=("--root", "base_link")):
        """Exit code, the outcome of each scene, and for each posture whether it collides."""
        (self.path / "postures.json").write_text(json.dumps(postures))
        files = []
        for number, content in enumerate(scenes):
            files.append(self.path / f"{number}.cdr")
            encoded = PROGRAMS.run("ros_cdr", "encode", SCENE, input=json.dumps(content).encode())
            self.assertEqual(encoded.stderr, b"")
            files[-1].write_bytes(encoded.stdout)
        return self.apply_files(files, options)

    def apply_files(self, files, options=("--root", "base_link")):
        ended = PROGRAMS.run("moveit_stand_in", *options, "--postures", self.path / "postures.json", *files)
        self.assertEqual(ended.stderr, "")
        self.assertIn(ended.returncode, (0, 1))
        return (ended.returncode, events(ended.stdout, "scene"),
                [event["collides"] for event in events(ended.stdout, "posture")])

    def assert_refused(self, content, reason, **options):
        code, outcomes, collides = self.apply(content, postures=[sphere(VOXEL_M)], **options)
        self.assertEqual((code, outcomes[0]["octomap"], collides), (1, "unchanged", [False]))
        self.assertIn(reason, outcomes[0]["errors"])

    # What collides

    def test_spheres_and_capsules_collide_with_the_occupied_voxel_only(self):
        beside = [VOXEL_M[0] + RESOLUTION_M, *VOXEL_M[1:]]
        through = [{"a": [0, VOXEL_M[1], VOXEL_M[2]], "b": [2, VOXEL_M[1], VOXEL_M[2]], "radius": 0.01}]
        along = [{"a": [0, VOXEL_M[1], VOXEL_M[2] + 0.05], "b": [2, VOXEL_M[1], VOXEL_M[2] + 0.05], "radius": 0.02}]
        code, outcomes, collides = self.apply(scene(), postures=[
            sphere(VOXEL_M), sphere(beside), sphere(beside, 0.03), through, along, sphere(beside) + through, []])
        self.assertEqual(code, 0)
        self.assertEqual(outcomes[0]["octomap"], "replaced")
        self.assertEqual([outcomes[0]["tree"][name] for name in ("voxels_occupied", "voxels_free")], [1, 0])
        self.assertEqual(collides, [True, False, True, True, False, True, False])

    def test_origin_and_frame_move_the_map(self):
        half = math.sqrt(0.5)
        moved = scene()
        moved["world"]["octomap"]["origin"] = pose((1, 2, 3), (0, 0, half, half))  # a quarter turn about z
        x, y, z = VOXEL_M
        turned = [1 - y, 2 + x, 3 + z]
        _, _, collides = self.apply(moved, postures=[sphere(turned), sphere(VOXEL_M)])
        self.assertEqual(collides, [True, False])
        (self.path / "frames.json").write_text(json.dumps({"world": [0, 0, 0, 0, 0, 0, 1],
                                                           "base_link": [10, 0, 0, 0, 0, 0, 1]}))
        _, _, collides = self.apply(moved, postures=[sphere([turned[0] + 10, *turned[1:]]), sphere(turned)],
                                    options=("--frames", self.path / "frames.json"))
        self.assertEqual(collides, [True, False])

    def test_a_quaternion_of_zeros_is_no_rotation(self):
        content = scene()
        content["world"]["octomap"]["origin"] = pose((0, 0, 0), (0, 0, 0, 0))
        self.assertEqual(self.apply(content, postures=[sphere(VOXEL_M)])[2], [True])

    def test_full_data_are_occupied_above_log_odds_0(self):
        for log_odds, collides in ((0.4, True), (-0.1, False)):
            with self.subTest(log_odds):
                content = scene(data=samples.full_octree(VOXEL_M, RESOLUTION_M, log_odds, log_odds), binary=False)
                self.assertEqual(self.apply(content, postures=[sphere(VOXEL_M)])[2], [collides])

    def test_full_data_hide_what_lies_in_an_inner_node_that_is_free(self):
        """FCL does not descend into it: in full data, inner nodes must be the maximum of their children."""
        content = scene(data=samples.full_octree(VOXEL_M, RESOLUTION_M, -0.1, 2.0), binary=False)
        self.assertEqual(self.apply(content, postures=[sphere(VOXEL_M)])[2], [False])

    # What changes

    def test_without_an_id_the_map_stays(self):
        other = scene(id="", data=b"")
        code, outcomes, collides = self.apply(scene(), other, postures=[sphere(VOXEL_M)])
        self.assertEqual((code, outcomes[1]["octomap"], collides), (0, "unchanged", [True]))

    def test_with_an_id_and_no_data_the_map_is_cleared(self):
        code, outcomes, collides = self.apply(scene(), scene(data=b""), postures=[sphere(VOXEL_M)])
        self.assertEqual((code, outcomes[1]["octomap"], collides), (0, "cleared", [False]))

    def test_a_further_map_replaces_the_first(self):
        _, _, collides = self.apply(scene(), scene(position_m=[0.025, 0.025, 0.025]),
                                    postures=[sphere(VOXEL_M), sphere([0.025, 0.025, 0.025])])
        self.assertEqual(collides, [False, True])

    def test_fields_that_replace_more_than_the_map_are_named(self):
        content = scene()
        content["world"]["collision_objects"] = [{"id": "box"}]
        content["fixed_frame_transforms"] = [{"child_frame_id": "map"}]
        _, outcomes, _ = self.apply(content)
        self.assertEqual(outcomes[0]["also_changes"], ["fixed_frame_transforms", "world.collision_objects"])

    # What is refused

    def test_refuses_a_scene_that_is_no_diff(self):
        content = scene()
        content["is_diff"] = False
        self.assert_refused(content, "is_diff is false: MoveIt would replace its whole scene")
        content = scene()
        content["robot_state"]["is_diff"] = False
        self.assert_refused(content, "robot_state.is_diff is false: MoveIt would detach all bodies")

    def test_refuses_an_unknown_frame_by_name(self):
        self.assert_refused(scene(), "unknown frame 'base_link'", options=("--root", "world"))

    def test_refuses_another_kind_of_tree(self):
        self.assert_refused(scene(id="ColorOcTree"), "octomap id is 'ColorOcTree', not 'OcTree'")

    def test_refuses_data_that_end_early_or_go_on(self):
        data = samples.binary_octree(VOXEL_M, RESOLUTION_M)
        for length in range(1, len(data)):
            with self.subTest(length):
                self.assert_refused(scene(data=data[:length]), "octomap data end early")
        self.assert_refused(scene(data=data + b"\0"), "octomap data go on behind the tree")

    def test_refuses_a_resolution_and_an_origin_that_are_none(self):
        self.assert_refused(scene(resolution=0), "resolution is 0.000000")
        content = scene()
        content["world"]["octomap"]["origin"]["position"]["x"] = "nan"
        self.assert_refused(content, "origin is not finite")

    def test_refuses_a_message_cut_at_each_byte(self):
        self.apply(scene(data=b"\0\0"))
        whole = (self.path / "0.cdr").read_bytes()
        cuts = []
        for length in range(len(whole)):
            cuts.append(self.path / f"cut {length}.cdr")
            cuts[-1].write_bytes(whole[:length])
        code, outcomes, _ = self.apply_files(cuts)
        self.assertEqual(code, 1)
        self.assertEqual(len(outcomes), len(whole))
        for outcome in outcomes:
            self.assertIn("no message", outcome["errors"][0])


if __name__ == "__main__":
    PROGRAMS = Programs(sys.argv.pop(1))
    unittest.main()
