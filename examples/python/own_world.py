#!/usr/bin/env python3
"""A world of one's own: two robots push a box between them. Draws its end into push.gif."""
import numpy as np

from evo_robots import Simulations, World
from evo_robots.video import Video

world = World()
world.add("ground", np.full((1, 40), 5), 0, 0)
world.add("left", [[3, 3, 3], [4, 1, 4]], 8, 1)
world.add("right", [[3, 3, 3], [4, 1, 4]], 20, 1)
world.add("box", [[1, 1, 1], [1, 1, 1]], 14, 1)
sims = Simulations(world, 8)  # eight attempts side by side

actuators = np.arange(sims.num_actuators)
for t in range(200):
    sims.step(1.1 + 0.5 * np.sin(0.5 * t + actuators + np.arange(8)[:, None]))
box = sims.positions[:, sims.objects["box"].points].mean(axis=1) / 0.1
best = int(np.abs(box[:, 0] - 15.5).argmax())
print(f"attempt {best} moved the box by {box[best, 0] - 15.5:.3f} voxels")
Video([sims.picture(best, 800, 300, window=(16, 4, 40, 15))], fps=1).save("push.gif")
