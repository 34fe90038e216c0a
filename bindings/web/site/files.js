// What a file of evo holds for this page: policies and rollouts in HDF5 (docs/formats).
'use strict';
(() => {
  const refuse = (text) => { throw Object.assign(new Error(text), { name: 'Refusal' }); };
  // A file of anybody's making: what is missing in it is its fault.
  const guarded = (work) => async (...given) => {
    try {
      return await work(...given);
    } catch (failure) {
      if (failure instanceof RangeError || failure instanceof TypeError || failure instanceof SyntaxError) refuse('it is cut short or damaged');
      throw failure;
    }
  };
  const list = async (group, name) => {
    const dataset = group.children?.get(name);
    if (!dataset?.read) refuse(`/${name} is missing`);
    return Array.from(await dataset.read());
  };
  const rows = async (group, name) => {
    const values = await list(group, name), width = group.children.get(name).shape[1] ?? 1;
    return Array.from({ length: width ? values.length / width : 0 }, (_, k) => values.slice(k * width, (k + 1) * width));
  };
  // What `read` makes of each layer of a group.
  const layers = async (group, read) => {
    const made = [];
    for (let k = 0; group.children.has(`layer_${k}`); ++k) made.push(await read(group.children.get(`layer_${k}`)));
    return made;
  };
  const network = (group) => layers(group, async (layer) => ({ weight: await rows(layer, 'weight'), bias: await list(layer, 'bias') }));
  const part = (group, name) => group?.children?.get(name) ?? refuse(`/${name} is missing`);
  const ofVoxel = async (group) => {
    const first = part(group, 'first'), bias = await list(first, 'bias'), task = await rows(first, 'task');
    const gate = async (layer) => ({ scale: await rows(layer, 'scale'), ...(layer.children.has('shift') ? { shift: await rows(layer, 'shift') } : {}) });
    return { first: { local: await rows(first, 'local'), task: bias.map((_, k) => task[k] ?? []), fixed: await rows(first, 'fixed'), bias },
      rest: await network(part(group, 'rest')), gates: await layers(part(group, 'gates'), gate) };
  };
  const normalizer = async (group) => {
    const { count, clip, epsilon } = group.attributes;
    return { mean: await list(group, 'mean'), var: await list(group, 'var'), count, clip, epsilon };
  };
  const sine = async (group) => ({ amplitude: await list(group, 'amplitude'), phase: await list(group, 'phase'),
    period: group.attributes.period, middle: group.attributes.middle,
    ...(group.children.has('shift') ? { shift: await list(group, 'shift') } : {}) });

  // The document that evo-convert --to json makes of a policy, without what does not act.
  const policy = async (file) => {
    const { attributes, children } = file;
    const { kind, task, task_yaml, robot, fitness } = attributes;
    const document = { format: 'evo/policy', version: 1, kind, task, task_yaml, robot: JSON.parse(robot), fitness };
    if (kind === 'sine') return { ...document, sine: await sine(children.get('sine')) };
    if (kind === 'sequence') return { ...document, actions: await rows(file, 'actions') };
    if (kind !== 'network' && kind !== 'modular') refuse(`its kind is '${kind}'; network, modular, sine and sequence can be driven by`);
    const { action_map: map, action_offset: offset, action_bounds: bounds } = attributes;
    const acting = { ...document, action: { map, offset, bounds }, ...(children.has('clock') ? { clock: await list(file, 'clock') } : {}) };
    const seen = part(file, 'normalizer');
    if (kind === 'modular')
      return { ...acting, actor: await ofVoxel(part(file, 'actor')),
        normalizer: { local: await normalizer(part(seen, 'local')), task: await normalizer(part(seen, 'task')) } };
    return { ...acting, normalizer: await normalizer(seen), actor: await network(part(file, 'actor')),
      ...(children.has('gait') ? { gait: await sine(children.get('gait')) } : {}),
      ...(children.has('sequence') ? { sequence: await rows(file, 'sequence') } : {}) };
  };

  // {task, task_yaml, robot, episodes: how many, episode(k): {seed, draws, actions, rewards,
  // positions: [steps + 1][points][2] in one array, earned, ended as in counts()}, world}.
  const rollout = async (file) => {
    const { task, task_yaml, robot } = file.attributes;
    if (!task_yaml || !robot) refuse('this rollout has no robot or no task, so that nothing can be simulated or drawn');
    const numbers = [...file.children.keys()].map((name) => /^episode_(\d+)$/.exec(name)?.[1]).filter(Boolean).map(Number).sort((a, b) => a - b);
    if (numbers.length === 0) refuse('this rollout has no episodes');
    const episode = guarded(async (k) => {
      const group = file.children.get(`episode_${numbers[k]}`), last = (values) => values[values.length - 1];
      const rewards = await list(group, 'rewards'), infos = group.children.get('infos');
      const flag = async (name) => group.children.has(name) && Boolean(last(await list(group, name)));
      return { seed: group.attributes.seed ?? 0, draws: JSON.parse(group.attributes.random_draws ?? '{}'), rewards,
        actions: group.children.has('actions') ? await rows(group, 'actions') : [],
        positions: infos?.children.has('positions') ? await infos.children.get('positions').read() : null,
        earned: rewards.reduce((sum, reward) => sum + reward, 0),
        ended: await flag('terminations') ? 1 : await flag('truncations') ? 2 : 3 };
    });
    const group = file.children.get('world');
    let world = null;
    if (group?.children.has('cell_object')) {
      const [names, first, points, owners, kinds, corners] = await Promise.all(
        ['object_names', 'object_first_point', 'object_points', 'cell_object', 'cell_type', 'cell_points'].map((name) => list(group, name)));
      const cells = owners.map((owner, k) => [owner, '.RSHV#'[kinds[k]], ...corners.slice(4 * k, 4 * k + 4)]);
      const objects = names.map((name, k) => ({ name, first: first[k], points: points[k], static: !cells.some(([owner, letter]) => owner === k && letter !== '#') }));
      world = { objects, cells };
    }
    return { task, task_yaml, robot: JSON.parse(robot), episodes: numbers.length, episode, world };
  };

  // {policy} or {rollout} of such a file.
  Evo.openHdf5 = guarded(async (bytes) => {
    const file = Evo.readHdf5(bytes), { format } = file.attributes;
    if (format === 'evo/policy') return { policy: await policy(file) };
    if (format === 'evo/rollout') return { rollout: await rollout(file) };
    return refuse(`this HDF5 file is ${format ? `of the format ${format}` : 'none of evo'}; policies and rollouts are opened here`);
  });

  // A recorded episode as a player (module.js) that simulates nothing. `facts`: of the task.
  Evo.recorded = ({ world, positions, rewards, ended, task, robot }, facts, follow) => {
    if (!world || !positions) refuse('this rollout has no positions, so that it cannot be drawn');
    const points = positions.length / (2 * (rewards.length + 1));
    let at = 0, total = 0;
    const player = { ...world, task, robot, points, follow, voxel: 0.1, steps: facts.steps, actuators: 0, observation: 0, terms: facts.reward.map(() => '') };
    return Object.assign(player, {
      control: () => {},
      reset: () => { at = 0; total = 0; },
      step: (most = 1) => { for (let k = 0; k < most && at < rewards.length; ++k) total += rewards[at++]; },
      positions: () => positions.subarray(2 * points * at, 2 * points * (at + 1)),
      counts: () => ({ total, reward: at ? rewards[at - 1] : 0, steps: at, ended: at < rewards.length ? 0 : ended,
        folding: NaN, rules: NaN, terms: player.terms.map(() => NaN) }),
      close: () => {},
    });
  };
})();
