#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The pictures of "Where each method fails" in docs/rs-real-results.md, on painted streets.

Arguments: the program, a folder for what is made on the way, the folder for the pictures. Needs
ffmpeg. Each picture is a row: as recorded, corrected by the method, the truth.
"""

import base64
import csv
import re
import shutil
import subprocess
import sys
from pathlib import Path

PANEL = (360, 270)


class Maker:
    def __init__(self, program: str, work: Path, out: Path):
        self.program = str(Path(shutil.which(program) or program).resolve())
        self.work, self.out = work, out
        work.mkdir(parents=True, exist_ok=True)
        out.mkdir(parents=True, exist_ok=True)

    def run(self, *arguments):
        subprocess.run([self.program, *map(str, arguments), "--progress", "none"], cwd=self.work,
                       check=True, stdout=subprocess.DEVNULL)

    def simulate(self, name: str, *options) -> str:
        self.run("simulate", name, "--rs-real", "--overwrite", *options)
        return name

    def part(self, dataset: str, sample: str) -> str:
        """A set of one picture or one clip of `dataset`."""
        name = f"{dataset}-{sample}"
        to = self.work / name / "test" / "npz"
        shutil.rmtree(self.work / name, ignore_errors=True)
        to.mkdir(parents=True)
        for path in (self.work / dataset / "test" / "npz").glob(f"{sample}*"):
            (shutil.copytree if path.is_dir() else shutil.copy)(path, to / path.name)
        return name

    def ffmpeg(self, *arguments):
        subprocess.run(["ffmpeg", "-v", "error", "-y", *map(str, arguments)], cwd=self.work,
                       check=True)

    def picture(self, name: str, dataset: str, method: str):
        """The one on which the method gains least."""
        self.run("evaluate", "--dataset", f"rs-real:{dataset}", "--methods", f"none,{method}",
                 "--csv", "row.csv", "--report", "page.html", "--overwrite")
        page = (self.work / "page.html").read_text(encoding="utf-8")
        shown = page[page.rindex("<h3>", 0, page.rindex('alt="truth: ')):]
        sample = re.search(r"<h3>(.*?), where", shown)[1]
        inputs = []
        for label in ("before", "after", "truth"):
            found = re.search(r'src="data:image/webp;base64,([^"]*)" alt="' + label + ":", shown)
            path = self.work / f"{label}.webp"
            path.write_bytes(base64.b64decode(found[1]))
            inputs += ["-i", path.name]
        scale = ";".join(f"[{i}]scale={PANEL[0]}:{PANEL[1]}:flags=area,pad=iw+8:ih:4:0:white[p{i}]"
                         for i in range(3))
        self.ffmpeg(*inputs, "-filter_complex", scale + ";[p0][p1][p2]hstack=3", "-q:v", "7",
                    (self.out / f"{name}.jpg").resolve())
        with open(self.work / "row.csv", encoding="utf-8") as rows:
            for row in csv.DictReader(rows):
                if row["name"] == sample:
                    print(f"{name}: {sample} {row['strength']}: {row['method']} EPE {row['epe']} px"
                          f" (u {row['u']}, v {row['v']}), PSNR {row['psnr']} dB")


def main():
    maker = Maker(sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3]))
    streets = maker.simulate("streets", "--samples", 24, "--seed", 1)
    clips = maker.simulate("clips", "--samples", 72, "--frames", 6, "--seed", 1)

    # Houses seen from below: upright edges that lean, all to one side where the picture is cut.
    maker.run("simulate", "upright", "--motion", "handheld", "--duration", 0.1, "--width", 1280,
              "--height", 960, "--seed", 4, "--overwrite")
    (maker.work / "leaning").mkdir(exist_ok=True)
    maker.ffmpeg("-i", "upright/gs.mp4", "-frames:v", 1, "-vf",
                 "perspective=x0=320:y0=0:x1=960:y1=0:x2=0:y2=960:x3=1280:y3=960"
                 ":sense=destination,crop=560:420:260:200", "leaning/street.png")
    leaning = maker.simulate("leaning-set", "--photos", "leaning", "--samples", 1, "--seed", 2)

    maker.picture("works-diffusion", maker.part(streets, "0024"), "diffusion")
    maker.picture("fails-diffusion-leaning", leaning, "diffusion")
    maker.picture("fails-diffusion-stretch", maker.part(streets, "0018"), "diffusion")
    maker.picture("fails-lines-leaning", leaning, "lines")
    maker.picture("fails-homography-mixture-vibration", maker.part(clips, "seq_0005"),
                  "homography-mixture")
    maker.picture("fails-rotation-spline-vibration", maker.part(clips, "seq_0005"), "rotation-spline")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main()
