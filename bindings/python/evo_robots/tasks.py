"""The benchmark's tasks in Gymnasium's registry."""

TASKS = {  # the time limits, control steps; in the benchmark's order
    "Walker-v0": 500, "BridgeWalker-v0": 500, "BidirectionalWalker-v0": 1000, "Carrier-v0": 500,
    "Carrier-v1": 1000, "Pusher-v0": 500, "Pusher-v1": 600, "Thrower-v0": 300, "Catcher-v0": 400,
    "BeamToppler-v0": 1000, "BeamSlider-v0": 1000, "Lifter-v0": 300, "Climber-v0": 400,
    "Climber-v1": 600, "Climber-v2": 1000, "UpStepper-v0": 600, "DownStepper-v0": 500,
    "ObstacleTraverser-v0": 1000, "ObstacleTraverser-v1": 1000, "Hurdler-v0": 1000,
    "PlatformJumper-v0": 1000, "GapJumper-v0": 1000, "Traverser-v0": 600, "CaveCrawler-v0": 1000,
    "AreaMaximizer-v0": 600, "AreaMinimizer-v0": 600, "WingspanMazimizer-v0": 600,
    "HeightMaximizer-v0": 500, "Flipper-v0": 600, "Jumper-v0": 500, "Balancer-v0": 600,
    "Balancer-v1": 600,
}


def register() -> None:
    """Every task as evo/NAME, with the benchmark's time limit, which
    ``gymnasium.make(.., max_episode_steps=)`` changes."""
    import gymnasium

    for task, limit in TASKS.items():
        gymnasium.register(
            "evo/" + task,
            entry_point="evo_robots.environment:unlimited",
            vector_entry_point="evo_robots.vector:VectorEnvironment",
            max_episode_steps=limit,
            kwargs={"task": task})
    # make("evo/file", task="my.yaml", body=..), with the limit of the file.
    gymnasium.register("evo/file", entry_point="evo_robots.environment:Environment",
                       vector_entry_point="evo_robots.vector:VectorEnvironment")
