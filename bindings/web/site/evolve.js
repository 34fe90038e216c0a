// A small search, in a Worker: first for a gait of the given body, then for bodies and gaits.
// Everything follows from the seed, so that a search can be repeated. Gaits are rounded to
// three decimals: the numbers that `evo-eval --actions sine:` is given are the ones that were tried.
'use strict';
(() => {
  const episode = (evo, task, body, gait) => {
    let player;
    try {
      player = evo.open(task, { body });
      player.control({ kind: 'wave', amplitude: gait[0], period: gait[1], phase: gait[2] });
      player.reset();
      player.step(1e6);
      return player.counts().total;
    } catch (failure) {
      if (failure.name !== 'Refusal') throw failure;
      return -Infinity;  // a simulation that fails has no return
    } finally {
      player?.close();
    }
  };
  // Uniform numbers: the xorshift generator of 32 bits (Marsaglia, 2003), its first ones left
  // out since those of neighbouring seeds are alike.
  const numbers = (seed) => {
    let bits = Math.imul(seed, 2654435769) | 1;
    const next = () => {
      bits ^= bits << 13;
      bits ^= bits >>> 17;
      bits ^= bits << 5;
      return (bits >>> 0) / 2 ** 32;
    };
    for (let k = 0; k < 8; ++k) next();
    return next;
  };
  const round = (value) => Math.round(value * 1000) / 1000;
  const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
  const gaits = { low: [0.1, 6, 0], high: [0.5, 60, 6.283] };

  // Yields after every robot: {tried, best: {body, gait, total, tried}}.
  Evo.search = function* (evo, { task, body, gait, seed = 1, gaitTries = 24 }) {
    const random = numbers(seed);
    const anyGait = () => gaits.low.map((low, k) => round(low + (gaits.high[k] - low) * random()));
    const near = (from, share) => from.map((value, k) =>
      round(clamp(value + (gaits.high[k] - gaits.low[k]) * share * (random() + random() - 1), gaits.low[k], gaits.high[k])));
    let best = { body, gait, total: episode(evo, task, body, gait), tried: 1 };
    for (let tried = 1; ; ++tried) {
      yield { tried, best };
      const searchingGait = tried < gaitTries;
      let nextBody = best.body, nextGait;
      if (searchingGait) {
        nextGait = tried < gaitTries / 2 ? anyGait() : near(best.gait, 0.2);
      } else {
        if (random() < 0.75) nextBody = evo.mutate({ body: best.body }, 0.1, Math.floor(random() * 2 ** 31)).body;
        nextGait = random() < 0.6 ? near(best.gait, 0.15) : best.gait;
      }
      const total = episode(evo, task, nextBody, nextGait);
      if (total > best.total) best = { body: nextBody, gait: nextGait, total, tried: tried + 1 };
    }
  };

  // In a Worker: {module, files, search} begins; what is found comes back as it is found.
  if (typeof WorkerGlobalScope === 'undefined') return;
  onmessage = async ({ data: { module, files, search } }) => {
    try {
      const evo = await Evo.load(module, files);
      const began = Date.now();
      let told = 0;
      for (const state of Evo.search(evo, search)) {
        if (Date.now() - told > 80 || state.best.tried === state.tried) {
          told = Date.now();
          postMessage({ ...state, seconds: (told - began) / 1000 });
        }
        if (state.tried >= search.most || Date.now() - began > 1000 * search.seconds) break;
      }
      postMessage({ done: true });
    } catch (failure) {
      postMessage({ failed: failure.message });
    }
  };
})();
