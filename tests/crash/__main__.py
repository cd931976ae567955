"""Kill commands at moments spread evenly over their run and over their writing, and look at what they leave.

    python -m tests.crash --kills 300

Each command runs once to its end, which tells how long it takes, when it begins to write, and what. Then it is killed
(SIGKILL: no cleaning up) into folders that hold the outputs of an earlier run: every file there has to be whole, the
earlier one or the new one.
"""

import argparse
import gzip
import hashlib
import json
import shutil
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path
from xml.etree import ElementTree

from tests.hostile import RIG, ROOT, columns, csv_of

#: Commands, `{out}` being the folder they write to.
COMMANDS = {
    "demo": "demo --out {out}",
    "identify": "identify run.csv --rig rig.toml --out {out} --json {out}/found.json",
    "simulate": "simulate simulated.toml --out {out}/run.csv.gz",
    "diagnose": "diagnose run.csv --rig rig.toml --out {out}",
    "lab": "lab --out {out}",
}


def whole(path: Path) -> bool:
    """Whether a file reads to its end."""
    content = path.read_bytes()
    if path.suffix == ".gz":
        return gzip.decompress(content).endswith(b"\n")
    if path.suffix == ".json":
        return bool(json.loads(content))
    if path.suffix == ".toml":
        return bool(tomllib.loads(content.decode()))
    if path.suffix == ".xml":
        return ElementTree.fromstring(content) is not None
    ends = {".png": b"IEND\xaeB`\x82", ".pdf": b"%%EOF\n", ".html": b"</html>", ".csv": b"\n"}
    return content.rstrip(b"\n").endswith(ends[path.suffix].rstrip(b"\n"))


def visible(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.is_file() and not path.name.startswith(".")]


def start(line: str, folder: Path) -> subprocess.Popen:
    arguments = [sys.executable, "-m", "bench", *line.split()]
    silent = subprocess.DEVNULL
    return subprocess.Popen(arguments, cwd=folder, env={"PYTHONPATH": str(ROOT)}, stdout=silent, stderr=silent)


def timed(line: str, folder: Path) -> tuple[float, float]:
    """How long a command takes, and when it made its first file - s."""
    begun, first, process = time.monotonic(), None, start(line, folder)
    out = folder / "out"
    while process.poll() is None:
        if first is None and out.exists() and any(out.iterdir()):
            first = time.monotonic() - begun
        time.sleep(0.005)
    if process.returncode:
        raise SystemExit(f"bench {line} failed with {process.returncode}")
    lasted = time.monotonic() - begun
    return lasted, first if first is not None else lasted


def killed(line: str, folder: Path, after: float) -> bool:
    """Kill a command so long after its start - s; whether it was still running."""
    process = start(line, folder)
    try:
        process.wait(after)
        return False
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return True


def tried(name: str, kills: int, folder: Path) -> tuple[int, int, list[str]]:
    """Kills that hit a command, files left by them, and those that are no whole file."""
    line = COMMANDS[name].format(out="out")
    (folder / "out").mkdir()
    lasted, first = timed(line, folder)
    hits, files, broken = 0, 0, []
    for k in range(kills):
        over_all = k % 2 == 0  # the other half falls into the writing
        share = (k + 0.5) / kills
        hits += killed(line, folder, share * lasted if over_all else first + share * (lasted - first))
        for path in visible(folder / "out"):
            files += 1
            try:
                good = whole(path)
            except (ValueError, EOFError, OSError, ElementTree.ParseError):
                good = False
            if not good:
                broken.append(f"{name}: {path.name} {hashlib.sha256(path.read_bytes()).hexdigest()[:8]}")
    return hits, files, broken


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m tests.crash")
    parser.add_argument("--kills", type=int, default=300)
    parser.add_argument("--commands", nargs="*", default=list(COMMANDS), choices=list(COMMANDS))
    asked = parser.parse_args()
    all_broken = []
    for number, name in enumerate(asked.commands):
        share = asked.kills // len(asked.commands) + (number < asked.kills % len(asked.commands))
        folder = Path(tempfile.mkdtemp(prefix="crash-"))
        try:
            (folder / "rig.toml").write_text(RIG)
            (folder / "run.csv").write_text(csv_of(*columns()))
            shutil.copy(ROOT / "data" / "rigs" / "sh30701p.toml", folder / "simulated.toml")
            hits, files, broken = tried(name, share, folder)
        finally:
            shutil.rmtree(folder)
        print(f"{name}: {share} kills, {hits} while it ran; {files} files looked at, {len(broken)} broken", flush=True)
        all_broken += broken
    if all_broken:
        raise SystemExit("\n".join(all_broken))


if __name__ == "__main__":
    main()
