// libevo in WebAssembly (bindings/web/player.h) as an object of JavaScript. The same in a page, in a
// Worker and in Node.
'use strict';
(typeof globalThis.Evo === 'object' ? globalThis.Evo : (globalThis.Evo = {})).load = async (bytes, files = {}) => {
  const encoder = new TextEncoder(), decoder = new TextDecoder();
  let exports;
  const memory = () => new Uint8Array(exports.memory.buffer);
  const put = (text) => {
    const data = encoder.encode(text);
    const at = exports.malloc(data.length + 1);
    memory().set(data, at);
    memory()[at + data.length] = 0;
    return at;
  };
  const get = (at) => {
    const all = memory();
    return decoder.decode(all.subarray(at, all.indexOf(0, at)));
  };
  // Calls with texts and numbers; texts are freed afterwards.
  const call = (name, ...given) => {
    const texts = [];
    const values = given.map((each) => {
      if (typeof each !== 'string') return each ?? 0;
      texts.push(put(each));
      return texts[texts.length - 1];
    });
    const result = exports[name](...values);
    texts.forEach((at) => exports.free(at));
    return result;
  };
  const answer = () => get(exports.evo_answer());
  const refuse = () => Object.assign(new Error(answer()), { name: 'Refusal' });
  const ask = (name, ...given) => {
    if (call(name, ...given) !== 0) throw refuse();
    const text = answer();
    return text ? JSON.parse(text) : undefined;
  };

  // All that the module asks of its surroundings (tests/web/module.mjs holds the list). There
  // are no files, no environment and no way out.
  const missing = -44;  // ENOENT
  const imports = {
    env: {
      evo_page_read_yaml: (at, length) =>
        put(JSON.stringify(globalThis.Evo.readYaml(decoder.decode(memory().subarray(at, at + length))))),
      emscripten_notify_memory_growth: () => {},
      __syscall_stat64: () => missing,
    },
    wasi_snapshot_preview1: {
      environ_sizes_get: (count, size) => {
        new DataView(exports.memory.buffer).setUint32(count, 0, true);
        new DataView(exports.memory.buffer).setUint32(size, 0, true);
        return 0;
      },
      environ_get: () => 0,
      proc_exit: (status) => { throw new Error(`the module ended with status ${status}`); },
    },
  };
  const module = await WebAssembly.compile(bytes);
  exports = (await WebAssembly.instantiate(module, imports)).exports;
  exports._initialize();
  for (const [path, text] of Object.entries(files)) call('evo_give_file', path, text);

  const opened = (task, robot) => {
    const player = call('evo_open', task, robot);
    if (player === 0) throw refuse();
    const facts = ask('evo_describe', player);
    const view = (at, length) => new Float64Array(exports.memory.buffer, at, length);
    return {
      ...facts,
      control: (controller) => ask('evo_control', player, typeof controller === 'string' ? controller : JSON.stringify(controller)),
      reset: ({ seed = 0, draws = null } = {}) => ask('evo_reset', player, seed, draws && JSON.stringify(draws)),
      step: (most = 1) => ask('evo_step', player, most),
      // Views into the module's memory: valid until the next call of anything.
      positions: () => view(exports.evo_positions(player), 2 * facts.points),
      counts: () => {
        const all = view(exports.evo_counts(player), 6 + facts.terms);
        return { total: all[0], reward: all[1], steps: all[2], ended: all[3], folding: all[4], rules: all[5], terms: [...all.subarray(6)] };
      },
      close: () => call('evo_close', player),
    };
  };
  return {
    robot: (text) => ask('evo_robot', text),
    sample: (rows, columns, seed) => ask('evo_sample', rows, columns, seed),
    mutate: (robot, rate, seed) => ask('evo_mutate', typeof robot === 'string' ? robot : JSON.stringify(robot), rate, seed),
    task: (text) => ask('evo_task', text),
    open: (task, robot) => opened(task, typeof robot === 'string' ? robot : JSON.stringify(robot)),
  };
};
// How an episode ended, by counts().ended.
globalThis.Evo.endings = ['', 'over: a rule of the task', 'over: time is up', 'over: the sequence is', 'over: the robot folded onto itself', 'goal reached'];
