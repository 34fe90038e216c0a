"""The benchmark's tasks in Gymnasium's registry."""

TASKS = (
    "AreaMaximizer-v0", "AreaMinimizer-v0", "Balancer-v0", "Balancer-v1", "BeamSlider-v0",
    "BeamToppler-v0", "BidirectionalWalker-v0", "BridgeWalker-v0", "Carrier-v0", "Carrier-v1",
    "Catcher-v0", "CaveCrawler-v0", "Climber-v0", "Climber-v1", "Climber-v2", "DownStepper-v0",
    "Flipper-v0", "GapJumper-v0", "HeightMaximizer-v0", "Hurdler-v0", "Jumper-v0", "Lifter-v0",
    "ObstacleTraverser-v0", "ObstacleTraverser-v1", "PlatformJumper-v0", "Pusher-v0", "Pusher-v1",
    "Thrower-v0", "Traverser-v0", "UpStepper-v0", "Walker-v0", "WingspanMazimizer-v0",
)


def register(prefix: str) -> None:
    """Every task as PREFIX + name. The time limit is the task's own."""
    import gymnasium

    for task in TASKS:
        gymnasium.register(
            prefix + task,
            entry_point="evo_robots.environment:Environment",
            vector_entry_point="evo_robots.vector:VectorEnvironment",
            kwargs={"task": task})
