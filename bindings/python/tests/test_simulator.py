"""Environments without Gymnasium."""
import copy
import hashlib
import json
import pickle
import signal
import tempfile
import threading
import unittest
from pathlib import Path

import h5py
import numpy as np

import evo_robots
from common import SMALL, WALKER, tool
from evo_robots import EvoError, Simulator


class Bodies(unittest.TestCase):
    def test_connectivity_as_the_benchmark_lists_it(self):
        found = evo_robots.get_full_connectivity(np.array([[1, 3], [0, 4]]))
        np.testing.assert_array_equal(found, [[0, 1], [1, 3]])
        self.assertEqual(evo_robots.get_full_connectivity(np.array([[3]])).shape, (2, 0))

    def test_validity(self):
        self.assertTrue(evo_robots.is_connected(WALKER))
        self.assertFalse(evo_robots.is_connected(np.array([[1, 0], [0, 1]])))
        self.assertFalse(evo_robots.is_connected(np.zeros((2, 2))))
        self.assertFalse(evo_robots.has_actuator(np.ones((2, 2))))

    def test_samples_are_valid_and_follow_the_generator(self):
        for seed in range(20):
            body, links = evo_robots.sample_robot((4, 5), rng=np.random.default_rng(seed))
            again, _ = evo_robots.sample_robot((4, 5), rng=np.random.default_rng(seed))
            self.assertTrue(evo_robots.is_connected(body) and evo_robots.has_actuator(body))
            np.testing.assert_array_equal(body, again)
            back, back_links = evo_robots.robot_arrays(evo_robots.robot_document((body, links)))
            np.testing.assert_array_equal(body, back)
            self.assertEqual(links.shape, back_links.shape)
        for shape, pd in (((2, 2), [1, 1, 1, 0, 0]), ((2, 2), [1, np.nan, 1, 1, 1]), ((0, 0), None),
                          ((2, 0), None), ((-1, 3), None), ((3,), None)):
            with self.assertRaises(ValueError):
                evo_robots.sample_robot(shape, pd=pd)

    def test_sampling_what_is_hardly_ever_connected_ends(self):
        with self.assertRaisesRegex(ValueError, "20x20 cells; with 43% empty"):
            evo_robots.sample_robot((20, 20))

    def test_connections_of_another_shape_are_refused(self):
        links = evo_robots.get_full_connectivity(WALKER)
        for wrong in (links.T, links.ravel(), links[None], [[0, 1]], [[0], [7]], [[15], [16]]):
            with self.assertRaisesRegex(ValueError, "connections"):
                evo_robots.robot_document((WALKER, wrong))
        none = evo_robots.robot_document((np.array([[3]]), np.zeros((2, 0))))
        self.assertEqual(none["connections"], [])
        document = evo_robots.robot_document((WALKER, links))
        benchmarks = {**document, "connections": links.tolist()}
        np.testing.assert_array_equal(evo_robots.robot_arrays(benchmarks)[1], links)

    def test_task_names_are_those_of_the_tools(self):
        self.assertEqual(sorted(evo_robots.TASKS), sorted(tool("evo-data", "--names", "tasks").split()))
        for name, limit in evo_robots.TASKS.items():
            with Simulator(name, WALKER) as simulator:
                self.assertEqual(simulator.info["episode_steps"], limit)


class Stepping(unittest.TestCase):
    def test_actions_of_single_precision_are_those_of_the_benchmark_in_files_as_well(self):
        """The positions of float32.tsv, by evo-eval and by the simulator."""
        table = Path(__file__).with_name("float32.tsv").read_text().splitlines()
        steps, wanted = next(line.split("\t")[1:3] for line in table if line.startswith("Walker-v0\t"))
        actions = np.random.default_rng(1).uniform(0, 2.2, (int(steps), 13)).astype(np.float32)

        def digest(positions):
            xy = np.transpose(positions, (0, 2, 1)) / 0.1 * 0.1  # [steps, 2, points], kept in voxels there
            return hashlib.sha256(np.ascontiguousarray(xy).tobytes()).hexdigest()[:16]

        with Simulator("Walker-v0", WALKER) as simulator:
            robot = simulator.objects()["robot"]
            simulator.reset()
            seen = []
            for action in actions:
                simulator.step(action)
                seen.append(simulator.positions[0, robot].copy())
        self.assertEqual(digest(seen), wanted)
        with tempfile.TemporaryDirectory() as folder:
            np.save(f"{folder}/actions.npy", actions)
            np.savez(f"{folder}/actions.npz", actions=actions)
            with h5py.File(f"{folder}/actions.h5", "w") as file:
                file["actions"] = actions
            Path(folder, "robot.json").write_text(json.dumps(evo_robots.robot_document(WALKER)))
            for kind in ("npy", "npz", "h5"):
                tool("evo-eval", "--task", "Walker-v0", "--actions", f"{folder}/actions.{kind}",
                     "--rollout", f"{folder}/rollout.h5", f"{folder}/robot.json")
                with h5py.File(f"{folder}/rollout.h5") as file:
                    positions = file["episode_0/infos/positions"][1:, robot]
                self.assertEqual(digest(positions), wanted, kind)

    def test_many_are_each_as_alone_and_masked_ones_stay(self):
        rng = np.random.default_rng(2)
        actions = rng.uniform(0.6, 1.6, (20, 5, 13))
        with Simulator("Walker-v0", WALKER, 5) as many, Simulator("Walker-v0", WALKER) as one:
            many.reset(seed=1, jitter=1e-3)
            for t in range(20):
                mask = np.arange(5) != t % 5
                before = many.step(actions[t], mask) if t == 0 else state
                state = many.step(actions[t], mask)
                np.testing.assert_array_equal(state.observations[t % 5],
                                              before.observations[t % 5])
            one.reset(seed=1, episode=3, jitter=1e-3)
            one.step(actions[0, 3])
            for t in range(20):
                if t % 5 != 3:
                    alone = one.step(actions[t, 3])
            np.testing.assert_array_equal(alone.observations[0], state.observations[3])

    def test_actions_and_masks_of_another_shape_are_refused(self):
        with Simulator("Walker-v0", WALKER, 3) as simulator:
            simulator.reset()
            actions = np.random.default_rng(0).uniform(0.6, 1.6, (3, 13))
            simulator.step(actions)
            simulator.step(actions.ravel())
            for wrong in (actions.T, actions[:, :, None], actions[:2], actions[0]):
                with self.assertRaisesRegex(ValueError, r"expected \(3, 13\) or \(39,\)"):
                    simulator.step(wrong)
            for mask in ([0, 2], True, [[1, 0, 1]], [1, 2, 0], [True]):
                with self.assertRaisesRegex(ValueError, "mask"):
                    simulator.step(actions, mask)

    def test_what_stands_for_one_robot(self):
        links = evo_robots.get_full_connectivity(WALKER)
        for robots, count in ((WALKER.tolist(), 1), (((3, 4), (4, 3)), 1), ((WALKER, links), 1),
                              ([WALKER, SMALL], 2), ([WALKER.tolist(), SMALL.tolist()], 2),
                              ([(WALKER, links), SMALL], 2), ([[3, 4]], 1)):
            with Simulator("Walker-v0", robots) as simulator:
                self.assertEqual(simulator.num_envs, count)
        with self.assertRaisesRegex(ValueError, "connections of shape"):
            Simulator("Walker-v0", (WALKER, links.T))

    def test_positions_and_pictures(self):
        with Simulator("Carrier-v0", WALKER) as simulator:
            simulator.reset()
            self.assertEqual(simulator.positions.shape, simulator.velocities.shape)
            package = simulator.objects()["package"]
            self.assertEqual(simulator.positions[0, package].shape[1], 2)
            at_start = simulator.picture(width=200, height=100)
            self.assertEqual((at_start.shape, at_start.dtype), ((100, 200, 3), np.uint8))
            self.assertGreater(len(np.unique(at_start.reshape(-1, 3), axis=0)), 5)
            for _ in range(30):
                simulator.step(np.full(13, 1.6))
            self.assertFalse(np.array_equal(at_start, simulator.picture(width=200, height=100)))
            closer = simulator.picture(width=200, height=100, window=(3, 3, 8, 4), hide=["grid"])
            self.assertFalse(np.array_equal(at_start, closer))
            for size in ({"width": 0}, {"height": 9999}, {"window": (0, 0, -1, 1)}):
                with self.assertRaises(EvoError):
                    simulator.picture(**size)


class States(unittest.TestCase):
    def test_an_episode_goes_on_from_a_state_to_the_same_bits(self):
        actions = np.random.default_rng(0).uniform(0.6, 1.6, (30, 3, 13))
        with Simulator("Catcher-v0", WALKER, 3) as simulator:
            simulator.reset(seed=4, jitter=1e-3)
            for action in actions[:10]:
                at_save = simulator.step(action)
            states = simulator.save()
            self.assertEqual(len(states), 3)
            went_on = [simulator.step(action) for action in actions[10:]]
            restored = simulator.restore(states)
            for name in ("observations", "rewards", "terminated", "truncated", "status"):
                np.testing.assert_array_equal(getattr(restored, name), getattr(at_save, name))
            for before, action in zip(went_on, actions[10:]):
                after = simulator.step(action)
                np.testing.assert_array_equal(after.observations, before.observations)
                np.testing.assert_array_equal(after.rewards, before.rewards)
            # One of them, into an environment of another process that was never reset.
            with Simulator("Catcher-v0", WALKER, 2) as other:
                other.restore(states[2:], [1])
                mask = np.array([False, True])
                for before, action in zip(went_on, actions[10:]):
                    after = other.step(action[[0, 2]], mask)
                    np.testing.assert_array_equal(after.observations[1], before.observations[2])

    def test_states_of_robots_of_several_sizes(self):
        with Simulator("Walker-v0", [WALKER, SMALL]) as simulator:
            self.assertEqual(simulator.action_lengths.tolist(), [13, 4])
            self.assertEqual(simulator.reset().observations.shape, (simulator.observation_lengths.sum(),))
            one, two = simulator.save()
            simulator.step(np.ones(17))
            start = simulator.restore([two, one], [1, 0])
            np.testing.assert_array_equal(start.observations, simulator.reset(seed=0).observations)
            with self.assertRaisesRegex(EvoError, "of another robot"):
                simulator.restore([two, one])

    def test_states_that_cannot_be_are_refused_and_nothing_changes(self):
        with Simulator("Walker-v0", SMALL, 2) as simulator, \
                Simulator("Walker-v0", SMALL, settings={"gravity": 50}) as other:
            with self.assertRaisesRegex(EvoError, "unreset"):
                simulator.save()
            start = simulator.reset()
            good = simulator.save()
            other.reset()
            for bad in (b"", good[0][:-1], good[0] + b"x", b"x" * len(good[0]),
                        good[0][:200] + bytes([good[0][200] ^ 1]) + good[0][201:], *other.save()):
                with self.assertRaisesRegex(EvoError, "damaged, or of another"):
                    simulator.restore([good[0], bad])
            for environments in ([0], [0, 2], [0, -1]):
                with self.assertRaises((EvoError, ValueError)):
                    simulator.restore(good, environments)
            np.testing.assert_array_equal(
                simulator.step(np.ones(8), [False, False]).observations, start.observations)


class Failures(unittest.TestCase):
    def test_refusals_leave_the_session_as_it_was(self):
        with Simulator("Walker-v0", SMALL) as simulator:
            with self.assertRaisesRegex(EvoError, "reset"):
                simulator.step(np.ones(4))
            simulator.reset()
            with self.assertRaisesRegex(EvoError, "not a finite number"):
                simulator.step([1, 1, 1, np.nan])
            with self.assertRaises(ValueError):
                simulator.step(np.ones(5))
            with self.assertRaisesRegex(ValueError, "environment: 4 is not from 0 to 0"):
                simulator.reset([4])
            self.assertEqual(simulator.step(np.ones(4)).status[0], 0)

    def test_what_cannot_be_simulated_is_named(self):
        with self.assertRaisesRegex(EvoError, "Walkr-v0.*Walker-v0"):
            Simulator("Walkr-v0", SMALL)
        with self.assertRaisesRegex(EvoError, "robots.*actuator"):
            Simulator("Walker-v0", np.ones((2, 2)))
        with self.assertRaises(ValueError):
            Simulator("Walker-v0", np.full((2, 2), 9))

    def test_a_closed_one_says_so_and_its_arrays_stay(self):
        simulator = Simulator("Walker-v0", SMALL)
        simulator.reset()
        positions = simulator.positions
        kept = positions.copy()
        simulator.close()
        simulator.close()
        with self.assertRaisesRegex(EvoError, "closed"):
            simulator.step(np.ones(4))
        np.testing.assert_array_equal(positions, kept)
        with self.assertRaises(ValueError):
            positions[:] = 0


class Habits(unittest.TestCase):
    """What a process goes through: forks, copies, threads, Ctrl-C."""

    def test_copies_go_on_from_where_they_are(self):
        rng = np.random.default_rng(0)
        simulator = Simulator("Catcher-v0", [SMALL, WALKER], 2, seed=5, settings={"gravity": 60})
        simulator.reset([0, 1, 2])
        mask = [True, True, True, False]
        for _ in range(7):
            simulator.step(rng.uniform(0.6, 1.6, 34), mask)
        for other in (copy.copy(simulator), copy.deepcopy(simulator),
                      pickle.loads(pickle.dumps(simulator))):
            self.assertEqual(other.steps.tolist(), [7, 7, 7, 0])
            original = pickle.loads(pickle.dumps(simulator))
            actions = rng.uniform(0.6, 1.6, 34)
            np.testing.assert_array_equal(original.step(actions, mask).observations,
                                          other.step(actions, mask).observations)
            # Their next episodes are the same, too.
            np.testing.assert_array_equal(original.reset().observations, other.reset().observations)

    def test_a_second_thread_in_a_step_is_refused_and_others_go_on(self):
        shared = Simulator("Walker-v0", WALKER, 64)
        shared.reset()
        actions = np.full((64, 13), 1.2)
        refused, unlike = [], []

        def on_shared():
            for _ in range(60):
                try:
                    shared.step(actions)
                except EvoError as error:
                    refused.append(str(error))

        def on_own():
            with Simulator("Walker-v0", SMALL) as own:
                own.reset(seed=1)
                for _ in range(200):
                    state = own.step(np.full(4, 1.4))
                unlike.append(state.observations)

        threads = [threading.Thread(target=on_shared) for _ in range(2)]
        threads += [threading.Thread(target=on_own) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertTrue(all("another thread" in message for message in refused))
        self.assertEqual(int(shared.steps[0]) + len(refused), 120)
        for other in unlike[1:]:
            np.testing.assert_array_equal(unlike[0], other)

    def test_ctrl_c_comes_between_two_steps(self):
        simulator = Simulator("Walker-v0", WALKER)
        twin = Simulator("Walker-v0", WALKER)
        simulator.reset()
        twin.reset()
        action = np.full(13, 1.3)
        before = signal.signal(signal.SIGALRM, lambda *_: signal.raise_signal(signal.SIGINT))
        try:
            signal.setitimer(signal.ITIMER_REAL, 0.1)
            with self.assertRaises(KeyboardInterrupt):
                while True:
                    simulator.step(action)
        finally:
            signal.signal(signal.SIGALRM, before)
        for _ in range(int(simulator.steps[0])):
            twin.step(action)
        np.testing.assert_array_equal(simulator.step(action).observations,
                                      twin.step(action).observations)

    def test_no_memory_is_left_behind(self):
        simulator = Simulator("Catcher-v0", SMALL, 4)

        def work(resets):
            for _ in range(resets):
                simulator.reset()
                for _ in range(10):
                    simulator.step(np.ones(16))
                simulator.restore(simulator.save([0]), [3])
                Simulator("Walker-v0", SMALL).close()

        def resident():
            with open("/proc/self/statm") as statm:
                return int(statm.read().split()[1]) * 4096

        work(30)
        before = resident()
        work(300)
        self.assertLess(resident() - before, 4 << 20)


class Robots(unittest.TestCase):
    def test_a_robot_shows_itself_and_is_a_body(self):
        robot = evo_robots.Robot(WALKER)
        self.assertIn("<svg", robot._repr_svg_())
        self.assertIn("RHHHR\nVSSSV", repr(robot))
        body, connections = robot
        np.testing.assert_array_equal(body, WALKER)
        self.assertEqual(pickle.loads(pickle.dumps(robot)), robot)
        self.assertEqual(evo_robots.Robot(body, connections).id, robot.id)
        with Simulator("Walker-v0", [robot, SMALL]) as simulator:
            self.assertEqual(simulator.info["robots"][0]["id"], robot.id)
        with self.assertRaisesRegex(ValueError, "not 2"):
            evo_robots.Robot([WALKER, SMALL])

    def test_robots_as_people_keep_them(self):
        """Read, or refused in one line that says what is expected."""
        body = np.array([[3, 3, 3], [4, 0, 4]])
        folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "printed.txt").write_text(str(body.astype(float)))
        (folder / "solution.json").write_text(json.dumps({"task": "x", "robot": body.tolist(), "genes": [0.1]}))
        (folder / "neat.cfg").write_text("[ELITES]\npop_size = 6\n")
        np.savez(folder / "none.npz", body, None)
        for given in (folder / "printed.txt", str(folder / "solution.json"), folder / "none.npz", body.tolist(),
                      body.astype(float), body.astype(object), body.astype(str), (body, None),
                      {"robot": body, "fitness": np.float32(1.5)}, {"structure": body.tolist()}):
            with self.subTest(given=given):
                document = evo_robots.robot_document(given)
                self.assertEqual(evo_robots.Robot(document).document["body"], ["HHH", "V.V"])
                with Simulator("Walker-v0", given) as simulator:
                    self.assertEqual(simulator.num_envs, 1)
        matrix = "^a body is a matrix of the numbers 0 to 4$"
        for given, message in (
                (folder / "neat.cfg", "neat.cfg:1:2: "), (folder / "absent.json", "absent.json: cannot be opened"),
                ("333/404", "333/404: cannot be opened"), (str(body), "the name of a robot's file"), (None, matrix), (5, matrix),
                (body + 0.5, matrix), (body[None], matrix), (np.array([None, 3], object), matrix),
                (([[3, 4], [3]], None), matrix), ({"body": {1}}, "not set"),
                ({"foo": [[3]]}, "'body' is missing")):
            for take in (lambda robot: evo_robots.Robot(evo_robots.robot_document(robot)),
                         lambda robot: Simulator("Walker-v0", robot)):
                with self.subTest(given=given):
                    with self.assertRaisesRegex((ValueError, EvoError), message) as refused:
                        take(given)
                    self.assertNotIn("\n", str(refused.exception))


class Views(unittest.TestCase):
    """What voxels see, and controllers that act on it."""

    def test_what_does_not_change(self):
        simulator = Simulator("Walker-v0", [WALKER, SMALL])
        voxels = simulator.voxels(0)
        self.assertEqual(len(voxels.fixed), (WALKER != 0).sum())
        materials = WALKER[WALKER != 0]
        np.testing.assert_array_equal(materials[voxels.actuators] > 2, True)
        np.testing.assert_array_equal(voxels.mask, materials > 2)
        # The voxel itself is the middle of the nine cells around it.
        np.testing.assert_array_equal(voxels.fixed[:, 4 * 5:5 * 5].argmax(1) + 1, materials)
        # Links are those of the body, both ways.
        cells = np.flatnonzero(WALKER)
        links = {tuple(cells[pair]) for pair in voxels.links}
        expected = evo_robots.get_full_connectivity(WALKER).T
        self.assertEqual(links, {tuple(pair) for pair in expected} | {tuple(pair[::-1]) for pair in expected})
        with self.assertRaisesRegex(EvoError, "no environment 2"):
            simulator.voxels(2)

    def test_views_are_of_the_voxels_points(self):
        simulator = Simulator("Walker-v0", [WALKER, SMALL], envs=2)
        simulator.reset(seed=1)
        rng = np.random.default_rng(1)
        for _ in range(7):
            simulator.step(rng.uniform(0.6, 1.6, simulator.action_lengths.sum()))
        (walker, small), task = simulator.look()
        self.assertEqual(walker.shape, (2, (WALKER != 0).sum(), simulator.voxels(0).local_length))
        self.assertEqual(small.shape[:2], (2, 4))
        for e in (2, 3):
            alone = Simulator("Walker-v0", SMALL)
            alone.reset(seed=1, episode=e - 2)
            alone.restore(simulator.save([e]))
            points = alone.positions[0, alone.objects()["robot"]]
            centred = (points - points.mean(0)) / 0.1
            seen = small[e - 2][:, :8].reshape(-1, 4, 2)
            for corner in seen.reshape(-1, 2):
                self.assertLess(np.abs(centred - corner).sum(1).min(), 1e-12)
            (again,), other = alone.look()
            np.testing.assert_array_equal(again[0], small[e - 2])
            np.testing.assert_array_equal(other[0], task[e])

    def test_one_controller_acts_on_many_bodies_as_evo_eval_says(self):
        with tempfile.TemporaryDirectory() as folder:
            document = lambda body: json.dumps(evo_robots.robot_document(body)) + "\n"
            with open(f"{folder}/robots", "w", encoding="utf-8") as file:
                file.write(document(WALKER) + document(SMALL))
            tool("evo-train", "-q", "robots", "--task", "Walker-v0", "--train", "modular", "--train", "environments=2",
                 "--train", "clock=20", "--steps", 512, "--shared", "one.policy.h5", "-o", "scored", cwd=folder)
            other = evo_robots.sample_robot((4, 3), rng=np.random.default_rng(1))[0]
            with open(f"{folder}/other", "w", encoding="utf-8") as file:
                file.write(document(other))
            expected = [json.loads(line)["fitness"] for line in
                        tool("evo-eval", "-q", "--policy", "one.policy.h5", "robots", "other", cwd=folder).splitlines()]
            policy = evo_robots.Trained.read(f"{folder}/one.policy.h5")
        simulator = Simulator("Walker-v0", [WALKER, SMALL, other], envs=2)
        simulator.reset()
        earned = np.zeros(6)
        running = np.ones(6, bool)
        while running.any():
            simulator.advance(simulator.act(policy), running)
            earned[running] += simulator.rewards[running]
            running &= ~(simulator.terminated | simulator.truncated)
        np.testing.assert_array_equal(earned[::2], expected)
        with self.assertRaisesRegex(EvoError, "acts on voxels, not on an observation: Simulator.act"):
            policy.act(np.zeros((1, 0)))
        carrier = Simulator("Carrier-v0", SMALL)
        carrier.reset()
        with self.assertRaisesRegex(EvoError, "it was trained on another task"):
            carrier.act(policy)

    def test_other_controllers_act_on_robots_like_their_own(self):
        trained, other = (evo_robots.train("Walker-v0", SMALL, steps=4096, seed=seed) for seed in (1, 2))
        simulator = Simulator("Walker-v0", SMALL, envs=3)
        simulator.reset()
        for policy in (trained, other, trained):
            np.testing.assert_array_equal(simulator.act(policy), policy.act(simulator.observations, simulator.steps))
        self.assertFalse(np.array_equal(simulator.act(trained), simulator.act(other)))
        with self.assertRaisesRegex(EvoError, "robot .*: the controller has 20 inputs, robot and task need 66"):
            Simulator("Walker-v0", WALKER).act(trained)


class Numbers(unittest.TestCase):
    """No number is silently another."""

    def test_whole_numbers_are_not_cut(self):
        with Simulator("Walker-v0", SMALL) as sim:
            for wrong in (1.9, "5", 1 << 64, -1, None):
                for name in ("seed", "episode"):
                    if wrong is not None:
                        with self.assertRaisesRegex(ValueError, name):
                            sim.reset(**{name: wrong})
            sim.reset(seed=np.uint64((1 << 64) - 1))
            for wrong in ((1 << 32), 0.0, "0"):
                with self.assertRaisesRegex(ValueError, "not"):
                    sim.save([wrong])
                with self.assertRaisesRegex(ValueError, "width"):
                    sim.picture(width=wrong)
        for given in ({"envs": (1 << 32) + 1}, {"envs": 1.5}, {"jobs": (1 << 32) + 1}, {"seed": 1 << 64}):
            with self.assertRaisesRegex(ValueError, "not"):
                Simulator("Walker-v0", SMALL, **given)
        with self.assertRaisesRegex(ValueError, "NUL"):
            Simulator("Walker-v0\0x", SMALL)

    def test_actions_are_plain_numbers(self):
        with Simulator("Walker-v0", SMALL) as sim:
            sim.reset()
            for wrong in (np.ma.masked_array([[1.0] * 4], [[True] * 4]), [["1"] * 4], [[1j] * 4], [[None] * 4]):
                with self.assertRaisesRegex(ValueError, "actions: plain numbers"):
                    sim.step(wrong)

    def test_the_last_episode_of_a_seed_is_copied(self):
        with Simulator("Walker-v0", SMALL) as sim:
            sim.reset(seed=1, episode=(1 << 64) - 1)
            again = copy.deepcopy(sim)
            np.testing.assert_array_equal(again.observations, sim.observations)


if __name__ == "__main__":
    unittest.main()
