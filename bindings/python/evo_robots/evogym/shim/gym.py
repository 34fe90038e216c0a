raise ImportError(
    "this program is for the old gym, whose step() gives four values; for evogym 2.x write 'import gymnasium as gym', "
    "'observation, info = env.reset(seed=..)' and 'observation, reward, terminated, truncated, info = env.step(..)'")
