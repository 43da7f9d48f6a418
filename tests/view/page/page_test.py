#!/usr/bin/env python3
"""The page of octoskin view in Chromium, compared with the daemon's own answers and with independent geometry.

usage: page_test.py PROGRAMS NODE MODULES [--screenshots FOLDER] [unittest's arguments]
  PROGRAMS  folder of octoskin     MODULES  folder with node_modules/playwright-core
"""
import argparse
import base64
import json
import math
import os
import pathlib
import subprocess
import sys
import unittest

import mesh_files
from browser import Browser
from page_world import ORIGIN_KEY, RESOLUTION_M, World, surface

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "ros"))
import namespaces  # noqa: E402
import poses  # noqa: E402

# The browser draws without a graphics card, which takes all processors; the bus must not wait for it.
YIELDING = ["nice", "-n", "15"]
COLOURS = {"used": "#009e73", "nothing": "#56b4e9", "rejected": "#f0c000", "faulty": "#d55e00", "silent": "#8a929a"}


def isolated():
    """A network namespace without a route, or None where the system forbids it."""
    try:
        machine = namespaces.Machine("view")
        machine.run("true")
        return machine
    except (RuntimeError, OSError) as error:
        print(f"not isolated: {error}", file=sys.stderr)
        return None


def expected_state(sensor):
    """docs/start/view.md: what the colour of a cone means."""
    if sensor["state"] not in (None, "ranging") or sensor["disputed"]:
        return "faulty"
    if sensor["camera"] and sensor["camera"]["contradicts"]:
        return "faulty"
    if sensor["state"] is None or sensor["age_s"] is None or sensor["age_s"] > 3:
        return "silent"
    return {None: "used", "no_return": "nothing"}.get(sensor["rejected"], "rejected")


def ray_through(camera, x_px, y_px):
    """Origin and direction of a pinhole camera that looks at its target, z up."""
    ahead = normalised([t - p for t, p in zip(camera["target"], camera["position"])])
    right = normalised(cross(ahead, [0, 0, 1]))
    up = cross(right, ahead)
    half = math.tan(math.radians(camera["fov_deg"]) / 2)
    u = (2 * x_px / camera["width"] - 1) * half * camera["width"] / camera["height"]
    v = (1 - 2 * y_px / camera["height"]) * half
    return camera["position"], normalised([a + u * r + v * w for a, r, w in zip(ahead, right, up)])


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def normalised(v):
    return [along / math.hypot(*v) for along in v]


def nearest_on_ray(origin, direction, keys):
    """The voxel that a ray meets first, each compared by itself. Returns (key, how far its second is behind)."""
    inverse = [1 / along if along else math.inf for along in direction]
    met = []
    for key in keys:
        low = [(along - ORIGIN_KEY) * RESOLUTION_M for along in key]
        spans = [sorted(((a - o) * i, (a + RESOLUTION_M - o) * i)) for a, o, i in zip(low, origin, inverse)]
        near, far = max(span[0] for span in spans), min(span[1] for span in spans)
        if near < far and far > 0:
            met.append((near, far - near, key))
    return min(met)[2] if met else None


# Text whose contrast to its background is below 4.5 (WCAG 2.2, AA), as "text: contrast". Backgrounds that let something
# through are those above the map: there the page's own colour counts.
LOW_CONTRAST = """(() => {
  const rgb = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const light = (colour) => rgb(colour).slice(0, 3).map((part) => part / 255)
    .map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4))
    .reduce((sum, part, index) => sum + part * [0.2126, 0.7152, 0.0722][index], 0);
  const ground = (element) => {
    for (let at = element; at; at = at.parentElement) {
      const colour = getComputedStyle(at).backgroundColor;
      if (colour !== 'transparent' && (rgb(colour)[3] ?? 1) > 0.5) return colour;
    }
  };
  const low = [];
  for (const element of document.querySelectorAll('body *')) {
    const text = [...element.childNodes].filter((node) => node.nodeType === 3).map((node) => node.data.trim()).join('');
    if (!text || !element.checkVisibility() || element.closest(':disabled, script')) continue;
    const [a, b] = [light(getComputedStyle(element).color), light(ground(element))].sort((one, two) => two - one);
    const contrast = (a + 0.05) / (b + 0.05);
    if (contrast < 4.5) low.push(`${text}: ${contrast.toFixed(2)}`);
  }
  return low;
})()"""
# Controls that a screen reader cannot name.
NAMELESS = """[...document.querySelectorAll('button, input, select, canvas')]
  .filter((control) => control.checkVisibility())
  .filter(({textContent, ariaLabel, labels}) => !textContent.trim() && !ariaLabel && !(labels?.length > 0))
  .map((control) => control.outerHTML)"""


class Page(unittest.TestCase):
    """One daemon, one view and one Chromium for all cases. They run in the order of their names: the bus plays once."""

    @classmethod
    def setUpClass(cls):
        machine = isolated()
        prefix = machine.prefix if machine else ()
        if machine:
            cls.addClassCleanup(machine.end)
        cls.world = cls.enterClassContext(World(OPTIONS.programs, prefix))
        cls.browser = cls.enterClassContext(Browser(OPTIONS.node, OPTIONS.modules, [*prefix, *YIELDING]))
        cls.browser.open(cls.world.url)
        cls.browser.until("document.readyState === 'complete' && window.octoskin !== undefined")
        cls.taken = {}

    def drawn(self):
        return {tuple(map(int, key.split(","))) for key in self.browser.octoskin("drawnKeys()")}

    def stats(self):
        return self.browser.octoskin("stats()")

    def assert_draws(self, occupied):
        """Waits for what is under way, then compares."""
        try:
            self.browser.until(f"window.octoskin.stats().then((stats) => stats.occupied === {len(occupied)})")
        except AssertionError:
            self.fail(f"{len(occupied)} voxels are occupied; the page has {self.stats()}")
        drawn, expected = self.drawn(), surface(occupied)
        self.assertEqual(drawn, expected, f"{len(drawn - expected)} too many, {len(expected - drawn)} missing")

    def screenshot(self, name):
        if OPTIONS.screenshots:
            OPTIONS.screenshots.mkdir(parents=True, exist_ok=True)
            self.browser.ask("screenshot", file=str(OPTIONS.screenshots / f"{name}.png"))

    def test_1_draws_the_map_that_the_daemon_began_with(self):
        self.world.wait_for_save()
        occupied = self.world.occupied()
        self.assertGreater(len(occupied), 25000)
        self.assert_draws(occupied)

    def test_2_colours_each_cone_as_its_sensor_is_while_it_moves(self):
        self.world.play()
        self.browser.until("Object.values(window.octoskin.coneColours()).includes('#009e73')")
        states = set()
        for _ in range(20):
            status, colours = self.browser.evaluate("[window.octoskin.status(), window.octoskin.coneColours()]")
            expected = {f"{node['id']} {sensor['index']}": expected_state(sensor)
                        for node in status["nodes"] for sensor in node["sensors"]}
            self.assertEqual(colours, {name: COLOURS[state] for name, state in expected.items()})
            states |= set(expected.values())
        self.assertLessEqual({"used", "nothing"}, states)

    def test_3_draws_what_deltas_made_of_it(self):
        self.world.wait_for_phase("pausing")
        self.world.wait_for_save()
        occupied = self.world.occupied()
        self.assert_draws(occupied)
        # While SYNC arrives late, as on a loaded machine, the map has no time.
        time_s = self.browser.until("window.octoskin.stats().then((stats) => stats.time_s)")
        self.assert_draws(occupied)
        self.assertEqual(self.world.phase, "pausing", "the machine is too slow: ranges came while maps were compared")
        self.taken["paused"] = (time_s, occupied)
        self.world.play_again()

    def test_4_draws_the_links_where_the_kinematics_has_them(self):
        self.world.wait_for_phase("after")
        joints, drawn = self.browser.evaluate("[window.octoskin.joints(), window.octoskin.linkPoses()]")
        described = self.world.ask("describe")
        expected = poses.links(described, joints)
        self.assertEqual(set(drawn), set(expected))
        T_root_map = described["T_root_map"]
        for link, T_root_link in expected.items():
            p_root = poses.moved(T_root_map, drawn[link]["p"])
            self.assertLess(math.dist(p_root, T_root_link["p"]), 0.001, link)
            turn = poses.product(T_root_map["q"], drawn[link]["q"])
            self.assertGreater(abs(sum(a * b for a, b in zip(turn, T_root_link["q"]))), 1 - 1e-6, link)
        self.assertGreater(max(abs(position) for position in joints.values()), 0.5)

    def test_4_draws_the_meshes_that_the_robot_names(self):
        visuals = self.browser.until(
            "(({drawn, missing}) => Object.keys({...drawn, ...missing}).length === 5 && {drawn, missing})"
            "(window.octoskin.visuals())")
        self.assertEqual(sorted(visuals["drawn"]), [f"panda_link{link}" for link in (1, 2, 3)])
        for link, drawn in visuals["drawn"].items():
            self.assertEqual(drawn["triangles"], 12, link)
            for end, expected in (("min", mesh_files.LOW), ("max", mesh_files.HIGH)):
                self.assertLess(math.dist(drawn[end], expected), 1e-6, f"{link}: {end}")
        self.assertEqual(sorted(visuals["missing"]), ["panda_link4", "panda_link6"])
        self.assertIn("none.stl", visuals["missing"]["panda_link4"])
        said = self.browser.evaluate("document.getElementById('meshes').textContent")
        self.assertEqual(said.count("Drawn as capsules: panda_link"), 2, said)
        self.taken["fetched"] = self.browser.evaluate("window.octoskin.visuals().fetched")
        self.assertEqual(self.taken["fetched"], 4)  # each file once, the empty one, too

    def test_4_gives_meshes_to_foxglove_s_client(self):
        client = pathlib.Path(__file__).resolve().parents[1] / "foxglove_client.js"
        names = [f"package://meshes_of_test/{name}" for name in ("box.stl", "none.stl", "../recording/rig.yaml")]
        said = subprocess.run(
            [*self.world.prefix, OPTIONS.node, client, str(self.world.port), "foxglove.sdk.v1", "3", "--",
             *(word for name in names for word in ("asset", name))],
            env={**os.environ, "OCTOSKIN_NPM": str(pathlib.Path(OPTIONS.modules).parent)}, check=True,
            capture_output=True, text=True).stdout
        answers = {answer["call"]: answer for answer in map(json.loads, said.splitlines()) if answer["event"] == "asset"}
        self.assertEqual([answers[call]["status"] for call in range(3)], [0, 1, 1])
        self.assertEqual(base64.b64decode(answers[0]["data"]), mesh_files.stl())

    def test_5_picks_the_voxel_under_the_pixel(self):
        self.world.wait_for_save()
        occupied = self.world.occupied()
        self.assert_draws(occupied)
        camera = self.browser.octoskin("camera()")
        picked = 0
        shares = ((0.5, 0.5), (0.55, 0.4), (0.62, 0.47), (0.3, 0.7), (0.7, 0.8), (0.8, 0.7), (0.45, 0.62))
        for share_x, share_y in shares:
            x_px, y_px = share_x * camera["width"], share_y * camera["height"]
            expected = nearest_on_ray(*ray_through(camera, x_px, y_px), occupied)
            voxel = self.browser.octoskin(f"pick({x_px}, {y_px})")
            self.assertEqual(tuple(voxel["key"]) if voxel else None, expected)
            picked += voxel is not None
        self.assertGreaterEqual(picked, 4)
        row = self.browser.evaluate("document.querySelector('#voxel td').textContent")
        self.assertIn("occupied", row)

    def test_6_shows_the_map_of_a_time_of_the_last_minute(self):
        occupied = self.world.occupied()
        time_s, before = self.taken["paused"]
        self.assertNotEqual(before, occupied)
        self.addCleanup(self.browser.octoskin, "showAt(null)")
        self.browser.octoskin(f"showAt({time_s})")
        self.assert_draws(before)
        self.screenshot("paused")
        shown_s = self.browser.octoskin("stats()")["shown_s"]
        for key, ahead_s in (("ArrowLeft", 0), ("ArrowRight", 1)):  # a second back, and ahead
            self.browser.ask("press", key=key)
            wanted = shown_s - 1 + ahead_s
            self.browser.until(f"window.octoskin.stats().then((stats) => Math.abs(stats.shown_s - {wanted}) < 1e-6)")
        self.browser.ask("press", key=" ")
        self.browser.until("window.octoskin.stats().then((stats) => stats.shown_s === null)")
        self.assert_draws(occupied)

    def test_7_says_what_the_daemon_answers_about_a_posture(self):
        joints = {f"panda_joint{index + 1}": position
                  for index, position in enumerate((0, -0.785, 0, -2.356, 0, 1.571, 0.785))}
        path = str(list(joints.values()))
        expected = self.world.ask(f'query {{"path": [{path}]}}')
        self.browser.octoskin(f"setPosture({joints})")
        answer = self.browser.until("(({answer}) => answer?.ok && answer)(window.octoskin.posture())")
        for name in ("state", "postures", "links"):
            self.assertEqual(answer[name], expected[name])
        for name in ("link", "voxel_m", "occupied_m"):
            self.assertEqual(answer["legs"][0][name], expected["legs"][0][name])

    def test_8_draws_the_map_again_after_the_server_was_gone(self):
        occupied = self.world.occupied()
        before = self.stats()["connections"]
        self.world.stop_view()
        self.browser.until("document.getElementById('link').classList.contains('lost')")
        self.world.start_view(self.world.port)
        self.browser.until(f"window.octoskin.stats().then((stats) => stats.connections > {before})")
        self.assert_draws(occupied)
        self.browser.until(f"window.octoskin.visuals().fetched > {self.taken['fetched']}")
        self.browser.until("Object.keys(window.octoskin.visuals().drawn).length === 3")

    def test_9_asks_no_other_host_and_has_no_error(self):
        seen = self.browser.ask("seen")
        own = {f"127.0.0.1:{self.world.port}", f"localhost:{self.world.port}"}
        self.assertLessEqual(set(seen["hosts"]), own)
        self.assertEqual([error for error in seen["errors"] if "WebSocket" not in error], [])  # test_8
        stats = self.stats()
        self.assertEqual((stats["malformed"], stats["mapsMalformed"], stats["mapGaps"]), (0, 0, 0))
        print({name: stats[name] for name in ("mainMs", "workerMs", "frameBytes", "historyBytes", "faces")})

    def test_a_fits_wide_and_narrow_windows(self):
        """No text runs out of the window, all can be read, and each control has a name and a size."""
        windows = [(*size, scheme) for size in ((1280, 800), (390, 844)) for scheme in ("dark", "light")]
        for width, height, scheme in windows:
            self.browser.open(self.world.url, width, height, scheme)
            self.browser.until("window.octoskin?.stats().then((stats) => stats.occupied > 0)")
            self.assertEqual(self.browser.evaluate("document.documentElement.dataset.theme"), scheme)
            self.assertLessEqual(self.browser.evaluate("document.documentElement.scrollWidth"), width)
            low = self.browser.evaluate("[...document.querySelectorAll('button')].filter((button) => "
                                        "button.offsetParent && button.getBoundingClientRect().height < 24).length")
            self.assertEqual(low, 0)
            self.browser.until("window.octoskin.status() !== null")
            self.browser.octoskin("setPosture({})")  # with its sliders
            self.browser.until("window.octoskin.posture().answer !== null")
            self.assertEqual(self.browser.evaluate(LOW_CONTRAST), [])
            self.assertEqual(self.browser.evaluate(NAMELESS), [])
            self.screenshot(f"page_{width}_{scheme}")

    def test_b_asks_for_the_whole_map_again_after_a_frame_that_is_cut(self):
        self.browser.open(self.world.url, cuts=True)
        self.browser.until("window.octoskin?.stats().then((stats) => stats.mapGaps === 1 && stats.connections === 2)")
        self.assertEqual(self.stats()["mapsMalformed"], 1)
        self.assert_draws(self.world.occupied())

    def test_c_shows_the_maps_of_a_report(self):
        out, short = self.world.path / "experiment", pathlib.Path(__file__).resolve().parents[2] / "data/short"
        self.world.run(pathlib.Path(OPTIONS.programs) / "octoskin-lab", "experiment", "--out", out, "--rig",
                       short / "rig.yaml", "--scenario", short / "scenario.yaml")
        self.browser.open(f"file://{out}/report.html")
        self.browser.until("window.octoskinReport !== undefined")
        for button, name in enumerate(("fused", "proximity", "depth")):
            self.browser.evaluate(f"window.octoskinReport.show(window.octoskinReport.buttons[{button}])")
            drawn = self.browser.evaluate("window.octoskinReport.layer.drawnKeys()")
            expected = surface(self.world.occupied(f"experiment/{name}.bt", 0.04))
            self.assertGreater(len(expected), 10, name)
            self.assertEqual({tuple(map(int, key.split(","))) for key in drawn}, expected, name)
        self.screenshot("report")
        self.assertEqual(self.browser.ask("seen")["errors"], [])


if __name__ == "__main__":
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("programs")
    parser.add_argument("node")
    parser.add_argument("modules")
    parser.add_argument("--screenshots", type=pathlib.Path)
    OPTIONS, others = parser.parse_known_args()
    unittest.main(argv=[sys.argv[0], *others])
