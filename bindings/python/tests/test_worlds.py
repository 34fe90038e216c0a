"""Worlds built in Python, in this process; needs numpy alone."""
import copy
import gc
import pathlib
import pickle
import runpy
import tempfile
import unittest

import numpy as np

import evo_robots
from evo_robots import EvoError, Simulations, World

BODY = np.array([[3, 4], [4, 3]])


def two_robots():
    world = World()
    world.add("ground", np.full((1, 30), 5), 0, 0)
    world.add("right", BODY, 15, 1)
    world.add("left", BODY, 5, 1)
    return world


def wave(sims, t):
    return 1.1 + 0.5 * np.sin(0.3 * t + 0.7 * np.arange(sims.num_sims * sims.num_actuators)).reshape(
        sims.num_sims, sims.num_actuators)


class Worlds(unittest.TestCase):
    def test_gradients_are_differences(self):
        sims = Simulations(two_robots(), 2)
        points = sims.objects["left"].points

        def walked(change=0.0, sims=sims):
            sims.reset()
            for t in range(3):
                targets = wave(sims, t)
                targets[1, 0] += change * (t == 0)
                sims.step(targets)
            return sims.positions[1, points, 0].sum()

        by = sims.gradients()
        by.positions[1, points, 0] = 1.0
        with self.assertRaisesRegex(EvoError, "no step is kept"):
            sims.pull_back(by)
        sims.record(onset=0)
        walked()
        for _ in range(3):
            sims.pull_back(by)
        sims.record(None)
        self.assertAlmostEqual(by.targets[1, 0], (walked(1e-5) - walked(-1e-5)) / 2e-5, delta=1e-6)
        self.assertTrue((by.targets[0] == 0).all())
        self.assertEqual(by.stiffness.shape, (2, 38))
        self.assertTrue((by.stiffness[1] != 0).any())
        usual = {"gravity": 110, "drag": 0.1, "contact_stiffness": 2.1e6, "contact_damping": 140,
                 "friction_multiplier": 1200}
        self.assertEqual(by.constants.shape, (2, len(by.CONSTANTS)))
        with tempfile.TemporaryDirectory() as folder:
            for constant, slope in zip(by.CONSTANTS, by.constants[1]):
                ends = []
                for value in (usual[constant] * (1 - 1e-5), usual[constant] * (1 + 1e-5)):
                    profile = pathlib.Path(folder) / "physics.yaml"
                    profile.write_text("format: evo/physics\nversion: 1\nname: other\nbase: evogym\n"
                                       f"{constant}: {value!r}\n")
                    ends.append(walked(sims=Simulations(two_robots(), 2, physics=profile)))
                self.assertNotEqual(slope, 0)
                self.assertAlmostEqual(slope / ((ends[1] - ends[0]) / (2e-5 * usual[constant])), 1,
                                       delta=1e-3, msg=constant)
        by.targets = by.targets[:1]
        with self.assertRaisesRegex(ValueError, "expected"):
            sims.pull_back(by)

    def test_a_walker_is_designed_by_the_gradient_of_stiffness(self):
        example = pathlib.Path(__file__).parents[3] / "examples/python/stiffness.py"
        if not example.exists():
            self.skipTest("the package is tested without its examples")
        before, after, factors = runpy.run_path(str(example))["main"]()
        self.assertGreater(after, 1.5 * before)
        self.assertTrue(((factors >= 0.1) & (factors <= 10)).all())

    def test_robots_and_their_points_and_actuators(self):
        sims = Simulations(two_robots(), 3, jobs=2)
        self.assertEqual(list(sims.objects), ["left", "right", "ground"])
        self.assertEqual(sims.objects["right"].actuators, slice(4, 8))
        self.assertEqual(sims.num_actuators, 8)
        np.testing.assert_allclose(
            sims.positions[:, sims.objects["left"].points].mean(axis=1) / 0.1, [[6, 2]] * 3)
        targets = np.ones((3, 8))
        targets[1, sims.objects["right"].actuators] = 1.6
        for _ in range(20):
            sims.step(targets)
        left, right = (sims.positions[:, sims.objects[name].points] for name in ("left", "right"))
        np.testing.assert_array_equal(left[0], left[1])
        self.assertGreater(np.ptp(right[1, :, 0]), np.ptp(right[0, :, 0]) + 0.03)
        np.testing.assert_allclose(sims.orientation("ground"), 0, atol=1e-3)

    def test_stiffness(self):
        """As a robot's, and kept with the world."""
        factors = [[0.3, 1], [2, 10]]
        known = evo_robots.Simulator("Walker-v0", BODY, stiffness=factors)
        known.reset()
        world = World()
        world.add("ground", np.full((1, 100), 5), 0, 0)
        world.add("robot", BODY, 1, 1, stiffness=factors)
        sims = [Simulations(built) for built in (world, pickle.loads(pickle.dumps(world)))]
        world.stiffen("robot", np.ones((2, 2)))
        plain = Simulations(world)
        for t in range(30):
            known.step(wave(plain, t))
            for each in (plain, *sims):
                each.step(wave(plain, t))
        for each in sims:
            np.testing.assert_array_equal(each.positions, known.positions)
        self.assertFalse(np.array_equal(plain.positions, known.positions))
        self.assertEqual(evo_robots.Robot(BODY, stiffness=np.ones((2, 2))), evo_robots.Robot(BODY))
        robot = evo_robots.Robot(BODY, stiffness=factors)
        np.testing.assert_array_equal(robot.stiffness, factors)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(robot)).stiffness, factors)
        with self.assertRaisesRegex(EvoError, "3 factors"):
            world.add("more", BODY, 50, 1, stiffness=[1, 1, 1])
        self.assertNotIn("more", world.json())

    def test_arrays_outlive_what_they_are_of(self):
        sims = Simulations(two_robots())
        positions = sims.positions
        kept = positions.copy()
        del sims
        gc.collect()
        np.testing.assert_array_equal(positions, kept)
        with self.assertRaises(ValueError):
            positions[0, 0, 0] = 1

    def test_worlds_are_copied_and_pickled(self):
        world = two_robots()
        for other in (pickle.loads(pickle.dumps(world)), copy.deepcopy(world),
                      World.from_json(world.json())):
            self.assertEqual(other.json(), world.json())
            np.testing.assert_array_equal(Simulations(other).positions, Simulations(world).positions)
            other.move("left", 6, 1)
            self.assertNotEqual(other.json(), world.json())

    def test_simulations_are_copied_where_they_are(self):
        sims = Simulations(two_robots(), 2)
        for t in range(5):
            sims.step(wave(sims, t))
        for other in (pickle.loads(pickle.dumps(sims)), copy.deepcopy(sims)):
            np.testing.assert_array_equal(other.positions, sims.positions)
            again = copy.deepcopy(sims)
            again.step(wave(sims, 9))
            other.step(wave(sims, 9))
            np.testing.assert_array_equal(other.positions, again.positions)

    def test_connections(self):
        joined, apart = World(), World()
        joined.add("robot", [[3, 4]], 0, 5)
        with self.assertRaisesRegex(EvoError, "robot"):
            apart.add("robot", [[3, 4]], 0, 5, connections=np.zeros((2, 0)))
        apart.add("robot", BODY, 0, 5, connections=[[0, 0, 1], [1, 2, 3]])
        self.assertEqual(Simulations(apart).positions.shape[1], 10)  # one corner is two points

    def test_what_makes_no_sense_is_refused(self):
        world = two_robots()
        sims = Simulations(world)
        for wrong, message in (
                (lambda: world.add("left", BODY, 0, 9), "already"),
                (lambda: world.add("x", BODY, -1, 9), "outside"),
                (lambda: world.move("lift", 1, 1), "did you mean 'left'"),
                (lambda: Simulations(World()), "no objects"),
                (lambda: Simulations(world, 0), "simulations"),
                (lambda: Simulations(world, physics="papper"), "paper"),
                (lambda: sims.step([[np.nan] * 8]), "finite")):
            with self.assertRaisesRegex(EvoError, message):
                wrong()
        for wrong in (lambda: world.add("x", [[7]], 0, 9), lambda: world.add("x", [3], 0, 9),
                      lambda: sims.step(np.ones(8)), lambda: sims.step(np.ones((1, 8)), mask=[1, 1]),
                      lambda: sims.save(1), lambda: sims.orientation("nothing")):
            with self.assertRaises(ValueError):
                wrong()


if __name__ == "__main__":
    unittest.main()
