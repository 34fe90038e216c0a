"""Which tool reads which file, and how it may end when the file is damaged.

A row: name, file, kind of damage (mutate.KINDS), command, statuses, weight.
{} in a command is the damaged file; "<" feeds it to standard input. Status 0 is
always possible: damage need not show. 65 is bad data; others are listed where
the content can ask for them: 1 a simulation that diverges or work that cannot
be done, 2 a name in the file that means nothing here, 66 a file that it names.
"""
EVAL = ["evo-eval", "-j1", "--task", "Walker-v0", "--max-steps", "2"]
SMALL = ["--train-set", "final_episodes=0"]

READERS = [
    ("population", "robots.jsonl", "json", ["evo-select", "<"], (65,), 3),
    ("population", "robots.jsonl", "json", ["evo-mutate", "-n", "2", "{}"], (65, 1), 2),
    ("population", "robots.jsonl", "json", ["evo-convert", "{}"], (65,), 1),
    ("population", "robots.jsonl", "json", ["evo-inspect", "{}"], (65,), 1),
    ("population", "robots.jsonl", "json", ["evo-sample", "-n", "1", "--avoid", "{}"], (65,), 1),
    ("population", "robots.jsonl", "json", EVAL + ["--random", "{}"], (65, 1, 2), 2),
    ("scored robots", "scored.jsonl", "json",
     ["evo-suggest", "-n", "1", "--candidates", "20", "--history", "{}"], (65, 1, 2), 2),
    ("scored robots", "scored.jsonl", "json",
     ["evo-select", "--method", "pareto", "--objectives=fitness,-voxels", "{}"], (65,), 1),
    ("genomes", "genomes.jsonl", "json",
     ["evo-neat", "-n", "3", "--state-in", "valid/species.json", "--state-out", "o.json", "{}"],
     (65, 1, 2), 2),
    ("robot", "robot.json", "json", ["evo-inspect", "robot", "{}"], (65,), 1),
    ("robot, YAML", "robots.yaml", "text", ["evo-convert", "<"], (65,), 3),
    ("robot, letters", "letters.txt", "text", ["evo-convert", "{}"], (65,), 2),
    ("robot, .npz", "robot.npz", "binary", ["evo-convert", "{}"], (65,), 3),
    ("design-tool world", "world.json", "json", ["evo-convert", "{}"], (65,), 2),
    ("trained robot", "trained.json", "json", ["evo-eval", "-j1", "{}"], (65, 1, 2, 66), 1),
    ("NEAT state", "species.json", "json",
     ["evo-neat", "-n", "3", "--state-in", "{}", "--state-out", "o.json", "valid/genomes.jsonl"],
     (65, 1, 2), 3),
    ("NEAT settings", "neat.yaml", "text",
     ["evo-neat", "-n", "3", "--shape", "3x3", "--neat", "{}", "--state-out", "o.json"],
     (65, 1, 2), 2),
    ("task", "task.yaml", "text", ["evo-inspect", "task", "{}"], (65, 66, 2), 3),
    ("task", "ramp.yaml", "text",
     ["evo-eval", "-j1", "--task", "{}", "--max-steps", "2", "--random", "valid/one.txt"],
     (65, 66, 1, 2), 3),
    ("physics profile", "physics.yaml", "text", EVAL + ["--random", "--physics", "{}",
     "valid/one.txt"], (65, 66, 1, 2), 2),
    ("training profile", "training.yaml", "text",
     ["evo-train", "-j1", "--task", "Walker-v0", "--algo", "random", "--steps", "2", "--train",
      "{}", "--out-dir", "policies", "--force", "valid/one.txt"] + SMALL, (65, 66, 1, 2), 2),
    ("options", "config.yaml", "text", ["evo-sample", "--config", "{}"], (65, 66, 73, 1, 2), 3),
    ("actions, CSV", "actions.csv", "text", EVAL + ["--actions", "{}", "valid/one.txt"],
     (65, 1, 2), 2),
    ("actions, rollout", "rollout.h5", "hdf5", EVAL + ["--actions", "{}", "valid/one.txt"],
     (65, 1, 2), 2),
    ("rollout", "rollout.h5", "hdf5", ["evo-inspect", "{}"], (65,), 3),
    ("rollout", "rollout.h5", "hdf5", ["evo-convert", "{}"], (65,), 1),
    ("rollout", "rollout.h5", "hdf5", ["evo-convert", "{}", "--to", "minari", "-o", "set"],
     (65, 2, 73), 1),
    ("draws of a rollout", "rollout.h5", "hdf5",
     EVAL + ["--random", "--draws", "{}", "valid/one.txt"], (65, 2), 1),
    ("policy, network", "network.h5", "hdf5",
     ["evo-eval", "-j1", "--max-steps", "2", "--policy", "{}", "valid/one.txt"], (65, 1, 2), 3),
    ("policy, network", "network.h5", "hdf5", ["evo-inspect", "{}"], (65,), 2),
    ("policy, waves", "sine.h5", "hdf5",
     ["evo-eval", "-j1", "--max-steps", "2", "--policy", "{}", "valid/one.txt"], (65, 1, 2), 2),
    ("policy as robot", "network.h5", "hdf5", ["evo-mutate", "-n", "1", "{}"], (65, 1), 1),
    ("pictures", "robots.jsonl", "json",
     ["evo-render", "--grid", "--size", "64x64", "{}", "-o", "o.png"], (65, 1, 2), 0.1),
    ("pictures", "rollout.h5", "hdf5",
     ["evo-render", "-j1", "--sheet", "2", "--size", "64x64", "{}", "-o", "o.png"],
     (65, 1, 2), 0.1),
]
