"""Worlds built in Python, in this process; needs numpy alone."""
import copy
import gc
import os
import pickle
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
    def test_a_body_on_the_bare_floor_moves_as_in_the_benchmark(self):
        world = World()
        world.add("robot", BODY, 5, 0)
        sims = Simulations(world)
        for _ in range(40):
            sims.step(np.ones((1, 4)))
        x, y = sims.positions[0].mean(axis=0) / 0.1
        self.assertAlmostEqual(x, 5.999227935004826, delta=1e-14)
        self.assertAlmostEqual(y, 0.9958063894145683, delta=1e-14)

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

    def test_a_state_goes_on_to_the_same_bits(self):
        sims = Simulations(two_robots(), 2)
        for t in range(10):
            sims.step(wave(sims, t))
        state = sims.save(0)
        before = sims.positions[0].copy()
        sims.restore(state, 1)
        np.testing.assert_array_equal(sims.positions[1], before)
        same = np.tile(wave(sims, 3)[:1], (2, 1))
        for _ in range(20):
            sims.step(same)
        np.testing.assert_array_equal(sims.positions[0], sims.positions[1])
        with self.assertRaisesRegex(EvoError, "damaged"):
            sims.restore(state[:-1])
        with self.assertRaisesRegex(EvoError, "another world"):
            World_ = World()
            World_.add("robot", BODY, 5, 0)
            Simulations(World_).restore(state)

    def test_masks_leave_others_as_they_are(self):
        sims = Simulations(two_robots(), 2)
        before = sims.positions.copy()
        sims.step(wave(sims, 1), mask=[False, True])
        np.testing.assert_array_equal(sims.positions[0], before[0])
        self.assertTrue((sims.positions[1] != before[1]).any())
        sims.reset(1)
        np.testing.assert_array_equal(sims.positions, before)

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

    def test_a_picture(self):
        sims = Simulations(two_robots())
        start, kept = sims.picture(0, 200, 100), sims.positions[0].copy()
        self.assertEqual((start.shape, start.dtype), ((100, 200, 3), np.uint8))
        for t in range(10):
            sims.step(wave(sims, t))
        self.assertFalse(np.array_equal(sims.picture(0, 200, 100), start))
        np.testing.assert_array_equal(sims.picture(0, 200, 100, positions=kept), start)

    def test_a_forked_child_goes_on(self):
        sims = Simulations(two_robots())
        sims.step(wave(sims, 0))
        expected = sims.save()
        reading, writing = os.pipe()
        child = os.fork()
        if child == 0:
            os.write(writing, sims.save()[:64])
            os._exit(0)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertEqual(os.read(reading, 64), expected[:64])
        os.close(reading)
        os.close(writing)

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

    def test_no_memory_is_left_behind(self):
        sims = Simulations(two_robots(), 4)
        targets = np.ones((4, 8))

        def work(rounds):
            for _ in range(rounds):
                sims.step(targets)
                sims.restore(sims.save(0), 3)
                two_robots().json()

        def resident():
            with open("/proc/self/statm") as statm:
                return int(statm.read().split()[1]) * 4096

        work(200)
        before = resident()
        work(2000)
        self.assertLess(resident() - before, 4 << 20)


if __name__ == "__main__":
    unittest.main()
