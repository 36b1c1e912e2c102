// The panel: numbers, tables and the log. Only text is set, never markup: what a service says is shown, not run.

const $ = id => document.getElementById(id);
const LOG_LINES = 200;
const LEVELS = {1: "debug", 2: "info", 3: "warning", 4: "error", 5: "error"};

// Counters that tell of something wrong where they are not 0, by the status' groups (docs/service.md).
const TROUBLES = {
  filter: ["skipped", "undrawn", "lost", "degenerate", "too_few_rays", "outside_map"],
  odometry: ["not_finite", "ran_back", "gaps", "implausible", "lost_to_full_rings"],
  map: ["refused", "problem", "tiles_lost"],
  output: ["lost", "jumps", "unsent", "bus_error", "bus_offs", "send_timeouts", "queue_full"],
  recording: ["lost", "unrecorded", "problem"],
};

export function element(name, className, text) {
  const made = document.createElement(name);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

function set(id, text) {
  const at = $(id);
  if (at.textContent !== text) at.textContent = text;
}

const fixed = (value, digits) => Number.isFinite(value) ? value.toFixed(digits) : "–";
export const degrees = rad => rad * 180 / Math.PI;
export const clock = s => `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, "0")}`;

export function wrapped(rad) { return Math.atan2(Math.sin(rad), Math.cos(rad)); }

// µs that are read at a glance.
function time(us) {
  if (!(us > 0)) return "–";
  return us < 1000 ? us.toFixed(0) + " µs" : (us / 1000).toFixed(us < 10000 ? 1 : 0) + " ms";
}

// When a status' counters were what they are [s], by the service's clock or the recording's.
function takenAt(status) { return status.uptime_s ?? status.timestamp.sec + 1e-9 * status.timestamp.nsec; }

// Standard deviations along and across the heading [m].
function sigmas([xx, xy, yy], heading) {
  const c = Math.cos(heading), s = Math.sin(heading);
  const along = c * c * xx + 2 * c * s * xy + s * s * yy, across = s * s * xx - 2 * c * s * xy + c * c * yy;
  return [along, across].map(v => Math.sqrt(Math.max(v, 0)));
}

export class Panel {
  constructor() {
    this.before = null;          // a status of a second ago
    this.rateOf = () => NaN;     // events a second of a counter since then; NaN: not known
    this.scans = [];             // of the last two seconds
  }

  // A message of /match.
  showScan(scan, t) {
    const heading = degrees(wrapped(scan.heading_rad));
    const x = fixed(scan.x_m, 2), y = fixed(scan.y_m, 2), h = fixed(heading, 1) + "°";
    for (const [id, text] of [["x", x + " m"], ["y", y + " m"], ["heading", h], ["bar-x", "x " + x], ["bar-y", "y " + y], ["bar-heading", h]]) set(id, text);
    const [along, across] = sigmas(scan.covariance, scan.heading_rad);
    set("sigma", `${fixed(1000 * along, 0)}, ${fixed(1000 * across, 0)} mm`);
    set("sigma-heading", fixed(degrees(Math.sqrt(Math.max(scan.covariance[5], 0))), 2) + "°");
    set("M", fixed(scan.M, 0));
    set("m", scan.matched ? fixed(scan.m, 0) : "not matched");
    set("rays", `${scan.rays}, ${scan.critical_rays}`);
    set("search", `${scan.evaluations} evaluations`);
    set("width", `±${fixed(100 * scan.range_m, 1)} cm`);
    set("turn", `±${fixed(degrees(scan.range_rad), 2)}°`);
    this.move(scan, t);
  }

  // Speeds from the poses of the last half second.
  move(scan, t) {
    if (this.scans.length > 0 && t < this.scans.at(-1).t) this.scans = [];
    this.scans.push({t, x: scan.x_m, y: scan.y_m, heading: scan.heading_rad});
    while (this.scans[0].t < t - 2) this.scans.shift();
    const from = this.scans.find(s => s.t >= t - 0.5) ?? this.scans[0], dt = t - from.t;
    if (!(dt > 0.05)) return;
    const along = (scan.x_m - from.x) * Math.cos(scan.heading_rad) + (scan.y_m - from.y) * Math.sin(scan.heading_rad);
    set("v", fixed(along / dt, 2) + " m/s");
    set("w", fixed(degrees(wrapped(scan.heading_rad - from.heading)) / dt, 1) + " °/s");
  }

  // A message of /status.
  showStatus(status) {
    const elapsed = this.before ? takenAt(status) - takenAt(this.before) : -1;
    if (elapsed < 0) {
      this.before = status;
      this.rateOf = () => NaN;
    } else if (elapsed > 0.9) {
      const before = this.before;
      this.rateOf = pick => (pick(status) - pick(before)) / elapsed;
      this.before = status;
    }
    this.showRates(status);
    this.showSensors(status);
    this.showThreads(status.threads ?? []);
    this.showTroubles(status);
  }

  showRates(status) {
    const rates = [
      ["scans", this.rateOf(s => s.filter?.scans)], ["drawn", this.rateOf(s => s.map?.drawn)],
      ["odometry", this.rateOf(s => s.odometry?.samples)], ["poses sent", this.rateOf(s => s.output?.poses)],
    ].filter(([, rate]) => Number.isFinite(rate)).map(([name, rate]) => [name, fixed(rate, 1) + " /s"]);
    if (status.process) rates.push(["processor", fixed(100 * this.rateOf(s => s.process.cpu_s), 1) + " %"]);
    if (status.map) rates.push(["map tiles", `${status.map.tiles} of ${status.map.tiles_max}`]);
    $("rates").replaceChildren(...rates.map(([name, rate]) => {
      const row = element("div");
      row.append(element("dt", "", name), element("dd", "", rate));
      return row;
    }));
  }

  showSensors(status) {
    const sources = status.sources ?? [];
    $("sensors-section").hidden = sources.length === 0;
    const rows = sources.map((source, i) => {
      const state = source.state ?? "";
      const row = element("li", "sensor " + state);
      const rate = this.rateOf(s => s.sources?.[i]?.samples);
      row.append(element("span", "name", source.name));
      if (state) row.append(element("span", "chip " + (state === "ok" ? "good" : state === "starting" ? "" : "bad"), state));
      row.append(element("span", "number", Number.isFinite(rate) ? fixed(rate, 1) + " /s" : source.samples + " samples"));
      const says = source.says ?? "";
      if (says) row.append(element("p", "says", says));
      return row;
    });
    $("sensors").replaceChildren(...rows);
  }
  showThreads(threads) {
    $("threads-section").hidden = threads.length === 0;
    $("threads").tBodies[0].replaceChildren(...threads.map(thread => {
      const row = element("tr");
      row.append(element("th", "", thread.name), element("td", "bar"), element("td", "number", time(thread.p999_below_us)),
                 element("td", "number" + (thread.misses > 0 ? " warn" : ""), thread.alive === false ? "STUCK" : String(thread.misses)));
      row.cells[0].scope = "row";
      row.cells[1].append(latencyHistogram(thread));
      return row;
    }));
  }

  showTroubles(status) {
    const found = [];
    for (const [group, names] of Object.entries(TROUBLES)) {
      for (const name of names) {
        const value = status[group]?.[name];
        if (value) found.push([group + "." + name, String(value)]);
      }
    }
    $("troubles-section").hidden = false;
    $("troubles").replaceChildren(...(found.length === 0 ? [element("li", "none", "none")] : found.map(([name, value]) => {
      const row = element("li");
      row.append(element("span", "name", name), element("span", "number", value));
      return row;
    })));
  }

  // A message of /log.
  showLine(line) {
    const log = $("log"), atEnd = log.scrollTop + log.clientHeight > log.scrollHeight - 30;
    const row = element("li", LEVELS[line.level] ?? "info");
    const stamp = line.timestamp.sec > 0 ? new Date(1000 * line.timestamp.sec).toLocaleTimeString() : "";
    row.append(element("time", "", stamp), element("span", "", line.message));
    log.append(row);
    while (log.children.length > LOG_LINES) log.firstChild.remove();
    if (atEnd) log.scrollTop = log.scrollHeight;
  }
}

// 10 µs to 100 ms, how often on a logarithmic scale, too, or the slowest would not be seen; marks at the median, at 99.9 % and
// at the deadline.
function latencyHistogram(thread) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 100 24");
  svg.setAttribute("preserveAspectRatio", "none");
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", `median below ${time(thread.median_below_us)}, at most ${time(thread.max_us)}, deadline ${time(thread.deadline_us)}`);
  const at = us => Math.min(Math.max(25 * Math.log10(Math.max(us, 1) / 10), 0.5), 100);
  const rect = (className, x, y, width, height) => {
    const made = document.createElementNS(svg.namespaceURI, "rect");
    for (const [name, value] of Object.entries({class: className, x, y, width, height})) made.setAttribute(name, value);
    svg.append(made);
  };
  const mark = (className, us) => rect(className, at(us) - 0.6, 0, 1.2, 24);
  rect("back", 0, 0, 100, 24);
  for (const decade of [25, 50, 75]) rect("decade", decade, 0, 0.4, 24);
  const steps = thread.histogram_us ?? [], most = Math.max(1, ...steps.map(([, , count]) => count));
  for (const [from, below, count] of steps) {
    const height = 22 * Math.log1p(count) / Math.log1p(most);
    rect("count", at(from), 24 - height, Math.max(at(below) - at(from) - 0.4, 0.5), height);
  }
  if (steps.length > 0) {
    mark("median", thread.median_below_us);
    mark("p999", thread.p999_below_us);
  }
  if (thread.deadline_us > 0) mark("deadline", thread.deadline_us);
  return svg;
}
