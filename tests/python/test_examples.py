"""The examples run and say what they should."""
import os
import re
import subprocess
import sys
import unittest

from common import SOURCE, InFolder

EXAMPLES = os.path.join(SOURCE, "apps", "python", "examples")


class Examples(InFolder):
    def run_example(self, name, *arguments):
        done = subprocess.run([sys.executable, os.path.join(EXAMPLES, name), *arguments], cwd=self.folder, timeout=300,
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def cases(self, *names):
        return os.path.join(SOURCE, "cases", *names)

    def test_a_run(self):
        said = self.run_example("watch_a_run.py", self.cases("maungawhau", "case.toml"))
        speeds = [float(speed) for speed in re.findall(r"front .* ([\d.]+) m/s", said)]
        self.assertEqual(len(speeds), 6)
        self.assertGreater(speeds[-1], speeds[1])

    def test_friction(self):
        said = self.run_example("vary_friction.py", self.cases("maungawhau", "case.toml"))
        reached = [float(front) for front in re.findall(r"mu 0\.\d+ .* ([\d.]+) m$", said, re.M)]
        self.assertEqual(len(reached), 3)
        self.assertEqual(reached, sorted(reached, reverse=True))  # more friction, less far

    def test_own_ground(self):
        said = self.run_example("own_ground.py")
        self.assertRegex(said, r"deepest at the foot")

    def test_hydrograph(self):
        said = self.run_example("hydrograph.py", self.cases("maungawhau", "case.toml"))
        self.assertRegex(said, r"passes .* m3")

    def test_read_back(self):
        said = self.run_example("read_a_run.py", self.cases("maungawhau", "case.toml"))
        self.assertRegex(said, r"IoU")


if __name__ == "__main__":
    unittest.main()
