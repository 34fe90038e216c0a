"""Files of the tools as arrays; needs h5py."""
import json
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np

import evo_robots
from common import FEW_OPTIONS, SMALL, tool
from evo_robots import Simulator, Trained, files, robot_document


class Files(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.robot = self.folder / "robot.json"
        self.robot.write_text(json.dumps(robot_document(SMALL)))

    def test_rollouts_and_actions(self):
        rng = np.random.default_rng(0)
        actions = rng.uniform(0.6, 1.6, (25, 4))
        files.write_actions(self.folder / "actions.h5", actions)
        said = json.loads(tool("evo-eval", "--task", "Walker-v0", "--actions",
                               self.folder / "actions.h5", "--rollout", self.folder / "walk.h5",
                               self.robot))
        with self.assertRaisesRegex(ValueError, "steps, actuators"):
            files.write_actions(self.folder / "flat.h5", actions.ravel())
        [episode] = files.read_rollout(self.folder / "walk.h5")
        np.testing.assert_array_equal(episode.actions, actions)
        self.assertAlmostEqual(episode.rewards.sum(), said["fitness"], places=12)
        self.assertEqual(episode.observations.shape[0], 26)
        self.assertEqual(episode.positions.shape[::2], (26, 2))

    def test_a_trained_policy_acts_as_in_evo_eval(self):
        tool("evo-train", self.robot, "--task", "Walker-v0", "--steps", 4096, "--out-dir",
             self.folder, "-o", self.folder / "trained.json", "-q")
        [trained] = files.read_robots(self.folder / "trained.json")
        policy = Trained.read(self.folder / trained["policy"])
        tool("evo-eval", self.folder / "trained.json", "--rollout", self.folder / "walk.h5")
        [episode] = files.read_rollout(self.folder / "walk.h5")
        np.testing.assert_allclose(policy.act(episode.observations[:-1]), episode.actions,
                                   atol=1e-5)
        policy.rollout(self.folder / "again.h5")
        [again] = files.read_rollout(self.folder / "again.h5")
        np.testing.assert_array_equal(again.positions, episode.positions)
        film = policy.video(fps=50)
        self.assertEqual(len(film), len(episode.positions))
        np.testing.assert_array_equal(film._frames._moments[-1], episode.positions[-1])

    def test_a_network_of_ones_own_goes_back_to_the_tools(self):
        rng = np.random.default_rng(1)
        with Simulator("Walker-v0", SMALL) as simulator:
            length = int(simulator.observation_lengths[0])
            layers = [(rng.normal(size=(8, length)), rng.normal(size=8)),
                      (rng.normal(size=(4, 8)), rng.normal(size=4))]
            files.write_policy(self.folder / "own.policy.h5", simulator, robot_document(SMALL),
                               layers, offset=1.1)
            policy = Trained.read(self.folder / "own.policy.h5")
            state = simulator.reset(seed=0, episode=0)
            total = 0.0
            for _ in range(100):
                state = simulator.step(policy.act(state.observations))
                total += state.rewards[0]
        said = json.loads(tool("evo-eval", self.robot, "--policy", self.folder / "own.policy.h5",
                               "--max-steps", 100))
        self.assertAlmostEqual(said["fitness"], total, delta=1e-2 * max(1, abs(total)))
        said = tool("evo-inspect", self.folder / "own.policy.h5")
        self.assertRegex(said, "trained   on Walker-v0, 0 steps\nmade by   evo_robots\ncontrol ")

    def run_of(self, name, *options):
        tool("evo-evolve", "ga", "--run", self.folder / name, "--pop", 3, "--evals", 4, "--shape", "3x3", "-q",
             "-j1", *options)
        return self.folder / name

    def test_runs_as_one_frame(self):
        try:
            import pandas
        except ModuleNotFoundError:
            with self.assertRaisesRegex(evo_robots.EvoError, "pip install pandas"):
                files.read_run()
            self.skipTest("pandas is not installed")
        trained = self.run_of("walk", "--task", "Walker-v0", "--seed", 1, "--steps", 512, "--no-video",
                              "--train-options", FEW_OPTIONS)
        scored = self.run_of("own", "--evaluate", "jq -c '.fitness = (.body | length)'", "--seed", 2,
                             "--name", "rows")
        (scored / "gen-000" / "scores.jsonl").unlink()  # as of a run that is not finished
        frame = files.read_run(trained, scored)
        self.assertEqual(frame.groupby("run").size().tolist(), [4, 4])
        walk = frame[frame.run == str(trained)]
        history = files.read_robots(trained / "history.jsonl")
        self.assertEqual(walk.id.tolist(), [robot["id"] for robot in history])
        self.assertEqual(walk.fitness.tolist(), [robot["fitness"] for robot in history])
        self.assertEqual(walk.perturbed.tolist(), [robot["final"]["mean"] for robot in history])
        self.assertEqual(walk.parents.tolist(), [robot.get("parents", []) for robot in history])
        self.assertEqual(walk.best.iloc[-1], walk.fitness.max())
        self.assertTrue((walk.seconds > 0).all() and (walk.steps == 512).all() and walk.policy.map(Path).map(
            Path.is_file).all())
        first = walk.iloc[0]
        self.assertEqual((first.method, first.task, first.seed, first.generation, first["index"]),
                         ("ga", "Walker-v0", 1, 0, 0))
        self.assertEqual(first[["empty", "rigid", "soft", "horizontal", "vertical"]].tolist(),
                         [first.body.count(letter) for letter in ".RSHV"])
        own = frame[frame.run == str(scored)]
        self.assertEqual(set(own.fitness), {3})
        self.assertIn("jq", own.task.iloc[0])
        self.assertEqual(set(own.method), {"rows"})
        self.assertIsInstance(frame, pandas.DataFrame)

    def test_logs_and_tensorboard(self):
        run = self.run_of("walk", "--task", "Walker-v0", "--seed", 1, "--steps", 512, "--no-video",
                          "--train-options", FEW_OPTIONS)
        log = next(run.glob("policies/*.log"))
        [line] = files.read_log(log)
        self.assertEqual(line["charts/global_step"], 512)
        with open(log, "a") as file:
            file.write("# evo-train, resumed\ncharts/global_step 9\teval/return 1\ncharts/glob")
        self.assertEqual(files.read_log(log)[1:], [{"charts/global_step": 9, "eval/return": 1}])
        try:
            from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
        except ModuleNotFoundError:
            with self.assertRaisesRegex(evo_robots.EvoError, "pip install tensorboard"):
                files.to_tensorboard(run, self.folder / "events")
            self.skipTest("tensorboard is not installed")
        subprocess.run([sys.executable, "-m", "evo_robots", "tensorboard", run, self.folder / "events"], check=True)
        for name, tag, count in (("", "best", 4), (log.stem, "eval/return", 2)):
            events = EventAccumulator(str(self.folder / "events" / name)).Reload()
            found = [event.tensor_proto.float_val[0] for event in events.Tensors(tag)]
            self.assertEqual(len(found), count)
        self.assertEqual(found, [np.float32(line["eval/return"]), 1])


if __name__ == "__main__":
    unittest.main()
