// The map's canvas: what is on it, and the fingers, mouse and keys that move it. Lengths on the screen are in its own pixels.

const SCALE_MIN = 0.5, SCALE_MAX = 2000;  // pixels a metre
const FIRST_WIDTH_M = 22;                 // of the shorter side, at the beginning
const SIGMAS = 3;

class Camera {
  constructor() { this.x = 0; this.y = 0; this.scale = 30; this.width = 1; this.height = 1; }
  screenX(x) { return this.width / 2 + (x - this.x) * this.scale; }
  screenY(y) { return this.height / 2 - (y - this.y) * this.scale; }
  worldX(sx) { return this.x + (sx - this.width / 2) / this.scale; }
  worldY(sy) { return this.y - (sy - this.height / 2) / this.scale; }
  // The place below (sx, sy) stays there.
  zoom(factor, sx, sy) {
    const x = this.worldX(sx), y = this.worldY(sy);
    this.scale = Math.min(SCALE_MAX, Math.max(SCALE_MIN, this.scale * factor));
    this.x = x - (sx - this.width / 2) / this.scale;
    this.y = y + (sy - this.height / 2) / this.scale;
  }
}

// 1, 2 or 5 times a power of ten, the least that is not below `value`.
function niceStep(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [1, 2, 5, 10].find(step => step * power >= value) * power;
}

export class MapView extends EventTarget {
  // Events: "follow" (on or off), "placed" (a pose that was shown by hand, or null), "measured" (text).
  constructor(canvas, tiles) {
    super();
    this.canvas = canvas;
    this.context = canvas.getContext("2d", {alpha: false});
    this.tiles = tiles;
    this.camera = new Camera();
    this.follow = true;
    this.tool = "move";  // or "measure", "pose"
    this.robot = null;   // {x_m, y_m, heading_rad, covariance}
    this.lost = false;
    this.path = [];      // [x, y] in turn, in metres
    this.scan = null;    // {pose, points: Float32Array of x, y, critical (1 or 0)}
    this.drawn = null;   // what a tool has drawn: {x0, y0, x1, y1}
    this.pointers = new Map();
    this.pending = false;
    this.colours = {};
    new ResizeObserver(() => this.resize()).observe(canvas);
    for (const type of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) {
      canvas.addEventListener(type, event => this[type](event));
    }
    canvas.addEventListener("wheel", event => this.wheel(event), {passive: false});
    this.resize();
    this.camera.scale = Math.min(this.camera.width, this.camera.height) / FIRST_WIDTH_M;
  }

  // Before the next picture of the screen, once.
  changed() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.draw(); });
  }

  resize() {
    this.dpr = Math.min(window.devicePixelRatio || 1, 3);
    const width = Math.max(1, Math.round(this.canvas.clientWidth * this.dpr));
    const height = Math.max(1, Math.round(this.canvas.clientHeight * this.dpr));
    if (width === this.canvas.width && height === this.canvas.height) return;
    this.canvas.width = this.camera.width = width;
    this.canvas.height = this.camera.height = height;
    this.draw();  // at once: a canvas that is resized is empty
  }

  setFollow(on) {
    if (this.follow === on) return;
    this.follow = on;
    this.dispatchEvent(new CustomEvent("follow", {detail: on}));
    this.changed();
  }

  setTool(tool) {
    this.tool = tool;
    this.drawn = null;
    this.canvas.classList.toggle("aiming", tool !== "move");
    this.dispatchEvent(new CustomEvent("measured", {detail: ""}));
    this.changed();
  }

  fit() {
    const bounds = this.tiles.bounds();
    if (!bounds) return;
    this.setFollow(false);
    const [x0, y0, x1, y1] = bounds, {camera, dpr} = this;
    // What lies above the canvas at its edges covers nothing: [left, top, right, bottom].
    const [left, top, right, bottom] = [72, 12, 12, (this.bottomPx ?? 16) + 28].map(px => px * dpr);
    const width = Math.max(camera.width - left - right, 1), height = Math.max(camera.height - top - bottom, 1);
    const scale = Math.min(width / (x1 - x0), height / (y1 - y0));
    camera.scale = Math.min(SCALE_MAX, Math.max(SCALE_MIN, scale));
    camera.x = (x0 + x1) / 2 - (left - right) / 2 / camera.scale;
    camera.y = (y0 + y1) / 2 - (bottom - top) / 2 / camera.scale;
    this.changed();
  }

  zoom(factor, sx = this.camera.width / 2, sy = this.camera.height / 2) {
    this.camera.zoom(factor, sx, sy);
    this.changed();
  }

  pan(dx, dy) {
    this.setFollow(false);
    this.camera.x -= dx / this.camera.scale;
    this.camera.y += dy / this.camera.scale;
    this.changed();
  }

  // --- by hand

  place(event) {
    const box = this.canvas.getBoundingClientRect();
    return {x: (event.clientX - box.left) * this.dpr, y: (event.clientY - box.top) * this.dpr};
  }

  pointerdown(event) {
    const at = this.place(event);
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, at);
    if (this.tool === "move" || this.pointers.size > 1) return;
    const x = this.camera.worldX(at.x), y = this.camera.worldY(at.y);
    this.drawn = {x0: x, y0: y, x1: x, y1: y};
    this.changed();
  }

  pointermove(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = this.place(event);
    if (this.pointers.size >= 2) {
      this.pinch(event.pointerId, before, now);
    } else if (this.tool === "move") {
      this.pan(now.x - before.x, now.y - before.y);
    } else if (this.drawn) {
      this.drawn.x1 = this.camera.worldX(now.x);
      this.drawn.y1 = this.camera.worldY(now.y);
      this.tell();
      this.changed();
    }
    this.pointers.set(event.pointerId, now);
  }

  pinch(id, before, now) {
    const other = [...this.pointers].find(([key]) => key !== id)[1];
    const apart = p => Math.hypot(p.x - other.x, p.y - other.y);
    if (!this.follow) this.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
    if (apart(before) > 1) this.zoom(apart(now) / apart(before), (now.x + other.x) / 2, (now.y + other.y) / 2);
  }

  pointerup(event) {
    this.pointers.delete(event.pointerId);
    if (this.tool === "pose" && this.drawn && this.pointers.size === 0) {
      const {x0, y0, x1, y1} = this.drawn;
      const heading_rad = Math.hypot(x1 - x0, y1 - y0) * this.camera.scale > 8 * this.dpr
        ? Math.atan2(y1 - y0, x1 - x0) : this.robot?.heading_rad ?? 0;
      this.dispatchEvent(new CustomEvent("placed", {detail: {x_m: x0, y_m: y0, heading_rad}}));
    }
  }

  pointercancel(event) { this.pointers.delete(event.pointerId); }

  wheel(event) {
    event.preventDefault();
    const at = this.place(event);
    const step = event.deltaMode === 0 ? event.deltaY : 33 * event.deltaY;  // pixels, or lines
    this.zoom(Math.exp(-0.0016 * step), at.x, at.y);
  }

  tell() {
    const {x0, y0, x1, y1} = this.drawn, dx = x1 - x0, dy = y1 - y0;
    const text = `${Math.hypot(dx, dy).toFixed(2)} m   Δx ${dx.toFixed(2)}   Δy ${dy.toFixed(2)}`;
    if (this.tool === "measure") this.dispatchEvent(new CustomEvent("measured", {detail: text}));
  }

  // --- drawing

  draw() {
    const {context: c, camera} = this;
    if (this.follow && this.robot) { camera.x = this.robot.x_m; camera.y = this.robot.y_m; }
    c.fillStyle = this.colours.unseen ?? "#888";
    c.fillRect(0, 0, camera.width, camera.height);
    this.drawGrid(c);
    this.tiles.draw(c, camera, camera.width, camera.height);
    this.drawPath(c);
    if (this.scan) this.drawScan(c);
    if (this.robot) this.drawRobot(c, this.robot, this.lost ? this.colours.bad : this.colours.robot);
    if (this.drawn) this.drawTool(c);
    this.drawScale(c);
  }

  drawGrid(c) {
    const {camera} = this, step = niceStep(70 * this.dpr / camera.scale);
    c.strokeStyle = this.colours.grid;
    c.lineWidth = 1;
    c.beginPath();
    for (let x = Math.ceil(camera.worldX(0) / step) * step; camera.screenX(x) < camera.width; x += step) {
      const sx = Math.round(camera.screenX(x)) + 0.5;
      c.moveTo(sx, 0); c.lineTo(sx, camera.height);
    }
    for (let y = Math.ceil(camera.worldY(camera.height) / step) * step; camera.screenY(y) > 0; y += step) {
      const sy = Math.round(camera.screenY(y)) + 0.5;
      c.moveTo(0, sy); c.lineTo(camera.width, sy);
    }
    c.stroke();
  }

  drawPath(c) {
    if (this.path.length < 4) return;
    c.strokeStyle = this.colours.path;
    c.lineWidth = 2 * this.dpr;
    c.lineJoin = "round";
    c.beginPath();
    for (let i = 0; i < this.path.length; i += 2) {
      c.lineTo(this.camera.screenX(this.path[i]), this.camera.screenY(this.path[i + 1]));
    }
    if (this.robot) c.lineTo(this.camera.screenX(this.robot.x_m), this.camera.screenY(this.robot.y_m));
    c.stroke();
  }

  drawScan(c) {
    const {camera, scan: {pose, points}} = this;
    const cos = Math.cos(pose.heading_rad), sin = Math.sin(pose.heading_rad);
    const ox = camera.screenX(pose.x_m), oy = camera.screenY(pose.y_m);
    const side = Math.max(2, 1.6 * this.dpr), large = 2.4 * side;
    const each = (critical, what) => {
      for (let i = 0; i < points.length; i += 3) {
        if (points[i + 2] !== critical) continue;
        const x = points[i], y = points[i + 1];
        what(ox + (x * cos - y * sin) * camera.scale, oy - (x * sin + y * cos) * camera.scale);
      }
    };
    c.strokeStyle = this.colours.criticalRay;
    c.lineWidth = this.dpr;
    c.beginPath();
    each(1, (x, y) => { c.moveTo(ox, oy); c.lineTo(x, y); });
    c.stroke();
    c.fillStyle = this.colours.scan;
    each(0, (x, y) => c.fillRect(x - side / 2, y - side / 2, side, side));
    c.fillStyle = this.colours.critical;
    each(1, (x, y) => c.fillRect(x - large / 2, y - large / 2, large, large));
  }

  drawRobot(c, pose, colour) {
    const {camera} = this, x = camera.screenX(pose.x_m), y = camera.screenY(pose.y_m);
    if (pose.covariance) this.drawEllipse(c, x, y, pose.covariance, colour);
    const size = Math.max(13 * this.dpr, 0.28 * camera.scale);
    c.save();
    c.translate(x, y);
    c.rotate(-pose.heading_rad);
    c.beginPath();
    c.moveTo(size, 0); c.lineTo(-0.75 * size, 0.7 * size); c.lineTo(-0.4 * size, 0); c.lineTo(-0.75 * size, -0.7 * size);
    c.closePath();
    c.fillStyle = colour;
    c.strokeStyle = this.colours.outline;
    c.lineWidth = 2 * this.dpr;
    c.lineJoin = "round";
    c.stroke();
    c.fill();
    c.restore();
  }

  // Where the robot is but for three times in a thousand.
  drawEllipse(c, x, y, [xx, xy, yy], colour) {
    const mean = (xx + yy) / 2, spread = Math.hypot((xx - yy) / 2, xy);
    const [a, b] = [mean + spread, mean - spread].map(l => SIGMAS * Math.sqrt(Math.max(l, 0)) * this.camera.scale);
    if (!(a < 1e5)) return;
    c.beginPath();
    c.ellipse(x, y, a, b, -0.5 * Math.atan2(2 * xy, xx - yy), 0, 2 * Math.PI);
    c.globalAlpha = 0.25;
    c.fillStyle = colour;
    c.fill();
    c.globalAlpha = 1;
    c.strokeStyle = colour;
    c.lineWidth = 1.5 * this.dpr;
    c.stroke();
  }

  drawTool(c) {
    const {camera, drawn} = this;
    const x0 = camera.screenX(drawn.x0), y0 = camera.screenY(drawn.y0);
    const x1 = camera.screenX(drawn.x1), y1 = camera.screenY(drawn.y1);
    c.strokeStyle = this.colours.tool;
    c.fillStyle = this.colours.tool;
    c.lineWidth = 2.5 * this.dpr;
    c.beginPath();
    c.moveTo(x0, y0); c.lineTo(x1, y1);
    c.stroke();
    if (this.tool === "pose") {
      const heading_rad = x0 === x1 && y0 === y1 ? this.robot?.heading_rad ?? 0 : Math.atan2(y0 - y1, x1 - x0);
      this.drawRobot(c, {x_m: drawn.x0, y_m: drawn.y0, heading_rad}, this.colours.tool);
      return;
    }
    for (const [x, y] of [[x0, y0], [x1, y1]]) {
      c.beginPath();
      c.arc(x, y, 5 * this.dpr, 0, 2 * Math.PI);
      c.fill();
    }
  }

  drawScale(c) {
    const {camera, dpr} = this, metres = niceStep(60 * dpr / camera.scale), length = metres * camera.scale;
    const x = camera.width - length - 16 * dpr, y = camera.height - (this.bottomPx ?? 16) * dpr;
    const label = metres < 1 ? `${Math.round(100 * metres)} cm` : `${metres} m`;
    c.font = `${13 * dpr}px system-ui, sans-serif`;
    c.textAlign = "center";
    c.strokeStyle = this.colours.unseen;
    c.fillStyle = this.colours.text;
    c.lineWidth = 4 * dpr;
    c.strokeText(label, x + length / 2, y - 8 * dpr);
    c.fillText(label, x + length / 2, y - 8 * dpr);
    c.fillRect(x, y, length, 2 * dpr);
    c.fillRect(x, y - 5 * dpr, 2 * dpr, 7 * dpr);
    c.fillRect(x + length - 2 * dpr, y - 5 * dpr, 2 * dpr, 7 * dpr);
  }
}
