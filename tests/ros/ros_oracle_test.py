#!/usr/bin/env python3
"""ros_say, ros_listen and ros_cdr: every field of every type arrives, and no bytes stop a listener.

usage: ros_oracle_test.py FOLDER_OF_PROGRAMS [unittest's arguments]
"""
import copy
import json
import pathlib
import struct
import sys
import tempfile
import unittest

import samples
import type_hashes
from programs import Programs, events

TYPES = samples.ALL_TYPES
JOINTS = "sensor_msgs/JointState"


def topic_of(name):
    return "/said/" + name.replace("/", "_").lower()


def line(name, fields, **more):
    return {"topic": topic_of(name), "type": name, "fields": fields, **more}


class Bytes(unittest.TestCase):
    """ros_cdr, compared with the encoder of samples.py."""

    def test_are_those_of_a_second_encoder_for_each_type(self):
        for name in TYPES:
            for elements in (0, 1, 3):
                values = samples.sample(TYPES, name, elements)
                with self.subTest(name, elements=elements):
                    encoded = PROGRAMS.run("ros_cdr", "encode", name, input=json.dumps(values).encode())
                    self.assertEqual(encoded.stderr, b"")
                    self.assertEqual(encoded.stdout, samples.cdr(TYPES, name, values))

    def test_of_an_older_layout_leave_bytes_unread(self):
        longer = samples.cdr(TYPES, "std_msgs/String", {"data": "abc"}) + b"\1\2\3\4"
        decoded = PROGRAMS.run("ros_cdr", "decode", "std_msgs/String", input=longer)
        self.assertEqual(json.loads(decoded.stdout), {"unread": 4, "fields": {"data": "abc"}})

    def test_in_big_endian_order_are_read(self):
        swapped = b"\x00\x00\x00\x00" + struct.pack(">I", 4) + b"abc\0"
        decoded = PROGRAMS.run("ros_cdr", "decode", "std_msgs/String", input=swapped)
        self.assertEqual(json.loads(decoded.stdout)["fields"], {"data": "abc"})

    def test_of_swapped_fields_differ(self):
        mutant = copy.copy(TYPES)
        fields = TYPES["sensor_msgs/Range"]
        mutant["sensor_msgs/Range"] = fields[:4] + [fields[5], fields[4]] + fields[6:]
        values = samples.sample(TYPES, "sensor_msgs/Range")
        self.assertNotEqual(samples.cdr(mutant, "sensor_msgs/Range", values),
                            samples.cdr(TYPES, "sensor_msgs/Range", values))

    def test_refuse_what_is_no_message(self):
        for wrong in ({"data": 5}, {"date": "x"}, [], {"data": None}):
            with self.subTest(wrong):
                encoded = PROGRAMS.run("ros_cdr", "encode", "std_msgs/String", input=json.dumps(wrong).encode())
                self.assertNotEqual(encoded.returncode, 0)
                self.assertEqual(encoded.stdout, b"")

    def test_name_the_place_of_a_wrong_value(self):
        wrong = json.dumps({"header": {"stamp": {"sec": 2**31}}}).encode()
        self.assertIn(b"header/stamp/sec: out of range", PROGRAMS.run("ros_cdr", "encode", JOINTS, input=wrong).stderr)


class Types(unittest.TestCase):
    def test_have_their_dds_names_and_hashes(self):
        rows = [row.split() for row in PROGRAMS.run("ros_cdr", "types").stdout.splitlines()]
        self.assertEqual([row[0] for row in rows], sorted(TYPES))
        self.assertIn("sensor_msgs::msg::dds_::JointState_", [row[1] for row in rows])
        for name, _, type_hash in rows:
            self.assertEqual(type_hash, type_hashes.type_hash(TYPES, name))


# What is said before the reader knows the writer arrives, too.
SURELY = ("--durability", "transient_local")


class OverDds(unittest.TestCase):
    def hear(self, lines, *say_options, listen=()):
        """What ros_listen prints of what ros_say says, until as many samples came."""
        topics = sorted({(said["topic"], said["type"]) for said in lines})
        pairs = [word for pair in topics for word in pair]
        with PROGRAMS.start_listening("--all-bytes", "--seconds", 30, "--count", len(lines), "--depth", 200, *SURELY,
                                      *listen, *pairs) as listening:
            said = PROGRAMS.say(lines, *SURELY, "--settle", 0, *say_options)
            self.assertEqual(said.returncode, 0, said.stderr)
            return listening.finish()

    def test_every_field_of_every_type_arrives(self):
        values = {name: samples.sample(TYPES, name) for name in TYPES}
        heard = self.hear([line(name, fields) for name, fields in values.items()])
        by_type = {event["type"]: event for event in heard if event["event"] == "sample"}
        self.assertEqual(sorted(by_type), sorted(TYPES))
        for name, event in by_type.items():
            with self.subTest(name):
                self.assertEqual(event["fields"], samples.as_printed(TYPES, name, values[name]))
                self.assertLess(event["unread"], 4)  # DDS pads a sample to a multiple of four bytes
                self.assertEqual(event["size"] - event["unread"], len(samples.cdr(TYPES, name, values[name])))

    def test_raw_files_are_the_bytes_of_each_sample(self):
        values = [samples.sample(TYPES, JOINTS, elements) for elements in (0, 1, 5)]
        with tempfile.TemporaryDirectory() as folder:
            self.hear([line(JOINTS, fields) for fields in values], listen=("--raw", folder))
            for number, fields in enumerate(values, 1):
                expected = samples.cdr(TYPES, JOINTS, fields)
                kept = (pathlib.Path(folder) / f"{number}.cdr").read_bytes()
                self.assertEqual(kept[:len(expected)], expected)
                self.assertLess(len(kept), len(expected) + 4)

    def test_options_set_the_headers(self):
        scene = {"world": {"octomap": {"header": {"frame_id": "other"}}}}
        lines = [line(JOINTS, {}), line("moveit_msgs/PlanningScene", scene)]
        heard = self.hear(lines, "--frame", "base", "--stamp-now")
        fields = {event["type"]: event["fields"] for event in heard if event["event"] == "sample"}
        joints, scene = fields[JOINTS], fields["moveit_msgs/PlanningScene"]
        for header in (joints["header"], scene["world"]["octomap"]["header"]):
            self.assertEqual(header["frame_id"], "base")
            self.assertGreater(header["stamp"]["sec"], 1_600_000_000)

    def test_a_late_reader_gets_what_a_transient_local_writer_said(self):
        said = line("tf2_msgs/TFMessage", {"transforms": [{"child_frame_id": "early"}]}, durability="transient_local")
        with PROGRAMS.start_saying([said], "--readers", 0, "--linger", 8).until_event("matched"):
            with PROGRAMS.start_listening("--seconds", 8, "--count", 1, "--durability", "transient_local",
                                          said["topic"], said["type"]) as listening:
                heard = listening.finish("sample")
        self.assertEqual(heard[0]["fields"]["transforms"][0]["child_frame_id"], "early")

    def test_a_reader_that_asks_for_more_than_is_offered_matches_nothing(self):
        with PROGRAMS.start_listening("--seconds", 2, topic_of(JOINTS), JOINTS) as listening:
            said = PROGRAMS.say([line(JOINTS, {}, qos="best_effort")], "--wait", 1.5)
            self.assertEqual(events(said.stdout, "matched")[0]["readers"], 0)
            self.assertEqual(listening.finish("sample"), [])

    def test_images_count_in_their_first_pixel(self):
        for encoding, letter, depth in (("16UC1", "<H", 1500), ("32FC1", "<f", 1.5)):
            topic = "/depth_" + encoding.lower()
            options = ("--all-bytes", "--seconds", 20, "--count", 40, "--depth", 40, *SURELY)
            with self.subTest(encoding), PROGRAMS.start_listening(*options, topic, "sensor_msgs/Image") as listening:
                PROGRAMS.run("ros_say", *SURELY, "--depth", 40, "--images", "16x12", "--topic", topic, "--count", 40,
                             "--rate", 100, "--encoding", encoding, "--depth-m", 1.5)
                images = [event["fields"] for event in listening.finish("sample")]
                size = struct.calcsize(letter)
                pixels = [[value for value, in struct.iter_unpack(letter, bytes.fromhex(image["data"]["hex"]))]
                          for image in images]
                self.assertEqual([row[0] for row in pixels], list(range(40)))
                self.assertEqual({row[100] for row in pixels}, {depth})
                self.assertEqual([images[0][name] for name in ("width", "height", "step", "encoding")],
                                 [16, 12, 16 * size, encoding])


class Malformed(unittest.TestCase):
    """A listener counts what is no message, prints why, and goes on."""

    def test_messages_cut_at_each_byte_are_counted(self):
        name = "moveit_msgs/PlanningScene"
        whole = samples.cdr(TYPES, name, samples.sample(TYPES, name, 1))
        with tempfile.NamedTemporaryFile() as file, PROGRAMS.start_listening(
                "--seconds", 40, "--count", len(whole), "--depth", 5000, *SURELY, "/scene", name) as listening:
            file.write(whole)
            file.flush()
            cut = PROGRAMS.run("ros_say", "--raw", file.name, name, "/scene", "--truncated", "--depth", 5000, "--rate",
                               800, *SURELY, "--until-read")
            self.assertEqual(cut.returncode, 0, cut.stderr)
            PROGRAMS.run("ros_say", "--raw", file.name, name, "/scene", *SURELY, "--until-read")
            heard = listening.finish("sample")
        padded = [length + -length % 4 for length in range(1, len(whole) + 1)]  # DDS does so
        self.assertEqual([event["size"] for event in heard], padded)
        decoded = [event["size"] for event in heard if "malformed" not in event]
        self.assertEqual(set(decoded), {padded[-1]})

    def test_lengths_of_billions_are_counted(self):
        whole = samples.cdr(TYPES, JOINTS, samples.sample(TYPES, JOINTS, 2))
        lines = []
        for place in range(4, len(whole) - 3, 4):
            for length in (0xffffffff, 0x7fffffff, 0x04000000):
                wrong = whole[:place] + struct.pack("<I", length) + whole[place + 4:]
                lines.append({"topic": "/joints", "type": JOINTS, "cdr": wrong.hex()})
        with PROGRAMS.start_listening("--seconds", 40, "--count", len(lines), "--depth", 1000, *SURELY, "/joints",
                                      JOINTS) as listening:
            said = PROGRAMS.say(lines, "--depth", 1000, "--rate", 400, *SURELY, "--until-read")
            self.assertEqual(said.returncode, 0, said.stderr)
            heard = listening.finish()
        samples_heard = [event for event in heard if event["event"] == "sample"]
        malformed = [event for event in samples_heard if "malformed" in event]
        self.assertEqual(len(samples_heard), len(lines))
        self.assertGreaterEqual(len(malformed), 3 * 4)  # the lengths of four sequences at least
        self.assertEqual(heard[-1]["topics"]["/joints"]["malformed"], len(malformed))


class Discovery(unittest.TestCase):
    def test_tells_type_qos_and_hash_of_a_writer(self):
        with PROGRAMS.start_listening("--publishers", "--seconds", 6, "/tf_static", "tf2_msgs/TFMessage") as listening:
            PROGRAMS.say([{"topic": "/tf_static", "type": "tf2_msgs/TFMessage", "durability": "transient_local"}])
            found = [event for event in listening.stop("endpoint") if event["topic"] == "/tf_static"]
        self.assertEqual([event["kind"] for event in found], ["writer"] * len(found))
        self.assertEqual(found[0]["change"], "appeared")
        self.assertEqual(found[-1]["change"], "gone")
        for name, value in {"dds_topic": "rt/tf_static", "dds_type": "tf2_msgs::msg::dds_::TFMessage_",
                            "reliability": "reliable", "durability": "transient_local", "has_key": False,
                            "partitions": [], "type_hash": type_hashes.type_hash(TYPES, "tf2_msgs/TFMessage")}.items():
            self.assertEqual(found[0][name], value, name)


class CommandLines(unittest.TestCase):
    def test_are_refused_with_exit_code_2(self):
        for program, arguments in (("ros_listen", []), ("ros_listen", ["/a"]), ("ros_listen", ["/a", "no_msgs/Type"]),
                                   ("ros_listen", ["--seconds", "long", "/a", JOINTS]),
                                   ("ros_listen", ["--no", "/a", JOINTS]), ("ros_say", ["--qos", "rather"]),
                                   ("ros_say", ["--images", "3by4"]), ("ros_cdr", [])):
            with self.subTest(program=program, arguments=arguments):
                ended = PROGRAMS.run(program, *arguments, input='{"topic": "/a", "type": "std_msgs/String"}\n')
                self.assertEqual(ended.returncode, 2, ended.stderr)
                self.assertIn(program + ": ", ended.stderr)


if __name__ == "__main__":
    PROGRAMS = Programs(sys.argv.pop(1))
    unittest.main()
