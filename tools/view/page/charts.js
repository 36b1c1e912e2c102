// Curves of the last minute, drawn when they have changed and are seen.

const WINDOW_S = 60, SAMPLES_MAX = 6000;
const LABELS = 80;  // pixels beside the curves
const M_MAX = 2975;  // (10) cannot give more

// What /match has said, a window of it.
export class History {
  constructor() { this.samples = []; }
  // sample: {t, ...}, t in seconds
  add(sample) {
    const last = this.samples.at(-1);
    if (last && sample.t < last.t) this.samples = [];  // played again from the start
    this.samples.push(sample);
    const from = sample.t - WINDOW_S;
    let drop = 0;
    while (this.samples[drop].t < from) ++drop;
    if (drop > 200 || this.samples.length > SAMPLES_MAX) this.samples.splice(0, Math.max(drop, 1));
  }
  get end() { return this.samples.at(-1)?.t ?? 0; }
}

class Chart {
  constructor(canvas, history) {
    this.canvas = canvas;
    this.history = history;
    this.colours = {};
    this.seen = true;
    this.pending = false;
    new IntersectionObserver(([entry]) => { this.seen = entry.isIntersecting; this.changed(); }).observe(canvas);
    new ResizeObserver(() => this.resize()).observe(canvas);
  }
  resize() {
    this.dpr = Math.min(window.devicePixelRatio || 1, 3);
    this.canvas.width = Math.max(1, Math.round(this.canvas.clientWidth * this.dpr));
    this.canvas.height = Math.max(1, Math.round(this.canvas.clientHeight * this.dpr));
    this.draw();
  }
  changed() {
    if (this.pending || !this.seen) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.draw(); });
  }
  begin() {
    const c = this.canvas.getContext("2d");
    c.setTransform(1, 0, 0, 1, 0, 0);
    c.clearRect(0, 0, this.canvas.width, this.canvas.height);
    c.setTransform(this.dpr, 0, 0, this.dpr, 0, 0);
    c.font = "12px system-ui, sans-serif";
    c.textBaseline = "middle";
    return c;
  }
  get width() { return this.canvas.width / this.dpr; }
  get height() { return this.canvas.height / this.dpr; }
  x(t, right) { return right - (this.history.end - t) / WINDOW_S * right; }
  // Breaks where there is nothing to show.
  curve(c, right, y, value) {
    c.beginPath();
    let on = false;
    for (const sample of this.history.samples) {
      const v = value(sample);
      if (v === null) { on = false; continue; }
      const x = this.x(sample.t, right);
      if (on) c.lineTo(x, y(v)); else c.moveTo(x, y(v));
      on = true;
    }
    c.stroke();
  }
}

export class MatchChart extends Chart {
  draw() {
    if (!this.dpr) return;
    const c = this.begin(), right = this.width - LABELS, bands = 32, bottom = this.height - bands - 6;
    const y = v => bottom - Math.min(Math.max(v / M_MAX, 0), 1) * (bottom - 6);
    c.fillStyle = this.colours.plot;
    c.fillRect(0, 0, right, bottom);
    const thresholds = this.history.samples.at(-1)?.thresholds;
    if (thresholds) this.drawThresholds(c, right, y, bottom, thresholds);
    c.strokeStyle = this.colours.m;
    c.lineWidth = 1;
    this.curve(c, right, y, s => s.matched ? s.m : null);
    c.strokeStyle = this.colours.M;
    c.lineWidth = 2;
    this.curve(c, right, y, s => s.M);
    this.drawBand(c, right, bottom + 6, "Result", s => s.result, this.colours.result);
    this.drawBand(c, right, bottom + 22, "Draw", s => s.draw, this.colours.draw);
  }

  drawThresholds(c, right, y, bottom, thresholds) {
    const lines = [["Result on", thresholds.result_on, this.colours.result, []], ["Result off", thresholds.result_off, this.colours.result, [4, 4]],
                   ["Draw on", thresholds.draw_on, this.colours.draw, []], ["Draw off", thresholds.draw_off, this.colours.draw, [4, 4]]]
      .sort((a, b) => b[1] - a[1]);
    let above = -Infinity;  // labels do not cover each other, from the top down
    const room = lines.length * 14;
    for (const [i, [name, value, colour, dash]] of lines.entries()) {
      const at = y(value);
      c.strokeStyle = colour;
      c.lineWidth = 1.5;
      c.setLineDash(dash);
      c.beginPath();
      c.moveTo(0, at); c.lineTo(right, at);
      c.stroke();
      c.setLineDash([]);
      const label = Math.min(Math.max(at, above + 14, 7), bottom - room + 14 * i + 7);
      c.fillStyle = colour;
      c.fillText(name, right + 8, label);
      above = label;
    }
  }

  drawBand(c, right, top, name, on, colour) {
    c.fillStyle = this.colours.plot;
    c.fillRect(0, top, right, 11);
    c.fillStyle = colour;
    const samples = this.history.samples;
    for (let i = 0; i < samples.length;) {
      if (!on(samples[i])) { ++i; continue; }
      let end = i;
      while (end + 1 < samples.length && on(samples[end + 1])) ++end;
      const x0 = Math.max(0, this.x(samples[i].t, right)), x1 = this.x(samples[Math.min(end + 1, samples.length - 1)].t, right);
      c.fillRect(x0, top, Math.max(x1 - x0, 1), 11);
      i = end + 1;
    }
    c.fillText(name, right + 8, top + 6);
  }
}

export class LineChart extends Chart {
  // value: of a sample; text: of a value, for the greatest on the scale
  constructor(canvas, history, label, value, text) {
    super(canvas, history);
    this.label = label;
    this.value = value;
    this.text = text;
  }
  draw() {
    if (!this.dpr) return;
    const c = this.begin(), right = this.width - LABELS, bottom = this.height - 4;
    let top = 0;
    for (const sample of this.history.samples) top = Math.max(top, this.value(sample) ?? 0);
    top = top > 0 ? 1.15 * top : 1;
    c.fillStyle = this.colours.plot;
    c.fillRect(0, 0, right, bottom);
    c.strokeStyle = this.colours.M;
    c.lineWidth = 1.5;
    this.curve(c, right, v => bottom - v / top * (bottom - 2) - 1, this.value);
    c.fillStyle = this.colours.label;
    c.fillText(this.label, right + 8, 8);
    c.fillText("≤ " + this.text(top / 1.15), right + 8, bottom - 7);
  }
}
