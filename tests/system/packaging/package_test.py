#!/usr/bin/env python3
"""package_test.py BUILD CPACK MAINTAINER: the Debian package has what it must and nothing else, and what is in it runs."""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
HELPERS = "usr/libexec/octoskin"
PROGRAMS = {"usr/bin/octoskin", "usr/bin/octoskin-node", f"{HELPERS}/octoskin-camera",
            f"{HELPERS}/octoskin-film", f"{HELPERS}/octoskin-mesh-read", f"{HELPERS}/octoskin-oni-read",
            f"{HELPERS}/octoskin-oni-write"}
LAB_PROGRAMS = {"usr/bin/octoskin-lab", f"{HELPERS}/octoskin-world-read"}
LINKS = {"usr/share/doc/octoskin/hw", f"{HELPERS}/openni2/libOpenNI2.so.0", f"{HELPERS}/openni2/OpenNI2/Drivers/libOniFile.so.0"}
SETTINGS = {"etc/default/octoskin", "etc/default/octoskin-node"}
OTHERS = {f"{HELPERS}/openni2/OpenNI2/Drivers/libOctoskinVirtual.so.0",
          "usr/lib/systemd/system/octoskin.service", "usr/lib/systemd/system/octoskin-node.service",
          "usr/lib/sysusers.d/octoskin.conf", "usr/lib/udev/rules.d/60-octoskin-node.rules",
          "usr/share/man/man1/octoskin.1.gz", "usr/share/man/man1/octoskin-node.1.gz",
          "usr/share/doc/octoskin/README.md", "usr/share/doc/octoskin/SECURITY.md", "usr/share/doc/octoskin/packaging/README.md",
          "usr/share/doc/octoskin/copyright",
          "usr/share/doc/octoskin/changelog.gz", "usr/share/octoskin/hw/octoskin.dbc"}
LAB_OTHERS = {f"{HELPERS}/octoskin-sdf.so", "usr/share/man/man1/octoskin-lab.1.gz", "usr/share/doc/octoskin-lab/copyright",
              "usr/share/doc/octoskin-lab/changelog.gz", "usr/share/octoskin/view/report_view.js"}
BRIDGE_PROGRAMS = {f"{HELPERS}/octoskin-bridge"}
BRIDGE_SETTINGS = {"etc/default/octoskin-bridge"}
BRIDGE_EXAMPLES = {f"usr/share/doc/octoskin-bridge/examples/{name}"
                   for name in ("bridge.launch.py", "octoskin-bridge.override.conf", "octoskin-bridge.sysctl")}
BRIDGE_OTHERS = {"usr/lib/systemd/system/octoskin-bridge.service", "usr/share/man/man1/octoskin-bridge.1.gz",
                 "usr/share/doc/octoskin-bridge/copyright", "usr/share/doc/octoskin-bridge/changelog.gz"}
# The page of octoskin view.
BRIDGE_PAGE = {f"usr/share/octoskin/view/{name}" for name in ("index.html", "licences.txt", "page.css", "page.js", "worker.js")}
LAB_FOLDERS = {"hw/worlds": "usr/share/octoskin/hw/worlds"}
FOLDERS = {"docs": "usr/share/doc/octoskin/docs", "host/config": "usr/share/octoskin/config"} | {
    f"hw/{name}": f"usr/share/octoskin/hw/{name}" for name in ("boards", "rigs", "robots")}


def run(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise AssertionError(f"{command}: exit code {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def data_files(folders):
    for source, target in folders.items():
        for file in (SOURCE / source).rglob("*"):
            if file.is_file():
                yield f"{target}/{file.relative_to(SOURCE / source)}"


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.scratch.cleanup)
        folder = pathlib.Path(cls.scratch.name)
        run(CPACK, "--config", f"{BUILD}/CPackConfig.cmake", "-B", folder / "made")
        (cls.package,) = (folder / "made").glob("octoskin_*.deb")
        (cls.lab,) = (folder / "made").glob("octoskin-lab_*.deb")
        (cls.bridge,) = (folder / "made").glob("octoskin-bridge_*.deb")
        cls.root = folder / "root"
        for package in (cls.package, cls.lab, cls.bridge):
            run("dpkg-deb", "-x", package, cls.root)
        # Its links lead to the library that it depends on.
        (triplet,) = {path.name for path in pathlib.Path("/usr/lib").glob("*-linux-gnu*")
                      if (path / "libOpenNI2.so.0").exists()}
        (cls.root / "usr/lib" / triplet).symlink_to(f"/usr/lib/{triplet}")
        cls.program = cls.root / "usr/bin/octoskin"
        cls.lab_program = cls.root / "usr/bin/octoskin-lab"

    def listed(self, package):
        return [line.split(None, 5) for line in run("dpkg-deb", "-c", package).splitlines()]

    def names(self, package, kind):
        return {entry[5].split(" -> ")[0].removeprefix("./") for entry in self.listed(package) if entry[0][0] == kind}

    def field(self, package, name):
        return run("dpkg-deb", "-f", package, name).strip()

    def depends(self, package):
        return {re.split(r"[ |]", word.strip())[0] for word in self.field(package, "Depends").split(",")}

    def test_has_these_files_and_no_other(self):
        data = set(data_files(FOLDERS))
        self.assertGreater(len(data), 10)
        self.assertEqual(self.names(self.package, "-"), PROGRAMS | SETTINGS | OTHERS | data)
        self.assertEqual(self.names(self.package, "l"), LINKS)
        worlds = set(data_files(LAB_FOLDERS))
        self.assertGreater(len(worlds), 5)
        self.assertEqual(self.names(self.lab, "-"), LAB_PROGRAMS | LAB_OTHERS | worlds)
        self.assertEqual(self.names(self.lab, "l"), set())
        self.assertEqual(self.names(self.bridge, "-"),
                         BRIDGE_PROGRAMS | BRIDGE_SETTINGS | BRIDGE_OTHERS | BRIDGE_EXAMPLES | BRIDGE_PAGE)
        self.assertEqual(self.names(self.bridge, "l"), set())

    def test_belongs_to_root_who_alone_may_write(self):
        for mode, owner, *_, name in self.listed(self.package) + self.listed(self.lab) + self.listed(self.bridge):
            self.assertEqual(owner, "root/root", name)
            if mode[0] == "l":
                continue
            is_run = mode[0] == "d" or name.removeprefix("./") in PROGRAMS | LAB_PROGRAMS | BRIDGE_PROGRAMS
            self.assertEqual(mode[1:], "rwxr-xr-x" if is_run else "rw-r--r--", name)

    def test_is_named_by_version_and_architecture(self):
        architecture = run("dpkg", "--print-architecture").strip()
        version = run(self.program, "--version").split()[1]
        self.assertEqual(self.package.name, f"octoskin_{version}_{architecture}.deb")
        self.assertEqual(self.lab.name, f"octoskin-lab_{version}_{architecture}.deb")
        self.assertEqual(self.bridge.name, f"octoskin-bridge_{version}_{architecture}.deb")
        for package in (self.lab, self.bridge):
            self.assertIn(f"octoskin (= {version})", self.field(package, "Depends"))
        changes = run("zcat", self.root / "usr/share/doc/octoskin/changelog.gz")
        self.assertTrue(changes.startswith(f"octoskin ({version}) "), changes)

    def test_names_the_maintainer_that_the_build_was_given(self):
        self.assertEqual(self.field(self.package, "Maintainer"), MAINTAINER)
        self.assertRegex(MAINTAINER, "^[^<>]+ <[^<>@]+@[^<>@]+>$")

    def test_depends_on_what_its_programs_load(self):
        for file in PROGRAMS | LAB_PROGRAMS | BRIDGE_PROGRAMS:
            for line in run("ldd", self.root / file).splitlines():
                self.assertNotIn("not found", line, file)
        # By hand, the other way round: the library each program cannot do without.
        depends, lab = self.depends(self.package), self.depends(self.lab)
        for package in ("libopenni2-0", "libsystemd0", "libgpiod2", "procps"):
            self.assertIn(package, depends)
        for package in ("libsdformat12-12", "libembree3-3"):
            self.assertIn(package, lab)
            self.assertNotIn(package, depends)
        self.assertIn("libddsc0debian", self.depends(self.bridge))
        self.assertNotIn("libddsc0debian", depends)
        self.assertFalse({name for name in depends | lab if "unicorn" in name or name.endswith("-dev")})

    def test_keeps_settings_that_somebody_changed(self):
        for package, settings in ((self.package, SETTINGS), (self.bridge, BRIDGE_SETTINGS)):
            conffiles = run("dpkg-deb", "--info", package, "conffiles").split()
            self.assertEqual(set(conffiles), {f"/{name}" for name in settings})

    def test_has_the_licences_of_the_packages_in_its_page(self):
        dependencies = json.loads((SOURCE / "host/bridge/page/package.json").read_text())["dependencies"]
        licences = (self.root / "usr/share/octoskin/view/licences.txt").read_text()
        copyright = (self.root / "usr/share/doc/octoskin-bridge/copyright").read_text()
        for name, version in dependencies.items():
            self.assertIn(f"{name} {version} (", licences)
            self.assertRegex(copyright, rf"(?m)^Files: {name}(\.js)?$")

    def test_has_maintainer_scripts_that_parse(self):
        for package in (self.package, self.bridge):
            for script in ("postinst", "prerm", "postrm"):
                run("sh", "-n", input=run("dpkg-deb", "--info", package, script))

    def test_takes_away_what_systemctl_enable_made_when_it_is_purged(self):
        """Of a unit that somebody put there instead of ours, the link stays."""
        postrm = run("dpkg-deb", "--info", self.package, "postrm")
        for verb, left in (("remove", 2), ("purge", 1)):
            with tempfile.TemporaryDirectory() as scratch:
                units = pathlib.Path(scratch, "etc/systemd/system")
                wants = units / "multi-user.target.wants"
                wants.mkdir(parents=True)
                (wants / "octoskin.service").symlink_to("/no/such/octoskin.service")
                (units / "octoskin-node.service").write_text("[Unit]\n")
                (wants / "octoskin-node.service").symlink_to("../octoskin-node.service")
                subprocess.run(["sh", "-s", verb], input=postrm.replace("/run/systemd/system", "/no/such/folder"), text=True, check=True,
                               env={"PATH": scratch + ":/usr/bin:/bin", "DPKG_ROOT": scratch}, stderr=subprocess.DEVNULL)
                self.assertEqual(len(list(wants.iterdir())), left, verb)

    def test_names_every_command_in_the_manual(self):
        for program, least in ((self.program, 10), (self.lab_program, 3),
                               (self.root / HELPERS / "octoskin-bridge", 4)):
            said = run(program, "--help").split("Subcommands:")[1].split("Exit codes")[0]
            commands = re.findall(r"^  ([a-z-]+) ", said, re.MULTILINE)
            self.assertGreaterEqual(len(commands), least)
            manual = run("zcat", self.root / f"usr/share/man/man1/{program.name}.1.gz")
            bold = set(re.findall(r"[a-z-]+", " ".join(re.findall(r"^\.BR? (.*)$", manual, re.MULTILINE))))
            self.assertEqual([name for name in commands if name not in bold], [])

    def test_simulates_records_and_maps_with_its_own_helpers_and_data(self):
        shared = self.root / "usr/share/octoskin"
        scenario = pathlib.Path(self.scratch.name) / "short.yaml"
        scenario.write_text(f"extends: {shared}/hw/worlds/experiment.scenario.yaml\n"
                            "motion: {rest_s: 3, circle: {radius_m: 0.02, ticks_per_revolution: 15}}\n")
        recording = pathlib.Path(self.scratch.name) / "recording"
        self.assertIn(f"{shared}/hw/rigs/experiment.yaml", run(self.lab_program, "simulate", "--help"))
        run(self.lab_program, "simulate", recording, "--scenario", scenario)
        run(self.program, "replay", recording)
        self.assertGreater((recording / "maps/depth.ot").stat().st_size, 10_000)

    def test_runs_as_its_units_say(self):
        for unit in (self.root / "usr/lib/systemd/system").glob("*.service"):
            (program,) = re.findall(r"^ExecStart=(\S+)", unit.read_text(), re.MULTILINE)
            self.assertTrue(os.access(self.root / program.removeprefix("/"), os.X_OK), program)
            (settings,) = re.findall(r"^EnvironmentFile=/(\S+)", unit.read_text(), re.MULTILINE)
            given = set(re.findall(r"^([A-Z_]+)=", (self.root / settings).read_text(), re.MULTILINE))
            self.assertEqual(set(re.findall(r"\$\{?(OCTOSKIN\w+)", unit.read_text())), given)


if __name__ == "__main__":
    BUILD, CPACK, MAINTAINER = sys.argv[1:4]
    unittest.main(argv=sys.argv[:1])
