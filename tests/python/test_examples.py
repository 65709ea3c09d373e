"""The examples run and say what they should."""
import importlib.util
import math
import os
import re
import subprocess
import sys
import unittest

from common import PROGRAM, SOURCE, InFolder

EXAMPLES = os.path.join(SOURCE, "apps", "python", "examples")


class Examples(InFolder):
    def run_example(self, name, *arguments):
        done = subprocess.run([sys.executable, os.path.join(EXAMPLES, name), *arguments], cwd=self.folder, timeout=300,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def cases(self, *names):
        return os.path.join(SOURCE, "cases", *names)

    def test_the_page_shows_what_they_print(self):
        """To 1 %: other processors and compilers may round otherwise."""
        with open(os.path.join(EXAMPLES, "README.md"), encoding="utf-8") as file:
            sessions = re.findall(r"```text\n\$ python3 apps/python/examples/(.*)\n((?:.*\n)*?)```", file.read())
        self.assertGreaterEqual(len(sessions), 5)
        for command, shown in sessions:
            name, *arguments = command.split()
            said = self.run_example(name, *[os.path.join(SOURCE, a) if "/" in a else a for a in arguments]).splitlines()
            for line in shown.splitlines():
                if line == "...":
                    continue
                while said and not self.is_like(said[0], line):
                    said.pop(0)
                self.assertTrue(said, f"{command} does not print: {line}")
                said.pop(0)

    @staticmethod
    def is_like(said, shown):
        number = r"-?\d+\.?\d*"
        if re.split(number, said) != re.split(number, shown):
            return False
        return all(math.isclose(float(a), float(b), rel_tol=0.01)
                   for a, b in zip(re.findall(number, said), re.findall(number, shown)))

    def test_a_run(self):
        said = self.run_example("watch_a_run.py", self.cases("maungawhau", "case.toml"))
        speeds = [float(speed) for speed in re.findall(r"front .* ([\d.]+) m/s", said)]
        self.assertEqual(len(speeds), 6)
        self.assertEqual(speeds[0], 0.0)
        self.assertGreater(speeds[-1], speeds[1])
        fronts = [float(front) for front in re.findall(r"front +([\d.]+) m", said)]
        self.assertEqual(fronts, sorted(fronts))
        deepest = [float(depth) for depth in re.findall(r"deepest ([\d.]+) m", said)]
        self.assertEqual(deepest[0], 4.0)  # the release's
        area = float(re.search(r"by reason of until; (\d+) m2 were covered", said)[1])
        released = float(re.search(r"particles, ([\d.]+) m3 of", said)[1])
        self.assertGreater(area, released / max(deepest))  # on less it would be deeper

    def test_friction(self):
        said = self.run_example("vary_friction.py", self.cases("maungawhau", "case.toml"))
        reached = [float(front) for front in re.findall(r"mu 0\.\d+ .* ([\d.]+) m$", said, re.M)]
        self.assertEqual(len(reached), 3)
        self.assertEqual(reached, sorted(reached, reverse=True))  # more friction, less far

    def test_own_ground(self):
        said = self.run_example("own_ground.py")
        frames = [[float(number) for number in row]
                  for row in re.findall(r"([\d.]+) s: (\d+) particles, x from (\d+) to (\d+) m", said)]
        self.assertEqual([frame[0] for frame in frames], [0.0, 5.0, 10.0, 15.0, 20.0])
        self.assertEqual(frames[0][1:], [400.0, 40.0, 60.0])  # 4 in each of 100 cells of 2 m
        fronts = [frame[3] for frame in frames]
        self.assertEqual(fronts, sorted(set(fronts)))
        depth, x = [float(number) for number in re.search(r"\? ([\d.]+) m at x = (\d+) m", said).groups()]
        self.assertTrue(0.0 < depth < 2.0)  # the release spreads
        self.assertAlmostEqual(x, 180.0, delta=20.0)  # the release's length

    def test_hydrograph(self):
        said = self.run_example("hydrograph.py", self.cases("maungawhau", "case.toml"))
        times = [float(time) for time in re.findall(r"([\d.]+) s: ", said)]
        self.assertEqual(len(times), 6)
        rates = [float(rate) for rate in re.findall(r"(-?[\d.]+) m3/s pass", said)]
        passed, released = [float(volume) for volume in re.search(r"passes (\d+) m3 of (\d+) m3", said).groups()]
        self.assertTrue(0.0 < passed <= released, said)
        self.assertAlmostEqual(sum(2.0 * rate for rate in rates), passed, delta=6 * 0.1 + 0.5)  # of printed digits

    def test_read_back(self):
        said = self.run_example("read_a_run.py", self.cases("maungawhau", "case.toml"))
        energy = [(float(t), float(kinetic)) for t, kinetic in re.findall(r"([\d.]+) s: kinetic energy ([\d.]+) MJ", said)]
        self.assertEqual((energy[0], energy[-1][0]), ((0.0, 0.0), 8.0))
        self.assertGreater(energy[-1][1], 0.0)
        self.assertRegex(said, r"frame 8 has .*\bdepth\b.*\bvelocity\b")
        iou = float(re.search(r"IoU is ([\d.]+)", said)[1])
        self.assertTrue(0.0 < iou < 1.0, said)  # other friction, another footprint

    def test_pour_in(self):
        said = self.run_example("pour_in.py", self.cases("maungawhau", "case.toml"), "140", "300")
        came = [float(mass) for mass in re.findall(r"s: (\d+) kg came in", said)]
        self.assertGreater(len(came), 2)
        for k, mass in enumerate(came):
            self.assertAlmostEqual(mass, 2.0e4 * (k + 1), delta=1.0)
        self.assertLess(abs(float(re.search(r"([-\d.e+]+) of the mass", said)[1])), 1e-12)

    def test_how_likely(self):
        with open(self.path("ensemble.toml"), "w", encoding="utf-8") as file:
            file.write('[ensemble]\ncase = "case.toml"\nmethod = "sobol"\nsamples = 4\n[[ensemble.vary]]\n'
                       'key = "material.bed.mu"\nrange = [0.1, 0.3]\n')
        said = self.run_example("how_likely.py", self.path("ensemble.toml"), "500050", "4999925", "0.3")
        self.assertRegex(said, r"4 runs; more than 0\.3 m at the place in (0|25|50|75|100) % of them")
        nowhere = self.run_example("how_likely.py", self.path("ensemble.toml"), "500290", "4999855", "0.3")
        self.assertIn("at the place in 0 % of them", nowhere)
        low, high = [float(number) for number in re.search(r"bed\.mu: ([\d.]+) to ([\d.]+)", said).groups()]
        self.assertTrue(0.1 < low < high < 0.3)

    @unittest.skipUnless(importlib.util.find_spec("distributed"), "no dask.distributed")
    def test_with_dask(self):
        file = self.path("ensemble.toml")
        with open(file, "w", encoding="utf-8") as toml:
            toml.write('[ensemble]\ncase = "case.toml"\nmethod = "sobol"\nsamples = 6\n[[ensemble.vary]]\n'
                       'key = "material.bed.mu"\nrange = [0.1, 0.3]\n')
        said = self.run_example("with_dask.py", file, self.path("parts"), "3")
        self.assertEqual(sorted(re.findall(r"shard (\d)/3", said)), ["0", "1", "2"])
        subprocess.run([PROGRAM, "ensemble", file, "--out", self.path("whole"), "--quiet"], check=True, timeout=300)
        for name in ("runs.csv", "rasters/probability_reached.tif"):
            with open(self.path("parts", name), "rb") as parts, open(self.path("whole", name), "rb") as whole:
                self.assertEqual(parts.read(), whole.read(), name)


if __name__ == "__main__":
    unittest.main()
