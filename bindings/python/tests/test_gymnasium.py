"""Gymnasium's interface; needs gymnasium."""
import copy
import functools
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import warnings
from pathlib import Path

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import evo_robots
from evo_robots import EvoError
from evo_robots.environment import Environment
import test_own
from common import SMALL, WALKER, tool


class One(unittest.TestCase):
    def test_gymnasium_finds_nothing_wrong(self):
        for task in ("Walker-v0", "Catcher-v0", "BidirectionalWalker-v0"):
            env = gymnasium.make("evo/" + task, body=SMALL, render_mode="rgb_array")
            # The benchmark's bounds.
            self.assertEqual((env.action_space.low.min(), env.action_space.high.max()), (0.6, 1.6))
            self.assertEqual((env.observation_space.low.min(), env.observation_space.dtype), (-100, np.float64))
            with warnings.catch_warnings(record=True) as said:
                warnings.simplefilter("always")
                check_env(env.unwrapped)
            complaints = [str(w.message) for w in said]
            # Bounds of actions are the benchmark's, not [-1, 1], which is asked of networks.
            self.assertEqual([c for c in complaints if "normalized" not in c and
                              "symmetric" not in c], [])
            env.close()
        for task in evo_robots.TASKS:
            self.assertIn("evo/" + task, gymnasium.registry)

    def test_a_time_limit_of_ones_own(self):
        def steps(env):
            env.reset(seed=0)
            for step in range(1, 1000):
                if env.step(np.ones(4))[3]:
                    break
            env.close()
            return step
        self.assertEqual(steps(gymnasium.make("evo/Walker-v0", body=SMALL, max_episode_steps=7)), 7)
        self.assertEqual(
            steps(gymnasium.make("evo/Walker-v0", body=SMALL, max_episode_steps=600)), 600)
        self.assertEqual(
            steps(gymnasium.make("evo/Walker-v0", body=SMALL, max_episode_steps=-1)), 999)
        self.assertEqual(steps(Environment("Walker-v0", SMALL)), 500)
        self.assertEqual(steps(Environment("Walker-v0", SMALL, max_episode_steps=8)), 8)
        for limit, expected in ((5, 5), (600, 600), (None, 500)):
            arguments = {} if limit is None else {"max_episode_steps": limit}
            envs = gymnasium.make_vec("evo/Walker-v0", num_envs=2, body=SMALL, **arguments)
            envs.reset(seed=0)
            ends = [t for t in range(1, 2 * expected + 2) if envs.step(np.ones((2, 4)))[3].all()]
            self.assertEqual(ends, [expected, 2 * expected + 1])  # a step begins the next episode
            envs.close()

    def test_what_makes_no_sense_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            two = Path(folder, "two.txt")
            two.write_text("HV\n\nVH\n")
            for arguments, message in (({}, "give a body"), ({"robot": two}, "one robot is expected, not 2"),
                                       ({"body": str(two)}, "^a body is a matrix"), ({"body": [[3, 4], [3]]}, "^a body is a matrix"),
                                       ({"body": [3, 4], "connections": [0, 1]}, "^a body is a matrix"),
                                       ({"body": SMALL, "render_mode": "ansi"}, "'ansi' is not 'rgb_array'")):
                for make in (gymnasium.make, gymnasium.make_vec):
                    with self.assertRaisesRegex(ValueError, message):
                        make("evo/Walker-v0", **arguments)
        env = Environment("Carrier-v0", SMALL)
        with self.assertRaisesRegex(ValueError, "'box'.*robot.*package|'box'.*package.*robot"):
            env.object_pos_at_time("box")
        with self.assertRaisesRegex(ValueError, "max_episode_steps"):
            Environment("Walker-v0", SMALL, max_episode_steps=0)

    def test_environments_in_processes_of_their_own(self):
        for context in ("fork", "spawn"):
            envs = gymnasium.vector.AsyncVectorEnv(
                [functools.partial(gymnasium.make, "evo_robots:evo/Walker-v0", body=SMALL)] * 2, context=context)
            observations, _ = envs.reset(seed=1)
            one = gymnasium.make("evo/Walker-v0", body=SMALL)
            np.testing.assert_array_equal(observations[0], one.reset(seed=1)[0])
            envs.close()

    @unittest.skipUnless(shutil.which("ffmpeg"), "videos need ffmpeg")
    def test_an_episode_is_a_video(self):
        env = gymnasium.make("evo/Walker-v0", body=WALKER).unwrapped
        with self.assertRaisesRegex(ValueError, "reset"):
            env.video()
        env.reset(seed=0)
        for _ in range(10):
            env.step(np.full(13, 1.5))
        self.assertRegex(repr(env), "Walker-v0, robot 0e0f80c736de, step 10, return")
        video = env.video(160, 80)
        self.assertEqual((len(video), video[0].shape), (6, (80, 160, 3)))
        self.assertFalse(np.array_equal(video[0], video[5]))
        np.testing.assert_array_equal(video[5], env.simulator.picture(0, 160, 80))
        self.assertIn('src="data:video/mp4;base64,', video._repr_html_())
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(ValueError, "ends in .mp4"):
                video.save(Path(folder, "walk.avi"))
            video.save(Path(folder, "walk.gif"))
            self.assertEqual([p.name for p in Path(folder).iterdir()], ["walk.gif"])
            seen = subprocess.run(
                ["ffmpeg", "-loglevel", "error", "-i", Path(folder, "walk.gif"), "-f", "rawvideo",
                 "-pix_fmt", "rgb24", "-"], capture_output=True, check=True).stdout
            frames = np.frombuffer(seen, np.uint8).reshape(-1, 80, 160, 3)
            self.assertEqual(len(frames), 6)
            self.assertLess(np.abs(frames[0].astype(int) - video[0]).mean(), 4)
        env.close()

    def test_settings_reach_the_simulator(self):
        def after(**arguments):
            env = gymnasium.make("evo/Walker-v0", body=WALKER, **arguments)
            env.reset(seed=0)
            for _ in range(10):
                observation = env.step(np.full(13, 1.3))[0]
            env.close()
            return observation
        plain = after()
        for changed in ({"settings": {"gravity": 50}}, {"settings": {"min_target": 1.7, "max_target": 1.8}},
                        {"jitter": 1e-3}):
            self.assertFalse(np.array_equal(plain, after(**changed)), changed)


class Many(unittest.TestCase):
    def test_a_batch_is_the_environments_one_by_one(self):
        rng = np.random.default_rng(0)
        envs = gymnasium.make_vec("evo/Catcher-v0", num_envs=3, body=SMALL)
        observations, _ = envs.reset(seed=5)
        actions = rng.uniform(0.6, 1.6, (30, 3, 4))
        many = [observations] + [envs.step(a)[0] for a in actions]
        self.assertIsInstance(envs.unwrapped, evo_robots.vector.VectorEnvironment)
        for e in range(3):
            env = gymnasium.make("evo/Catcher-v0", body=SMALL)
            observation, _ = env.reset(seed=5, options={"episode": e})
            alone = [observation] + [env.step(a[e])[0] for a in actions]
            np.testing.assert_array_equal([m[e] for m in many], alone)
            env.close()
        envs.close()

    def test_a_task_file_everywhere_to_the_bit(self):
        """With held actions, a cost of steps, and rewards of actions; in evo-eval, too."""
        with tempfile.TemporaryDirectory() as folder:
            task = test_own.careful(folder)
            arguments = {"task": task, "body": WALKER, "stiffness": np.linspace(0.5, 2, 25).reshape(5, 5)}
            sims = evo_robots.Simulator(task, WALKER, stiffness=arguments["stiffness"])
            env = gymnasium.make("evo/file", **arguments)
            envs = gymnasium.make_vec("evo/file", num_envs=2, max_episode_steps=40, **arguments)
            sims.reset(seed=3), env.reset(seed=3), envs.reset(seed=3)
            actions = np.random.default_rng(0).uniform(0.6, 1.6, (40, 13))
            total = 0.0
            for action in actions:
                wanted = sims.step(action[None]).rewards[0]
                total += wanted
                self.assertEqual(env.step(action)[1], wanted)
                _, rewards, _, truncated, _ = envs.step(np.stack([action, action]))
                self.assertEqual(rewards.tolist(), [wanted] * 2)
            self.assertEqual(truncated.tolist(), [True, True])
            robot = Path(folder, "robot.json")
            robot.write_text(json.dumps(sims._made["robots"][0]))
            np.save(Path(folder, "actions.npy"), actions)
            said = json.loads(tool("evo-eval", robot, "--task", task, "--actions", f"{folder}/actions.npy",
                                   "--max-steps", 40, "--seed", 3))
            self.assertEqual(said["returns"], [total])
            self.assertEqual(copy.deepcopy(env.unwrapped).step(actions[0])[1], env.step(actions[0])[1])
            plain = gymnasium.make("evo/Walker-v0", body=WALKER)
            self.assertNotEqual(plain.unwrapped.simulator.info["robots"], sims.info["robots"])
            with self.assertRaisesRegex(EvoError, "5 rows|5 factors"):
                gymnasium.make("evo/Walker-v0", body=WALKER, stiffness=[[1.0]])

    def test_autoreset_in_the_next_step_or_in_the_same(self):
        for mode in (AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP):
            envs = gymnasium.make_vec("evo/Walker-v0", num_envs=2, body=SMALL, max_episode_steps=5,
                                      autoreset_mode=mode)
            start, _ = envs.reset(seed=0)
            for _ in range(5):
                observations, _, _, truncated, infos = envs.step(np.ones((2, 4)))
            self.assertTrue(truncated.all())
            if mode == AutoresetMode.SAME_STEP:
                self.assertFalse(np.array_equal(infos["final_obs"][0], start[0]))
            else:
                observations, rewards, _, truncated, _ = envs.step(np.ones((2, 4)))
                self.assertEqual((rewards.tolist(), truncated.tolist()), ([0, 0], [False, False]))
            np.testing.assert_array_equal(observations, start)
            envs.close()

    def test_a_seed_for_each(self):
        made = gymnasium.make_vec("evo/Catcher-v0", num_envs=3, body=SMALL)
        seen = made.reset(seed=[4, 5, 6])[0]
        for e, seed in enumerate((4, 5, 6)):
            alone = gymnasium.make("evo/Catcher-v0", body=SMALL).reset(seed=seed)[0]
            np.testing.assert_array_equal(seen[e], alone)
        for wrong in ([1], [1, 2, 3.5]):
            with self.assertRaisesRegex(ValueError, "seed"):
                made.reset(seed=wrong)

    def test_a_refusal_is_one_error(self):
        said = subprocess.run(
            [sys.executable, "-c", "import evo_robots, gymnasium\n"
             "gymnasium.make_vec('evo/Walker-v0', num_envs=2, robot='none.json')"],
            capture_output=True, text=True)
        self.assertNotIn("ignored", said.stderr)
        self.assertIn("none.json", said.stderr)

    def test_some_of_them_reset(self):
        envs = gymnasium.make_vec("evo/Walker-v0", num_envs=3, body=SMALL,
                                  autoreset_mode=AutoresetMode.DISABLED)
        start, _ = envs.reset(seed=0)
        moved = envs.step(np.full((3, 4), 1.5))[0]
        observations, _ = envs.reset(options={"reset_mask": np.array([False, True, False])})
        np.testing.assert_array_equal(observations[1], start[1])
        np.testing.assert_array_equal(observations[[0, 2]], moved[[0, 2]])
        with self.assertRaisesRegex(ValueError, "mask"):
            envs.reset(options={"reset_mask": np.array([1])})
        envs.close()


class OwnTask(unittest.TestCase):
    """A task as the benchmark's tutorial writes one, by its names."""

    def test_a_task_of_ones_own_is_an_environment(self):
        from evo_robots.evogym import EvoWorld
        from evo_robots.evogym.envs import EvoGymBase

        class Walk(EvoGymBase):
            def __init__(self):
                world = EvoWorld()
                world.add_from_array("ground", np.full((1, 100), 5), 0, 0)
                world.add_from_array("robot", WALKER, 1, 1)
                super().__init__(world)
                size = self.observe().size
                self.action_space = gymnasium.spaces.Box(
                    0.6, 1.6, (self.get_dim_action_space("robot"),), np.float64)
                self.observation_space = gymnasium.spaces.Box(-1e4, 1e4, (size,), np.float64)

            def observe(self):
                return np.concatenate([
                    self.get_vel_com_obs("robot"), self.get_ort_obs("robot"),
                    self.get_relative_pos_obs("robot"),
                    self.get_floor_obs("robot", ["ground"], 3), self.get_ceil_obs("robot", ["ground"], 1)])

            def reset(self, *, seed=None, options=None):
                gymnasium.Env.reset(self, seed=seed)
                super().reset()
                return self.observe(), {}

            def step(self, action):
                before = self.get_pos_com_obs("robot")
                done = super().step({"robot": action})
                gained = self.get_pos_com_obs("robot")[0] - before[0]
                return self.observe(), gained, done, False, {}

        env = Walk()
        observation, _ = env.reset(seed=1)
        # Its centre is between two columns: corners of the ground on their edges are in neither.
        self.assertAlmostEqual(observation[-10:-3].min(), env.get_pos_com_obs("robot")[1] - 1)
        self.assertEqual(observation[-3:].tolist(), [5.0] * 3)  # no ceiling
        check_env(env, skip_render_check=True)
        # The world of the benchmark's own environment, built by hand.
        other = gymnasium.make("evo/Walker-v0", body=WALKER).unwrapped
        env.reset()
        other.reset()
        actions = np.random.default_rng(3).uniform(0.6, 1.6, (30, env.action_space.shape[0]))
        for action in actions:
            env.step(action)
            other.step(action)
        np.testing.assert_allclose(env.object_pos_at_time(env.get_time(), "robot") * 0.1,
                                   other.object_pos_at_time("robot"), rtol=0, atol=1e-14)
        other.close()
        env.close()


class OwnBatch(unittest.TestCase):
    """evo_robots.Task for Gymnasium."""

    class Short(test_own.Walk):
        steps = 20

    def test_one(self):
        env = self.Short().env(SMALL, render_mode="rgb_array")
        check_env(env)
        env.reset()
        ends = [env.step(np.ones(4))[2:4] for _ in range(20)]
        self.assertEqual((ends[-1], set(ends[:-1])), ((False, True), {(False, False)}))
        self.assertEqual(len(env.video(120, 60, fps=50)), 21)

    def test_many(self):
        envs = self.Short().vector_env(SMALL, 3)
        start, _ = envs.reset(seed=1)
        for t in range(20):
            observations, rewards, terminated, truncated, _ = envs.step(np.full((3, 4), 1.4))
        self.assertTrue(truncated.all())
        observations, rewards, _, truncated, _ = envs.step(np.full((3, 4), 1.4))
        np.testing.assert_array_equal(observations, start)
        self.assertEqual((rewards.tolist(), truncated.tolist()), ([0] * 3, [False] * 3))


class Benchmark(unittest.TestCase):
    """The benchmark's 32 environments by its names."""

    def test_they_are_the_tasks(self):
        from evo_robots.evogym import envs

        self.assertEqual(sorted(envs.CLASSES), sorted(evo_robots.TASKS))
        rng = np.random.default_rng(0)
        actions = rng.uniform(0.6, 1.6, (20, 13))
        for name, kind in envs.CLASSES.items():
            env = gymnasium.make(name, body=WALKER)
            self.assertIs(type(env.unwrapped), kind)
            random.seed(7)
            observation, _ = env.reset(seed=1)
            random.seed(7)
            draws = kind._draws(env.unwrapped)
            twin = evo_robots.Simulator(name, WALKER)
            seen = twin.reset(draws=draws)
            np.testing.assert_array_equal(observation, seen.observations[0])
            for action in actions:
                observation, reward, terminated, _, _ = env.step(action)
                seen = twin.step(action)
                np.testing.assert_array_equal(observation, seen.observations[0])
                self.assertEqual((reward, terminated), (seen.rewards[0], bool(seen.terminated[0])))
                if terminated:
                    break
            base = env.unwrapped
            np.testing.assert_allclose(base.object_pos_at_time(base.get_time(), "robot"),
                                       twin.positions[0, twin.objects()["robot"]].T, rtol=1e-15)
            self.assertTrue(np.isfinite(base.get_ort_obs("robot")).all())
            env.close()

    def test_rewards_by_the_benchmarks_methods_and_worlds_are_those_of_the_simulator(self):
        from evo_robots.evogym import EvoSim, EvoWorld, envs

        rng = np.random.default_rng(0)
        asked = set()
        for name, kind in envs.CLASSES.items():
            env = kind(WALKER)
            env.reset()
            # The world is the one that is simulated.
            sim = EvoSim(env.world)
            for thing in env.world.objects:
                np.testing.assert_allclose(sim.object_pos_at_time(0, thing),
                                           env.sim.object_pos_at_time(0, thing), atol=1e-12)
            packages = ("package", "robot") if issubclass(kind, envs.PackageBase) else ("robot",)
            method, *things = kind.REWARD or ("get_reward", *packages)
            if not hasattr(env, method):
                continue
            asked.add(name)
            for t in range(20):
                before = [env.object_pos_at_time(t, thing) for thing in things]
                _, reward, ended, _, _ = env.step(rng.uniform(0.6, 1.6, 13))
                if ended:
                    break
                now = [env.object_pos_at_time(t + 1, thing) for thing in things]
                moments = [at for pair in zip(before, now) for at in pair]
                if name == "BidirectionalWalker-v0":
                    moments = [dict(zip(("robot_com_pos_initial", "robot_com_pos_final"), moments))]
                found = getattr(env, method)(*moments)
                self.assertAlmostEqual(found[0] if isinstance(found, tuple) else found, reward, delta=1e-13)
        self.assertEqual(len(asked), 24)
        self.assertEqual(EvoWorld.from_json(f"{envs.BenchmarkBase.DATA_PATH}/package.json").grid_size.x, 3)

    def test_classes_of_ones_own_over_the_benchmarks(self):
        from evo_robots.evogym import EvoWorld, envs

        class Lazy(envs.CarrySmallRect):
            def get_reward_carry(self, *moments):
                return super().get_reward_carry(*moments) + 100

        class Stairs(envs.StairsBase):
            sight_dist = 5

        lazy, plain = Lazy(WALKER), envs.CarrySmallRect(WALKER)
        for env in (lazy, plain):
            env.reset()
        action = np.full(13, 1.2)
        self.assertAlmostEqual(lazy.step(action)[1] - plain.step(action)[1], 100)
        world = EvoWorld.from_json(f"{Stairs.DATA_PATH}/UpStepper-v0.json")
        world.add_from_array("robot", WALKER, 1, 1)
        np.testing.assert_allclose(Stairs(world).reset()[0], envs.StepsUp(WALKER).reset()[0], atol=1e-12)
        walk = envs.BiWalk(WALKER)
        walk.init_reward_goals([envs.WalkToX(40), envs.WalkToX(22)])
        self.assertEqual(([goal.x_goal for goal in walk.goals], walk.current_goal), ([40, 22], 0))
        walk.sim.translate_object(0.5, 0, "robot")
        moved = walk.get_pos_com_obs("robot")[0]
        walk.step(action)
        walk.sim.revert(0)
        self.assertEqual(walk.get_pos_com_obs("robot")[0], moved)

    def test_pictures_off_screen_and_a_clear_line_without_a_display(self):
        import evo_robots.evogym.envs  # noqa: F401
        from evo_robots.evogym import EvoSim, EvoViewer, EvoWorld

        for mode in ("img", "rgb_array"):
            env = gymnasium.make("Carrier-v0", body=SMALL, render_mode=mode, render_options={"hide_grid": True})
            env.reset()
            picture = env.render()
            self.assertEqual((picture.shape, picture.dtype), ((600, 1200, 3), np.uint8))
            env.close()
        with self.assertRaisesRegex(ValueError, "none of screen"):
            gymnasium.make("Carrier-v0", body=SMALL, render_mode="ansi")
        world = EvoWorld()
        world.add_from_array("ground", np.full((1, 60), 5), 0, 0)
        world.add_from_array("robot", SMALL, 3, 1)
        sim = EvoSim(world)
        viewer = EvoViewer(sim, resolution=(200, 100))
        white = viewer.render("img", hide_background=True, hide_grid=True, hide_edges=True, hide_voxels=True)
        self.assertTrue((white == 255).all())
        viewer.track_objects("robot")
        viewer.set_tracking_settings(lock_width=20.0, padding=(2, 2))
        self.assertEqual(viewer.render("img").shape, (100, 200, 3))
        self.assertEqual(viewer.view_size[0], 20.0)
        for wrong in ({"lock_x": True}, {"colour": 1}):
            with self.assertRaises(ValueError):
                viewer.set_tracking_settings(**wrong)
        sim.step()
        self.assertEqual(len(viewer.video(120, 60)), 2)
        display = os.environ.pop("DISPLAY", None)
        try:
            with self.assertRaisesRegex(EvoError, "DISPLAY is not set"):
                viewer.render("screen")
        finally:
            if display is not None:
                os.environ["DISPLAY"] = display

    def test_a_program_of_the_benchmark_runs_unchanged(self):
        program = """
import multiprocessing, os, sys
import gymnasium as gym
import numpy as np
import evogym.envs
from evogym import EvoWorld, WorldObject, EvoSim, EvoViewer, sample_robot
from evogym.utils import hashable, VOXEL_TYPES
from evogym.envs.walk import WalkingFlat
from evogym.envs import BenchmarkBase, EvoGymBase

def shape(_):
    body, connections = sample_robot((3, 3))
    env = gym.make("Walker-v0", body=body, connections=connections)
    return env.reset()[0].shape[0] > 0

if __name__ == "__main__":
    assert issubclass(WalkingFlat, BenchmarkBase) and issubclass(BenchmarkBase, EvoGymBase)
    assert sys.argv[1:] == ["--steps", "3"], sys.argv
    assert os.path.isabs(__file__), __file__
    for context in ("fork", "spawn"):
        with multiprocessing.get_context(context).Pool(2) as pool:
            assert pool.map(shape, range(2)) == [True, True]
    print("ran")
"""
        with tempfile.TemporaryDirectory() as folder:
            script = Path(folder, "script.py")
            script.write_text(program)
            said = subprocess.run([sys.executable, "-m", "evo_robots.evogym", script.name, "--steps", "3"],
                                  capture_output=True, text=True, cwd=folder)
            self.assertEqual((said.stdout, said.returncode), ("ran\n", 0), said.stderr)
            missing = subprocess.run([sys.executable, "-m", "evo_robots.evogym", "no.py"],
                                     capture_output=True, text=True)
            self.assertRegex(missing.stderr, "there is no file no.py")
            self.assertEqual(missing.returncode, 1)


class BenchmarksNames(unittest.TestCase):
    """Programs for the benchmark's package, each in a process of its own."""

    def run_program(self, program, *arguments):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder, "program.py")
            file.write_text(program)
            return subprocess.run([sys.executable, "-W", "ignore", "-m", "evo_robots.evogym", file, *arguments],
                                  capture_output=True, text=True)

    def test_every_name_of_every_module(self):
        """evogym_names.txt: modules of evogym 2.0.0, their public names, and the methods of classes."""
        said = self.run_program(
            "import importlib, sys\n"
            "for line in open(sys.argv[1]):\n"
            "    module, *names = line.split()\n"
            "    found, star = importlib.import_module(module), {}\n"
            "    exec(f'from {module} import *', star)\n"
            "    for name, methods in (n.partition(':')[::2] for n in names):\n"
            "        lacks = name not in star and [name] or [m for m in methods.split(',')\n"
            "                                                if m and not hasattr(star[name], m)]\n"
            "        print(*[f'{module} {name} {what}' for what in lacks], sep='\\n', end='')\n",
            Path(__file__).parent / "evogym_names.txt")
        self.assertEqual((said.stdout, said.stderr), ("", ""))

    def test_actions_of_single_precision(self):
        """float32.tsv is what float32.py prints with evogym 2.0.0 (but for its version)."""
        here = Path(__file__).parent
        self.assertEqual(self.run_program((here / "float32.py").read_text()).stdout, (here / "float32.tsv").read_text())

    def test_the_old_gym_is_a_line_that_says_the_way(self):
        said = self.run_program("import gym\n")
        self.assertIn("import gymnasium as gym", said.stderr.splitlines()[-1])

    def test_programs_as_options_and_from_standard_input(self):
        for arguments, program in ((["-c", "import evogym, sys; print(evogym.EvoSim.__name__, sys.argv)", "a"], ""),
                                   (["-", "a"], "import evogym, sys; print(evogym.EvoSim.__name__, sys.argv)")):
            said = subprocess.run([sys.executable, "-m", "evo_robots.evogym", *arguments], input=program,
                                  capture_output=True, text=True)
            self.assertEqual(said.stdout, f"EvoSim ['{arguments[0]}', 'a']\n", said.stderr)

    def test_what_would_be_half_heard_is_refused(self):
        from evo_robots.evogym.envs import CarrySmallRect, WalkingFlat

        for parent, name in ((WalkingFlat, "get_relative_pos_obs"), (WalkingFlat, "VOXEL_SIZE"),
                             (WalkingFlat, "world"), (CarrySmallRect, "thresh_height"),
                             (CarrySmallRect, "get_obs")):
            with self.assertRaisesRegex(TypeError, f"overrides {name}, which"):
                type("Own", (parent,), {name: None})
        type("Own", (WalkingFlat,), {"step": None, "reset": None, "get_relative_pos_obs": None})
        with self.assertRaisesRegex(AttributeError, "sight_dist of Walker-v0"):
            WalkingFlat(body=SMALL).sight_dist = 3


class Readme(unittest.TestCase):
    def test_what_the_readme_shows_runs(self):
        text = (Path(__file__).parents[1] / "README.md").read_text()
        blocks = [b for b in re.findall(r"```python\n(.*?)```", text, re.S)
                  if "stable_baselines3" not in b]
        self.assertEqual(len(blocks), 7)
        for first, last in (0, 2), (2, 3), (3, 4), (4, 6), (6, 7):  # some continue from others
            subprocess.run([sys.executable, "-c", "\n".join(blocks[first:last])], check=True)


if __name__ == "__main__":
    unittest.main()
