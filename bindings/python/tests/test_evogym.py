"""The benchmark's own names; needs numpy alone."""
import copy
import json
import os
import random
import tempfile
import time
import unittest

import numpy as np

import evo_robots
from evo_robots import evogym
from evo_robots.evogym import EvoSim, EvoWorld, Pair, WorldObject

BODY = np.array([[3, 4], [4, 3]])


class Utils(unittest.TestCase):
    def test_seeds_draw_the_benchmarks_robots(self):
        random.seed(3)
        # evogym 2.0.0 gives these after the same seed.
        bodies = [evogym.hashable(evogym.sample_robot((2, 3))[0]) for _ in range(4)]
        self.assertEqual(bodies, EXPECTED_BODIES)

    def test_draw_and_shares(self):
        np.testing.assert_allclose(evogym.get_uniform(4), [0.25] * 4)
        self.assertEqual([evogym.draw(w) for w in ([0.2], [0.2, 0], [0, 15])], [0, 0, 1])
        for wrong in ([], [0, 0], [-1, 2]):
            with self.assertRaises(AssertionError):
                evogym.draw(wrong)
        with self.assertRaises(ValueError):
            evogym.sample_robot((5, 5), np.array([1, 1, 1, 0, 0]))

    def test_pairs_are_reckoned_with(self):
        pair = Pair(7, -2)
        for found, expected in ((pair + 1, (8, -1)), (pair - Pair(1, 2), (6, -4)), (pair * 2, (14, -4)),
                                (pair / 2, (3, -1)), (pair // Pair(2, 1), (3, -2)), (pair % 4, (3, 2)),
                                (pair.abs(), (7, 2)), (pair.each_max(Pair(0, 0)), (7, 0)),
                                (pair.each_min(Pair(0, 0)), (0, -2))):
            self.assertEqual((found[0], found[1]), expected)
        self.assertEqual((Pair(2, 2), str(pair)), (2, "(7, -2)"))
        self.assertNotEqual(pair, "(7, -2)")
        self.assertRaises(TypeError, lambda: pair + "1")
        self.assertRaises(IndexError, lambda: pair[2])

    def test_a_timer_keeps_a_pace(self):
        timer = evogym.Timer(1000)
        begun, steps = time.monotonic(), 0
        while steps < 100:
            if timer.should_step():
                timer.step()
                steps += 1
        self.assertGreater(time.monotonic() - begun, 0.09)
        self.assertTrue(evogym.Timer().should_step())

    def test_names(self):
        self.assertTrue(evogym.is_connected(robot=BODY) and evogym.has_actuator(robot=BODY))
        self.assertEqual(evogym.get_full_connectivity(robot=BODY).shape, (2, 4))
        self.assertEqual(len(evogym.BASELINE_ENV_NAMES), 32)
        self.assertEqual(evogym.BASELINE_ENV_NAMES[:2], ["Walker-v0", "BridgeWalker-v0"])
        self.assertEqual(evogym.VOXEL_TYPES["FIXED"], 5)


class Worlds(unittest.TestCase):
    def test_objects_from_arrays(self):
        made = WorldObject.from_array("robot", [[3, 0], [4, 1]])
        self.assertEqual(made.get_structure().tolist(), [[3, 0], [4, 1]])
        self.assertEqual(made.grid.tolist(), [[4, 1], [3, 0]])  # upwards
        self.assertEqual(made.voxels, [Pair(0, 0), Pair(1, 0), Pair(0, 1)])
        links = {tuple(sorted(link)) for link in made.get_connections().T.tolist()}
        self.assertEqual(links, {(0, 2), (2, 3)})
        with self.assertRaisesRegex(ValueError, "no voxels"):
            WorldObject.from_array("robot", [[3, 0], [4, 1]], np.array([[0], [1]]))
        other = copy.copy(made)
        other.rename("other")
        other.set_pos(4, 5)
        self.assertEqual((made.get_name(), made.get_pos(), other.get_pos()), ("robot", (0, 0), (4, 5)))
        with self.assertRaisesRegex(ValueError, "outside"):
            other.translate(-5, 0)

    def test_worlds_grow_and_refuse_what_overlaps(self):
        world = EvoWorld()
        world.add_from_array("ground", np.full((1, 6), 5), 0, 0)
        world.add_from_array("robot", BODY, 1, 1)
        self.assertEqual((world.grid_size.x, world.grid_size.y), (6, 3))
        with self.assertRaisesRegex(ValueError, "overlaps"):
            world.add_from_array("box", [[2]], 2, 2)
        with self.assertRaisesRegex(ValueError, "already"):
            world.add_from_array("robot", BODY, 9, 1)
        with self.assertRaisesRegex(ValueError, "overlaps"):
            world.translate_object("robot", 0, -1)
        self.assertEqual(world.objects["robot"].get_pos(), (1, 1))  # as before
        world.move_object("robot", 3, 1)
        self.assertEqual(world.grid[1].tolist(), [0, 0, 0, 4, 3, 0])
        self.assertEqual(world.remove_object("robot").get_pos(), (3, 1))
        self.assertEqual(world.grid[1:].sum(), 0)
        with self.assertRaisesRegex(ValueError, "no object robot; there are: ground"):
            world.remove_object("robot")

    def test_the_design_tools_files(self):
        document = {"grid_width": 5, "grid_height": 3, "objects": {"box": {
            "indices": [6, 7, 11], "types": [1, 2, 3],
            "neighbors": {"6": [7, 11], "7": [6], "11": [6]}}}}
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "world.json")
            with open(path, "w") as file:
                json.dump(document, file)
            box = WorldObject.from_json(path)
            self.assertEqual((box.get_pos(), box.grid.tolist()), ((1, 1), [[1, 2], [3, 0]]))
            world = EvoWorld.from_json(path)
            with self.assertRaisesRegex(ValueError, "already"):
                world.add_from_json(path)


class Sims(unittest.TestCase):
    def sim(self):
        world = EvoWorld()
        world.add_from_array("ground", np.full((1, 30), 5), 0, 0)
        world.add_from_array("b", BODY, 15, 1)
        world.add_from_array("a", [[3, 0], [4, 4]], 5, 1)
        return EvoSim(world)

    def test_two_robots_and_a_box_have_the_bits_of_the_benchmarks_package(self):
        world = EvoWorld()
        world.add_from_array("ground", np.full((1, 40), 5), 0, 0)
        world.add_from_array("left", [[3, 3, 3], [4, 1, 4], [4, 0, 4]], 3, 1)
        world.add_from_array("right", [[3, 4, 3], [2, 2, 2], [4, 0, 4]], 6, 1)
        world.add_from_array("box", [[2, 2], [2, 2]], 4, 4)
        sim = EvoSim(world)
        for t in range(100):
            for name in ("left", "right"):
                sim.set_action(name, [1.1 + ((7 * t + 3 * k) % 11 - 5) / 10
                                      for k in range(sim.get_dim_action_space(name))])
            self.assertFalse(sim.step())
        # Each one's first point, where evogym 2.0.0 has it.
        for name, point in (("left", [2.664310187503588, 4.245726666431066]),
                            ("right", [6.793620732533455, 4.151254781225121]),
                            ("box", [3.0297282341572753, 6.287109547251052])):
            self.assertEqual(sim.object_pos_at_time(100, name)[:, 0].tolist(), point)

    def test_history_and_actions_of_several_robots(self):
        sim = self.sim()
        self.assertEqual(sim.get_dim_action_space("a"), 3)
        self.assertEqual(sim.get_actuator_indices("a").tolist(), [0, 2, 3])
        begin = sim.pos_at_time(0)
        sim.set_action("a", [1.6, 0.6, 1.6])
        for _ in range(10):
            sim.step()
        self.assertEqual(sim.get_time(), 10)
        np.testing.assert_array_equal(sim.pos_at_time(0), begin)
        self.assertEqual(sim.pos_at_time(10).shape, (2, begin.shape[1]))
        self.assertTrue((sim.object_vel_at_time(10, "a") != 0).any())
        self.assertNotEqual(sim.object_orientation_at_time(10, "a"),
                            sim.object_orientation_at_time(0, "a"))
        sim.reset()
        self.assertEqual(sim.get_time(), 0)
        for wrong, kind in ((lambda: sim.pos_at_time(1), ValueError),
                            (lambda: sim.pos_at_time(0.0), TypeError),
                            (lambda: sim.object_pos_at_time(0, "c"), ValueError),
                            (lambda: sim.set_action("ground", []), ValueError),
                            (lambda: sim.set_action("a", [1, 1]), ValueError)):
            self.assertRaises(kind, wrong)


    def test_objects_are_moved_and_times_come_back(self):
        sim = self.sim()
        before = sim.object_pos_at_time(0, "b")
        sim.translate_object(0.5, 0.1, "b")
        np.testing.assert_allclose(sim.object_pos_at_time(0, "b") - before, [[5.0] * 9, [1.0] * 9], atol=1e-12)
        rng = np.random.default_rng(1)
        for t in range(20):
            if t == 7:
                sim.translate_object(0.0, 0.3, "a")
            sim.set_action("a", rng.uniform(0.6, 1.6, 3))
            sim.step()
            if t == 10:
                at = sim.pos_at_time(11)
                sim.set_action("a", [1, 1, 1])
                sim.step()
                ahead = sim.pos_at_time(12)
                sim.revert(11)
                self.assertEqual(sim.get_time(), 11)
                np.testing.assert_array_equal(sim.pos_at_time(11), at)
                sim.step()  # by the targets set last
                np.testing.assert_array_equal(sim.pos_at_time(12), ahead)
                sim.revert(11)
        self.assertEqual(sim.get_time(), 20)
        self.assertEqual(sim.get_indices_of_actuators("a").tolist(), [[0, 2, 3]])
        with self.assertRaisesRegex(evo_robots.EvoError, "terrain"):
            sim.translate_object(1, 1, "ground")
        with self.assertRaisesRegex(NotImplementedError, "EvoWorld"):
            sim.read_robot_from_array(BODY)


EXPECTED_BODIES = ["030041", "312024", "132032", "004134"]

if __name__ == "__main__":
    unittest.main()
