// A robot at its task on a canvas: steps libevo in time with the screen and draws it. Between two
// steps it draws what lies between them, so that every frame of the screen shows another moment,
// in slow motion, too.
'use strict';
Evo.stepsPerSecond = 50;  // control steps at speed 1
Evo.Player = class {
  // `told` is called after every drawing, and once more when the episode is over.
  constructor(canvas, told) {
    Object.assign(this, { canvas, told, speed: 1, zoom: 1, playing: false, player: null, view: Evo.Stage.camera(), colors: Evo.Stage.look() });
    this.tick = this.tick.bind(this);
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.colors = Evo.Stage.look(); this.draw(); });
  }
  // Takes the player over, from its start.
  show(player, start = {}) {
    this.player?.close();
    this.player = player;
    this.start = start;
    player.reset(start);
    this.scene = Evo.Stage.sceneOf(player);
    this.followed = player.objects.filter((object) => player.follow.includes(object.name));
    this.view.reset();
    this.restart();
  }
  restart() {
    if (!this.player) return;
    this.player.reset(this.start);
    this.due = 0;
    this.rest = 0;
    this.before = null;
    this.draw();
  }
  play() {
    if (this.playing || !this.player) return;
    if (this.over) this.restart();
    this.playing = true;
    this.last = performance.now();
    requestAnimationFrame(this.tick);
    this.told(this);
  }
  pause() { this.playing = false; if (this.player) this.draw(); }
  step() { this.playing = false; this.player?.step(1); this.before = null; this.draw(); }
  get over() { return this.player !== null && this.player.counts().ended !== 0; }
  tick(now) {
    if (!this.playing) return;
    const passed = Math.min(0.1, (now - this.last) / 1000);
    this.last = now;
    if (this.over) {
      this.rest += passed;
      if (this.rest > 1.5) this.restart();
    } else {
      this.due += passed * Evo.stepsPerSecond * this.speed;
      const steps = Math.min(Math.floor(this.due), 60);
      this.due = Math.min(this.due - steps, 1);
      try {
        if (steps > 1) this.player.step(steps - 1);
        if (steps > 0) { this.before = this.player.positions().slice(); this.player.step(1); }
        this.draw(this.over ? 1 : this.due, passed);
      } catch (refusal) { this.pause(); throw refusal; }
    }
    requestAnimationFrame(this.tick);
  }
  // `share`: of the way from the step before to the last one. `passed`: seconds since the last frame.
  draw(share = 1, passed = Infinity) {
    const { player, canvas, before } = this;
    if (!player || !canvas.clientWidth) return;
    const raw = player.positions(), voxel = player.voxel;
    const x = new Float64Array(player.points), y = new Float64Array(player.points);
    const at = before && share < 1 ? (k) => (before[k] + (raw[k] - before[k]) * share) / voxel : (k) => raw[k] / voxel;
    for (let p = 0; p < player.points; ++p) { x[p] = at(2 * p); y[p] = at(2 * p + 1); }
    const centre = ({ first, points }) => {
      let cx = 0, cy = 0;
      for (let p = first; p < first + points; ++p) { cx += x[p]; cy += y[p]; }
      return [cx / points, cy / points];
    };
    const centres = (this.followed.length ? this.followed : player.objects.slice(0, 1)).map(centre);
    Evo.Stage.paint(canvas, this.scene, x, y, this.view.at(canvas, centres, this.zoom, passed), this.colors);
    this.told(this);
  }
};
