#!/usr/bin/env python3
"""toolchains/write_results: the committed page is current; what replaces figures; what is refused."""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[3]
RESULTS = SOURCE / "docs/results"
MEASURED = ("--date", "2027-01-02", "--machine", "a test's machine")
COMMIT = ("--commit", "0123456789ab")
METRICS = ("occupied", "free", "missed", "incorrect", "lost", "precision", "f1", "occluded_recall", "object_recall")


def metrics_json(program="octoskin 0.1.0 (commit abcdef012345)", seeds=(0, 1, 2, 3, 4), rig="experiment.yaml",
                 scenario="experiment.scenario.yaml"):
    """As octoskin-lab writes it, of `fast` alone: counts 1000.4 to 1004.4, shares 0.1234 to 0.4234."""
    of_map = {key: {"mean": 1000.4 + i if i < 5 else 0.1234 + 0.1 * (i - 5), "sd": 1.0, "per_seed": []}
              for i, key in enumerate(METRICS)}
    provenance = {"program": program, "world": "experiment.sdf, CRC-32 00000001",
                  "scenario": f"{scenario}, CRC-32 00000002", "rig": f"{rig}, CRC-32 00000003"}
    return {"fast": {name: of_map for name in ("depth", "proximity", "fused")},
            "run": {"seeds": list(seeds), "paired": {}, "calibration": {}, "times": [], "provenance": provenance}}


def bench_json(rows=("fast", "octomap")):
    """As octoskin-bench writes it: OctoMap takes 100 times as long."""
    of_row = {"fast": (5.4321, 100.0, 3 << 20), "octomap": (543.21, 1.0, 6 << 20)}
    return {"0.04": {row: {"ms_median": of_row[row][0], "ms_p95": 9.0, "ratio_octomap": of_row[row][1],
                           "heap_bytes": of_row[row][2], "leaves": 1, "voxels": 1, "runs": 25} for row in rows}}


class WriteResults(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        for name in ("figures.json", "README.md"):
            shutil.copy(RESULTS / name, self.folder)

    def run_with(self, *arguments, folder=None):
        done = subprocess.run([sys.executable, SOURCE / "toolchains/write_results", "--folder", folder or self.folder,
                               *arguments], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def file(self, content, name="new.json"):
        path = self.folder / name
        path.write_text(content if isinstance(content, str) else json.dumps(content))
        return path

    def figures(self):
        return json.loads((self.folder / "figures.json").read_text())

    def figure(self, name):
        return next(figure for figure in self.figures() if figure["id"] == name)

    def page(self):
        return (self.folder / "README.md").read_text()

    def refuses(self, why, *arguments):
        """With exit code 2, and both files stay as they are."""
        before = [(self.folder / name).read_bytes() for name in ("figures.json", "README.md")]
        code, out, error = self.run_with(*arguments)
        self.assertEqual((code, out), (2, ""), error)
        self.assertIn(why, error)
        self.assertEqual(before, [(self.folder / name).read_bytes() for name in ("figures.json", "README.md")])
        self.assertEqual(sorted(path.name for path in self.folder.iterdir() if path.name.startswith(".")), [])

    def test_the_committed_page_is_current(self):
        self.assertEqual(self.run_with("--check", folder=RESULTS), (0, "", ""))

    def test_check_fails_if_the_page_or_a_figure_was_changed_and_writes_nothing(self):
        page = self.page()
        (self.folder / "README.md").write_text(page.replace("2,293", "2,294"))
        code, _, error = self.run_with("--check")
        self.assertEqual(code, 1)
        self.assertIn("is stale; run toolchains/write_results", error)
        self.assertIn("2,294", self.page())
        self.assertEqual(self.run_with(), (0, "", ""))
        self.assertEqual(self.page(), page)
        figures = self.figures()
        figures[0]["value"]["occupied"] += 1
        self.file(figures, "figures.json")
        self.assertEqual(self.run_with("--check")[0], 1)

    def test_check_fails_without_a_page(self):
        (self.folder / "README.md").unlink()
        self.assertEqual(self.run_with("--check")[0], 1)

    def test_metrics_replace_what_they_have(self):
        before = {figure["id"]: figure for figure in self.figures()}
        code, out, error = self.run_with(self.file(metrics_json()), *MEASURED)
        self.assertEqual((code, error), (0, ""))
        replaced = ["metrics/experiment/fast/depth", "metrics/experiment/fast/fused"]
        self.assertEqual(out.split("\n")[:-1], [f"replaced {name}" for name in replaced])
        after = {figure["id"]: figure for figure in self.figures()}
        self.assertEqual([name for name in before if before[name] != after[name]], replaced)
        self.assertEqual(list(before), list(after))
        fused = after[replaced[1]]
        self.assertEqual(list(fused["value"].values()), [1000, 1001, 1002, 1003, 1004, .123, .223, .323, .423])
        self.assertEqual((fused["date"], fused["commit"], fused["machine"]),
                         ("2027-01-02", "abcdef012345", "a test's machine"))
        self.assertIn("| fused | 1,000 | 1,001 | 1,002 | 1,003 | 1,004 |", self.page())
        self.assertIn("2027-01-02, commit `abcdef012345`; machine: a test's machine", self.page().replace("\n  ", " "))
        self.assertEqual(self.run_with("--check")[0], 0)

    def test_metrics_of_another_rig_replace_that_rigs_figures(self):
        self.assertEqual(self.run_with(self.file(metrics_json(rig="experiment_zones.yaml")), *MEASURED)[1],
                         "replaced metrics/experiment_zones/fast/fused\n")

    def test_the_page_marks_the_default_and_says_that_no_run_has_it_only_while_none_has(self):
        figures = self.figures()
        self.assertNotIn("(default)", self.page())
        self.assertIn("older than `denoised`, the default", self.page())
        fast = next(figure for figure in figures if figure["id"] == "metrics/experiment/fast/depth")
        figures.append({**fast, "id": "metrics/experiment/denoised/depth"})
        (self.folder / "figures.json").write_text(json.dumps(figures))
        self.assertEqual(self.run_with()[0], 0)
        self.assertIn("| `denoised` (default) | depth | 1,970 |", self.page())
        self.assertNotIn("older than", self.page())

    def test_a_bench_replaces_what_it_has(self):
        code, out, error = self.run_with(self.file(bench_json()), *MEASURED, *COMMIT)
        self.assertEqual((code, out, error), (0, "replaced bench/0.04/fast\n", ""))
        self.assertEqual(self.figure("bench/0.04/fast")["value"],
                         {"ms": 5.43, "peer_ms": 543, "ratio": 100, "heap_mib": 3.0, "runs": 25,
                          "peer_heap_mib": 6.0, "peer_runs": 25})
        self.assertIn("| 4 cm | 5.43 | `insertPointCloud` of the frame | 543 | 100 |", self.page())
        self.assertIn("| `fast`, 4 cm | 3.0 | 25 | 6.0 | 25 |", self.page())

    def test_a_row_of_frames_from_one_place_is_compared_with_its_own_peer(self):
        figures = self.figures()
        frame = next(figure for figure in figures if figure["id"] == "bench/0.04/fast")
        figures.append({**frame, "id": "bench/0.04/whole_denoised_stands", "value": {"ms": 1, "peer_ms": 1, "ratio": 1}})
        (self.folder / "figures.json").write_text(json.dumps(figures))
        rows = bench_json()["0.04"]
        stands = {"whole_denoised_stands": {**rows["fast"], "parts_ms": {"denoise": 1.0}}, "octomap_stands": rows["octomap"]}
        code, out, error = self.run_with(self.file({"0.04": stands}), *MEASURED, *COMMIT)
        self.assertEqual((code, out, error), (0, "replaced bench/0.04/whole_denoised_stands\n", ""))
        self.assertEqual(self.figure("bench/0.04/whole_denoised_stands")["value"],
                         {"ms": 5.43, "peer_ms": 543, "ratio": 100})

    def test_refuses_a_bench_of_other_frames(self):
        self.refuses("of a data set", self.file({**bench_json(), "frames": {"folder": "/data"}}), *MEASURED, *COMMIT)

    def test_refuses_metrics_that_are_not_comparable(self):
        self.refuses("run.seeds is [0]", self.file(metrics_json(seeds=[0])), *MEASURED)
        self.refuses("run.provenance.scenario is cell.scenario.yaml",
                     self.file(metrics_json(scenario="cell.scenario.yaml")), *MEASURED)
        self.refuses("has none of the figures", self.file(metrics_json(rig="cell.yaml")), *MEASURED)

    def test_refuses_a_commit_that_does_not_name_the_program(self):
        changed = metrics_json("octoskin 0.1.0 (commit abcdef012345, with changes)")
        self.refuses("commit the changes", self.file(changed), *MEASURED)
        self.refuses("give --commit", self.file(metrics_json("octoskin 0.1.0 (commit unknown)")), *MEASURED)
        self.refuses("was measured with the commit abcdef012345", self.file(metrics_json()), *MEASURED, *COMMIT)
        self.refuses("give --commit", self.file(bench_json()), *MEASURED)
        self.refuses("is no commit", self.file(bench_json()), *MEASURED, "--commit", "HEAD")

    def test_refuses_files_that_lack_something(self):
        self.refuses("without 'octomap'", self.file(bench_json(rows=["fast"])), *MEASURED, *COMMIT)
        metrics = metrics_json()
        metrics["fast"]["depth"]["f1"]["mean"] = None
        self.refuses("'fast.depth.f1.mean' is no number: null", self.file(metrics), *MEASURED)
        self.refuses("neither metrics.json", self.file({"a": 1}), *MEASURED)
        self.refuses("no JSON", self.file("{"), *MEASURED)
        self.refuses("No such file", self.folder / "gone.json", *MEASURED)

    def test_changes_nothing_if_the_second_file_is_refused(self):
        self.refuses("no JSON", self.file(metrics_json(), "good.json"), self.file("{", "bad.json"), *MEASURED)

    def test_refuses_arguments_that_do_not_go_together(self):
        new = self.file(metrics_json())
        self.refuses("needs --date and --machine", new)
        self.refuses("is no date", new, "--date", "2027-02-30", "--machine", "a")
        self.refuses("--check takes no FILE", "--check", new, *MEASURED)
        self.refuses("name one", "--date", "2027-01-02")

    def test_refuses_figures_without_a_field_or_of_another_form(self):
        for change, why in (({"machine": None}, "'machine' must be a text"), ({"date": "yesterday"}, "is no date"),
                            ({"commit": "HEAD"}, "is no commit"), ({"value": {"ms": "4"}}, "value 'ms'"),
                            ({"value": {"ratio": 4}}, "lacks what its table shows"), ({"more": 1}, "unknown field 'more'")):
            figures = json.loads((RESULTS / "figures.json").read_text())
            i = next(i for i, figure in enumerate(figures) if figure["id"] == "memory/board/flash")
            figures[i].update(change)
            self.file(figures, "figures.json")
            self.refuses(why, "--check")
        figures = json.loads((RESULTS / "figures.json").read_text())
        self.file(figures + figures[:1], "figures.json")
        self.refuses("comes twice", "--check")


if __name__ == "__main__":
    unittest.main()
