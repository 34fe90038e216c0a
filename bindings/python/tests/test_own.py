"""Tasks in Python, and the suite's learner on them; needs numpy alone."""
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import numpy as np

import evo_robots
from evo_robots import EvoError, Simulator, Task, Trained, World
from evo_robots.own import TaskEnvironments
from common import FEW, FEW_OPTIONS, WALKER, tool


def careful(folder):
    """A task file with all that the class Careful below has."""
    known = Simulator("Walker-v0", WALKER).task()["task_yaml"]
    text = known.replace("steps: 500", "steps: 500\nhold: 5\nstep_cost: 0.01").replace(
        "folding_reward", "  - effort:\n    weight: -0.1\n  - action_change:\n    weight: -0.2\nfolding_reward")
    assert text.count("hold") == text.count("effort") == 1, text
    Path(folder, "careful.yaml").write_text(text)
    return Path(folder, "careful.yaml")


WALK = '''
import numpy as np
from evo_robots import Task

class Walk(Task):
    """Walker-v0, written in Python."""

    def observe(self, now):
        shape = now.shape("robot").reshape(len(now.steps), -1, 2)
        return np.concatenate([now.mean_velocity("robot"), shape[:, :, 0], shape[:, :, 1]], axis=1)

    def reward(self, before, now, actions):
        return now.centre("robot")[:, 0] - before.centre("robot")[:, 0]

    def done(self, now):
        return now.centre("robot")[:, 0] > 9.9
'''
exec(WALK)  # the same text is a file below
Walk = globals()["Walk"]


class Fast(Walk):
    hold = 2


class Environments(unittest.TestCase):
    def test_tasks_written_again_observe_and_reward_the_same(self):
        """One with the terms of YAML tasks that see actions, held actions and a cost of steps; with actions beyond
        the bounds."""
        class Careful(Walk):
            hold, step_cost = 5, 0.01

            def reward(self, before, now, actions):
                effort = ((actions - 1) ** 2).sum(axis=1)
                change = ((actions - before.actions) ** 2).sum(axis=1)
                return super().reward(before, now, actions) - 0.1 * effort - 0.2 * change

        with tempfile.TemporaryDirectory() as folder:
            both = [(TaskEnvironments(task, WALKER, 3), Simulator(known, WALKER, 3))
                    for task, known in ((Walk(), "Walker-v0"), (Careful(), careful(folder)))]
        rng = np.random.default_rng(0)
        for own, known in both:
            np.testing.assert_allclose(own.reset(), known.reset().observations, atol=1e-12)
            for t in range(100):
                actions = rng.uniform(0.5, 1.8, (3, 13)).astype(np.float32)
                observations, rewards, terminated, _ = own.step(actions)
                state = known.step(actions)
                np.testing.assert_array_equal(own.sims.positions, known.positions)
                np.testing.assert_allclose(observations, state.observations, atol=1e-8)
                np.testing.assert_allclose(rewards, state.rewards, rtol=0, atol=1e-12)
                np.testing.assert_array_equal(terminated, state.terminated)
                if t == 20:
                    own.reset([True, False, True]), known.reset([0, 2])
        with self.assertRaisesRegex(ValueError, "hold: 0 is not from 1"):
            Careful.hold = 0
            TaskEnvironments(Careful(), WALKER)

    def test_draws_and_perturbed_starts(self):
        class Fetch(Walk):
            def world(self, body, connections):
                world = super().world(body, connections)
                world.add("package", np.full((2, 2), 2), 20, 1)
                return world

            def draw(self, random):
                return {"goal": random.integers(1000), "package": (random.integers(8), 0)}

        def begun(envs, **arguments):
            envs.reset(**arguments)
            return envs._now.draws["goal"].tolist(), envs._now.centre("package")[:, 0].round(6).tolist()

        envs = TaskEnvironments(Fetch(), WALKER, 3, seed=7)
        goals, places = begun(envs)
        self.assertEqual(len({*goals}), 3)
        self.assertGreater(len({*places}), 1)
        more = begun(envs)
        self.assertEqual(begun(envs, seed=7), (goals, places))
        for number, (goal, place) in enumerate(zip(goals + more[0], places + more[1])):  # one by one, perturbed
            if number == 0:
                one = TaskEnvironments(Fetch(), WALKER, seed=7, jitter=1e-3)
            self.assertEqual(begun(one)[0], [goal])
            moved = one.sims.positions[0] - envs.sims.positions[0]
            self.assertAlmostEqual(one._now.centre("package")[0, 0], place, delta=1e-4)
        self.assertTrue(1e-6 < np.abs(moved[:, 1]).max() <= 1e-4)
        env = Fetch().envs(WALKER, 1, jitter=1e-3)
        np.testing.assert_array_equal(env.reset(seed=3), Fetch().envs(WALKER, 1, seed=3, jitter=1e-3).reset())

    def test_limits_and_resets_of_some(self):
        class Short(Walk):
            steps = 3

        envs = TaskEnvironments(Short(), WALKER, 2)
        start = envs.reset()
        envs.step(np.full((2, 13), 1.3))
        envs.reset([True, False])
        observations, _, _, truncated = envs.step(np.full((2, 13), 1.3))
        self.assertEqual((envs.steps.tolist(), truncated.tolist()), ([1, 2], [False, False]))
        truncated = envs.step(np.full((2, 13), 1.3))[3]
        self.assertEqual(truncated.tolist(), [False, True])
        self.assertFalse(np.array_equal(observations, start))

    def test_a_robot_that_folds_ends_its_episode(self):
        class Fall(Walk):
            def world(self, body, connections):
                world = World()
                world.add("robot", body, 1, 300, connections)
                return world

        robot = np.full((3, 3), 2)
        robot[1, 1] = 3
        envs = TaskEnvironments(Fall(), robot)
        for _ in range(500):
            _, rewards, terminated, _ = envs.step(np.ones((1, 1)))
            if terminated[0]:
                break
        if envs.sims.status[0] != 0:
            self.assertLess(rewards[0], -2.5)

    def test_what_a_task_gives_is_checked(self):
        class Flat(Walk):
            def observe(self, now):
                return now.positions.mean()

        class Single(Walk):
            def reward(self, before, now, actions):
                return 0.0

        class Nobody(Walk):
            def world(self, body, connections):
                world = World()
                world.add("ground", np.full((1, 100), 5), 0, 0)
                return world

        with self.assertRaisesRegex(ValueError, "Flat.observe gave shape"):
            TaskEnvironments(Flat(), WALKER)
        with self.assertRaisesRegex(ValueError, "Single.reward gave shape"):
            TaskEnvironments(Single(), WALKER, 2).step(np.ones((2, 13)))
        with self.assertRaisesRegex(ValueError, "no robot"):
            TaskEnvironments(Nobody(), WALKER)
        with self.assertRaisesRegex(NotImplementedError, "no observe"):
            TaskEnvironments(Task(), WALKER)


class Training(unittest.TestCase):
    def test_ours_learns_a_task_in_python(self):
        trained = evo_robots.train(Walk, WALKER, steps=51_200, seed=1)
        self.assertGreater(trained.fitness, 1.5)
        once, again = (evo_robots.train(Walk(), WALKER, steps=2048, seed=2, settings=FEW) for _ in range(2))
        np.testing.assert_array_equal(once.curve, again.curve)
        envs = TaskEnvironments(Walk(), WALKER)
        observations, total = envs.reset(), 0.0
        for _ in range(500):
            observations, rewards, terminated, _ = envs.step(trained.act(observations, envs.steps))
            total += rewards[0]
        # The mean of eight, as the profile says, from starts perturbed a little.
        self.assertAlmostEqual(total, trained.fitness, delta=0.3 * total)
        self.assertNotEqual(total, trained.fitness)
        official = evo_robots.train(Walk, WALKER, steps=2048, seed=2,
                                    settings={**FEW, "evaluation_episodes": 1, "evaluation_jitter": 0})
        self.assertNotEqual(official.fitness, once.fitness)
        with tempfile.TemporaryDirectory() as folder:
            policy, rollout = Path(folder, "walk.policy.h5"), Path(folder, "walk.rollout.h5")
            official.save(policy)
            official.rollout(rollout)
            self.assertEqual(sorted(os.listdir(folder)), ["walk.policy.h5", "walk.rollout.h5"])

            def ended(name, *words):
                return subprocess.run([evo_robots.find_tool(name), *words], capture_output=True, text=True)

            self.assertRegex(tool("evo-inspect", policy), "on Walk, 2048(?s:.*)perturbed .*8 episodes")
            self.assertAlmostEqual(official.final["mean"], official.fitness, delta=0.3 * abs(official.fitness))
            tool("evo-inspect", "--check", "--replay", folder)
            for picture in (["--strip", "4", "-o", f"{folder}/strip.svg"], ["-o", f"{folder}/film.gif"]):
                self.assertEqual(ended("evo-render", rollout, "--size", "160x90", *picture).stderr, "")
            refused = ended("evo-eval", "--policy", policy, policy)
            self.assertEqual(refused.returncode, 65)
            self.assertRegex(refused.stderr, "^evo-eval: .* is of Walk, a task in Python .*--rollout.*\n$")
            # Another policy's episode, and that of another robot.
            Trained.read(policy).rollout(rollout, Fast)
            self.assertEqual(ended("evo-inspect", "--check", "--replay", folder).returncode, 65)
            self.assertEqual(len(Trained.read(policy).video(Walk)), 251)
            self.assertEqual(len(Trained.read(policy).video(careful(folder))), 1 + 500 * 5 // 2)

    def test_a_task_of_the_suite_is_trained_as_evo_train_does(self):
        seen = []
        trained = evo_robots.train("Walker-v0", WALKER, steps=2048, seed=3, settings=FEW, progress=seen.append)
        self.assertEqual(seen[-1], 2048)
        with tempfile.TemporaryDirectory() as folder:
            robot = Path(folder, "robot.json")
            robot.write_text(json.dumps(evo_robots.robot_document(WALKER)))
            said = tool("evo-train", robot, "--task", "Walker-v0", "--steps", 2048, "--seed", 3, "--out-dir", folder,
                        *FEW_OPTIONS.split())
            self.assertEqual(json.loads(said)["fitness"], trained.fitness)

    def test_ctrl_c_ends_a_training(self):
        def interrupt(step):
            signal.raise_signal(signal.SIGINT)

        for task in ("Walker-v0", Walk):
            with self.assertRaises(KeyboardInterrupt):
                evo_robots.train(task, WALKER, steps=100_000, settings=FEW, progress=interrupt)

    def test_ctrl_c_from_another_process(self):
        """Wherever the training is, in the library or on its way into Python; in every Python."""
        program = ("import evo_robots, numpy\n"
                   f"body = numpy.array({WALKER.tolist()})\n"
                   "print('begun', flush=True)\n"
                   "evo_robots.train('Walker-v0', body, steps=10**9, settings={'rollout': 8})")
        folders = [*map(Path, os.get_exec_path()), *Path.home().glob(".pyenv/versions/*/bin")]
        others = {str(python) for folder in folders for python in folder.glob("python3.[0-9]*")
                  if python.name.removeprefix("python3.").isdigit() and not python.samefile(sys.executable)}
        for python, pause in [*((sys.executable, pause) for pause in (0.3, 0.5, 0.7)),
                              *((python, 0.4) for python in sorted(others))]:
            with self.subTest(python):
                if subprocess.run([python, "-c", "import numpy, sys; sys.exit(sys.version_info < (3, 9))"],
                                  stderr=subprocess.DEVNULL).returncode:
                    self.skipTest(f"{python} has no numpy, or is older than 3.9")
                self.interrupt(python, program, pause)

    def interrupt(self, python, program, pause):
        with subprocess.Popen([python, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as running:
            running.stdout.readline()
            time.sleep(pause)
            running.send_signal(signal.SIGINT)
            try:
                said = running.communicate(timeout=20)[1]
            except subprocess.TimeoutExpired:
                running.kill()
                raise
            self.assertEqual(running.returncode, -signal.SIGINT, said)
            self.assertTrue(said.rstrip().endswith("KeyboardInterrupt"), said)
            self.assertNotIn("ignored", said)

    def test_what_makes_no_sense_is_refused(self):
        class Wild(Walk):
            def reward(self, before, now, actions):
                return np.full(len(now.steps), np.nan)

        for wrong, message in (
                (lambda: evo_robots.train(Walk, WALKER, settings={"gama": 1}), "gamma"),
                (lambda: evo_robots.train(Walk, WALKER, profile="sequence"), "ppo"),
                (lambda: evo_robots.train(Walk, WALKER, steps=1), "less than one rollout"),
                (lambda: evo_robots.train(Wild, WALKER, steps=1024, settings=FEW), "finite"),
                (lambda: evo_robots.train("Walkr-v0", WALKER), "Walker-v0")):
            with self.assertRaisesRegex(EvoError, message):
                wrong()
        with self.assertRaises(TypeError):
            evo_robots.train(Walk, WALKER, physics="paper")

    def test_numbers_of_a_training_are_not_cut(self):
        for wrong in ({"steps": (1 << 64) + 2048}, {"seed": (1 << 64) + 3}, {"seed": -1},
                      {"steps": 1 << 70}, {"steps": 2048.5}, {"steps": "2048"}, {"steps": 0}):
            with self.assertRaisesRegex(ValueError, f"{[*wrong][0]}: .* is not"):
                evo_robots.train("Walker-v0", WALKER, **wrong)
        with self.assertRaisesRegex(ValueError, "NUL"):
            evo_robots.train("Walker-v0", WALKER, profile="default\0x")

    def test_in_a_pipeline(self):
        with tempfile.TemporaryDirectory() as folder:
            Path(folder, "walk.py").write_text(WALK)
            command = [sys.executable, "-m", "evo_robots", f"{folder}/walk.py:Walk", "--steps", "512", "--out-dir",
                       folder, *FEW_OPTIONS.split()]
            robots = tool("evo-sample", "-n", 2, "--seed", 1)
            said = subprocess.run(command, input=robots, capture_output=True, text=True, check=True).stdout
            found = [json.loads(line) for line in said.splitlines()]
            self.assertEqual([robot["id"] for robot in found],
                             [json.loads(line)["id"] for line in robots.splitlines()])
            for robot in found:
                self.assertTrue(np.isfinite(robot["fitness"]) and os.path.exists(robot["policy"]))
                self.assertIn("eval/best", Path(folder, f"{robot['id']}.log").read_text())
                self.assertEqual([*robot["final"]], ["episodes", "mean", "standard_error"])
            command[3] = f"{folder}/walk.py:Run"
            said = subprocess.run(command, input=robots, capture_output=True, text=True)
            self.assertEqual(said.returncode, 2)
            self.assertRegex(said.stderr, "^evo_robots: .*no evo_robots.Task; there are: Walk\n$")


if __name__ == "__main__":
    unittest.main()
