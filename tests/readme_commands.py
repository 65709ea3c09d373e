#!/usr/bin/env python3
"""Runs the frana commands that stand in the ```sh blocks of all READMEs: readme_commands.py FRANA SOURCE FOLDER.

Each is run as it stands, in a scratch folder that sees the project's cases, with three exceptions, so that it takes seconds:
runs stop early (--until; the cases are run in full by tests of their own), `converge` has a short time.end, `ensemble` and
`calibrate` a few samples, and commands that take minutes by their nature are shortened as SHORTENED says. `case.toml` is a copy
of the volcano's. Commands without --out get one. A command whose options or keys do not exist any more fails.
"""
import os
import re
import shutil
import subprocess
import sys

# Commands of minutes: what is run in their place. The options are the same, the amount of work is not.
SHORTENED = {
    "frana verify --json verify.json": "frana verify --json verify.json lake_z1 --cells 10",
    "frana verify --study": None,  # a minute, and it has no shorter form: ctest "verification" runs the problems
    "frana verify --figure work_precision.png": None,  # as --study
    "frana verify stoker similarity --cells 80,160": "frana verify stoker similarity --cells 40",
    "frana verify conversion --cells 250,500,1000,1500,2000": "frana verify conversion --cells 50,100",
    "frana bench": "frana bench --quick --particles 2000",
    "frana bench --threads 1,2,4,8,16": "frana bench --quick --particles 2000 --threads 1,2",
    "frana bench --quick --particles 100000": "frana bench --quick --particles 2000",
    "frana bench --json bench.json": "frana bench --quick --particles 2000 --json bench.json",
    "frana stress --seconds 600 --seed 7": "frana stress --seconds 600 --seed 7 --scenes 3",
    "frana stress --model structured,staged": "frana stress --model structured,staged --scenes 2",
    # A folder that only a failed scene leaves: any case does.
    "frana stress --case out/stress/stress-staged-7-42/case.toml --steps 30": "frana stress --case cases/wall/case.toml --steps 3",
    "frana stress --cfl-map --figure cfl.png": None,  # half an hour
}
# Needs pvbatch: run by the test pvbatch_states.
ELSEWHERE = ("xvfb-run", "pvbatch")
PAGES_APART = ("build",)


def pages(source):
    for folder, folders, files in os.walk(source):
        folders[:] = sorted(f for f in folders if not f.startswith(".") and not f.startswith(PAGES_APART) and f != "out")
        for name in sorted(files):
            if name.endswith(".md"):
                yield os.path.join(folder, name)


def commands(page):
    with open(page, encoding="utf-8") as text:
        blocks = re.findall(r"^```sh\n(.*?)^```", text.read(), re.M | re.S)
    for block in blocks:
        for line in block.replace("\\\n", " ").splitlines():
            line = re.sub(r"\s+#.*", "", line).strip()
            loop = re.fullmatch(r"for (\w+) in ([^;]+); do (.*); done", line)
            parts = [loop.group(3).replace("$" + loop.group(1), loop.group(2).split()[0])] if loop else line.split(" && ")
            for part in parts:
                part = part.replace("build/bin/frana", "frana").strip()
                if part.startswith("frana ") and not any(word in part for word in ELSEWHERE):
                    yield part


def quick(command, number):
    if command in SHORTENED:
        return SHORTENED[command]
    words = command.split()
    if words[1] in ("run", "converge"):
        if "--out" not in words:
            command += f" --out out/readme_{number}"
        command += " --quiet --overwrite"
    if words[1] == "run":
        # A frame at the start and one at the end, so that what follows on the page finds times to look at; no pictures,
        # which take seconds and which `frana figures` draws.
        command += f" --until {0.3 if 'conversion' in command else 0.01}"
        if "output.formats" not in command:
            command += """ --set 'output.formats=["vtk","geotiff"]'"""
    if words[1] == "figures":  # of a run that stopped early
        command = re.sub(r"--time \S+", "--time 0", command)
    if words[1] == "ensemble":
        command = command.replace("cases/ensemble/", "few/").replace("--again 317", "--again 3") + " --quiet"
        if not re.search("--(join|again|check)", command):
            command += " --resume"  # the same ensemble stands on two pages
    if words[1] == "calibrate":
        command = command.replace("cases/calibrate/", "few/") + " --quiet"
        if "--resume" not in words:
            command += " --overwrite"
    if words[1] == "converge":
        command += " --set time.end=0.5 --set output.formats=[]"
    return command


def main():
    frana, source, folder = sys.argv[1:4]
    shutil.rmtree(folder, ignore_errors=True)
    os.makedirs(folder)
    os.symlink(os.path.join(source, "cases"), os.path.join(folder, "cases"))
    for name in ("case.toml", "dem.asc", "release.geojson"):
        shutil.copy(os.path.join(source, "cases", "maungawhau", name), folder)
    os.makedirs(os.path.join(folder, "few"))
    with open(os.path.join(source, "cases", "ensemble", "ensemble.toml"), encoding="utf-8") as whole:
        few = re.sub(r"samples = \d+", "samples = 4", whole.read()).replace('"case.toml"', '"../cases/ensemble/case.toml"')
    with open(os.path.join(folder, "few", "ensemble.toml"), "w", encoding="utf-8") as file:
        file.write(few)
    with open(os.path.join(source, "cases", "calibrate", "calibrate.toml"), encoding="utf-8") as whole:
        few = re.sub(r"(samples|draws) = \d+", r"\1 = 4", whole.read()).replace("rounds = 3", "rounds = 1\nsearch = \"none\"")
        few = re.sub(r'case = "', 'case = "../cases/calibrate/', few)
    with open(os.path.join(folder, "few", "calibrate.toml"), "w", encoding="utf-8") as file:
        file.write(few)
    environment = dict(os.environ, OMP_NUM_THREADS="1")
    tried, failed, done = 0, 0, set()
    for page in pages(source):
        for command in commands(page):
            line = quick(command, tried)
            if line is None or (line in SHORTENED.values() and line in done):  # two may be shortened to one
                continue
            tried += 1
            done.add(line)
            ran = subprocess.run(line.replace("frana", frana, 1), shell=True, cwd=folder, env=environment,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
            if ran.returncode != 0:
                failed += 1
                print(f"{os.path.relpath(page, source)}: {command}\n  ran as: {line}\n  exit {ran.returncode}: "
                      f"{ran.stdout.strip()[-600:]}")
    print(f"{tried} commands of the READMEs run, {failed} failed")
    return 1 if failed or tried < 30 else 0


if __name__ == "__main__":
    sys.exit(main())
