"""The benchmark's tasks in Gymnasium's registry."""

TASKS = {  # the time limits, control steps
    "AreaMaximizer-v0": 600, "AreaMinimizer-v0": 600, "Balancer-v0": 600, "Balancer-v1": 600,
    "BeamSlider-v0": 1000, "BeamToppler-v0": 1000, "BidirectionalWalker-v0": 1000,
    "BridgeWalker-v0": 500, "Carrier-v0": 500, "Carrier-v1": 1000, "Catcher-v0": 400,
    "CaveCrawler-v0": 1000, "Climber-v0": 400, "Climber-v1": 600, "Climber-v2": 1000,
    "DownStepper-v0": 500, "Flipper-v0": 600, "GapJumper-v0": 1000, "HeightMaximizer-v0": 500,
    "Hurdler-v0": 1000, "Jumper-v0": 500, "Lifter-v0": 300, "ObstacleTraverser-v0": 1000,
    "ObstacleTraverser-v1": 1000, "PlatformJumper-v0": 1000, "Pusher-v0": 500, "Pusher-v1": 600,
    "Thrower-v0": 300, "Traverser-v0": 600, "UpStepper-v0": 600, "Walker-v0": 500,
    "WingspanMazimizer-v0": 600,
}


def register(prefix: str) -> None:
    """Every task as PREFIX + name, with the benchmark's time limit, which
    ``gymnasium.make(.., max_episode_steps=)`` changes."""
    import gymnasium

    for task, limit in TASKS.items():
        gymnasium.register(
            prefix + task,
            entry_point="evo_robots.environment:unlimited",
            vector_entry_point="evo_robots.vector:VectorEnvironment",
            max_episode_steps=limit,
            kwargs={"task": task})
