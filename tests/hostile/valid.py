"""Valid files of every kind, made by the tools themselves."""
import contextlib
import os
import shutil
import subprocess
import zipfile
from glob import glob
from pathlib import Path

import numpy


def run(*words, **options):
    return subprocess.run(words, check=True, stdout=subprocess.PIPE, **options).stdout


def make(folder, source):
    """Fills the folder; its file names are those in readers.py."""
    os.makedirs(folder)
    with contextlib.chdir(folder):
        Path("letters.txt").write_text("HVH\nS.R\nHVH\n\nHV\nVH\n")
        Path("one.txt").write_text("HV\nVH\n")
        Path("numbers.txt").write_text("3 3 3\n4 0 4\n\n3.0e+00,4.0e+00\n0.0e+00,1.0e+00\n")
        Path("lists.json").write_text("[[3, 3, 3], [4, 0, 4]]\n")
        numpy.save("body.npy", numpy.array([[3, 3, 3], [4, 0, 4]]))
        numpy.save("actions.npy", numpy.array([[1.0, 1.1, 0.6, 1.6], [0.9, 1.2, 1.1, 1.0]]))
        with zipfile.ZipFile("model.zip", "w") as file:
            for member in ("data", "policy.pth", "_stable_baselines3_version"):
                file.writestr(zipfile.ZipInfo(member), "x" * 40)
        run("evo-sample", "-n", "4", "--shape", "3x3", "--seed", "1", "-o", "robots.jsonl")
        run("evo-convert", "one.txt", "-o", "robot.json")
        run("evo-convert", "robots.jsonl", "--to", "yaml", "-o", "robots.yaml")
        run("evo-convert", "one.txt", "-o", "robot.npz")
        run("evo-convert", "one.txt", "--to", "evogym", "-o", "world.json")
        run("evo-convert", "--task", "Carrier-v0", "--to", "evogym", "-o", "carrier.json")
        run("evo-eval", "robots.jsonl", "--task", "Walker-v0", "--actions", "random", "--max-steps", "2",
            "-o", "scored.jsonl")
        run("evo-eval", "one.txt", "--task", "Walker-v0", "--actions", "random", "--max-steps", "2",
            "--rollout", "rollout.h5")
        run("evo-train", "one.txt", "--task", "Walker-v0", "--train", "gait", "--steps", "2000",
            "--out-dir", ".", "--train", "population=4", "-o", "sine.json")
        os.rename(*glob("*.policy.h5"), "sine.h5")
        Path("tiny.yaml").write_text(
            "base: paper\nenvironments: 1\nrollout: 2\nminibatches: 1\nhidden: [4]\nfinal_episodes: 0\n")
        run("evo-train", "one.txt", "--task", "Walker-v0", "--train", "tiny.yaml", "--steps", "8",
            "--out-dir", ".", "-o", "trained.json")
        os.rename(*glob("*.policy.h5"), "network.h5")
        for log in glob("*.log"):
            os.remove(log)
        run("evo-neat", "-n", "3", "--shape", "3x3", "--state-out", "species.json", "-o",
            "genomes.jsonl")
        Path("genomes.jsonl").write_bytes(run("jq", "-c", ".fitness = 1", "genomes.jsonl"))
        shutil.copy(f"{source}/tasks/Carrier-v1.yaml", "task.yaml")
        shutil.copy(f"{source}/tasks/examples/ramp.yaml", "ramp.yaml")
        shutil.copy(f"{source}/tasks/physics/evogym.yaml", "physics.yaml")
        shutil.copy(f"{source}/tasks/training/paper.yaml", "training.yaml")
        shutil.copy(f"{source}/tasks/neat.yaml", "neat.yaml")
        with open(f"{source}/tasks/neat.yaml") as file, open("neat.cfg", "w") as ini:
            ini.write("[NEAT]\n")
            for line in file:
                key, colon, value = line.partition("#")[0].partition(":")
                if colon and key not in ("format", "version"):
                    ini.write(f"{key} = {value.strip(' []') or ''}".rstrip() + "\n")
        Path("actions.csv").write_text("a,b,c,d\n1.0,1.1,0.6,1.6\n0.9,1.2,1.1,1.0\n")
        Path("requests.jsonl").write_text(
            '{"reset":{"seed":1,"jitter":1e-4}}\n{"step":[[1.0,1.1,0.6,1.6]]}\n{"save":{"environments":[0]}}\n')
        run("evo-evolve", "neat", "--run", "run", "--pop", "3", "--evals", "6", "--steps", "512", "--shape", "2x2",
            "--train-options=--train environments=2 --train rollout=16", "--seed", "1", "-q")
        shutil.copy("run/run.yaml", "run.yaml")
