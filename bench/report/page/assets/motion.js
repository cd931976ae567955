"use strict";
(() => {
  const SLOWED = [1, 2, 5, 10, 20, 50, 100], LEFT = 80, RIGHT = 680, LEAP = 0.1; // px of the rail, as drawing.py has them; s
  const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const samples = async ({ offset, scale, low }) => Float32Array.from(await numbers(low), (k) => (k === NOTHING ? NaN : offset + scale * k));
  const figures = (value, unit) => (Number.isNaN(value) ? "not known" : value.toPrecision(4).replace(/-/g, "−") + " " + unit);

  // a frame: three rows of turn and place
  const FIXED = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0];
  const within = (a, b) => [0, 4, 8].flatMap((r) => [0, 1, 2, 3].map((c) =>
    a[r] * b[c] + a[r + 1] * b[c + 4] + a[r + 2] * b[c + 8] + (c === 3 ? a[r + 3] : 0)));
  const turned = ([w, x, y, z], [a, b, c]) => [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), a,
    2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), b, 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), c];
  const about = ([x, y, z], [a, b, c], angle) => {
    const half = Math.sin(angle / 2), turn = turned([Math.cos(angle / 2), half * x, half * y, half * z], [0, 0, 0]);
    return within([1, 0, 0, a, 0, 1, 0, b, 0, 0, 1, c], within(turn, [1, 0, 0, -a, 0, 1, 0, -b, 0, 0, 1, -c]));
  };

  class Robot { // drawn from behind to the front, in parallel
    static async of(figure, data, whole) {
      for (const shape of data.bodies.flatMap((body) => body.shapes)) {
        const [at, corners] = await Promise.all([shape.vertices, shape.faces].map(samples)), many = at.length / 3;
        Object.assign(shape, { corners, at: at.map((_, k) => at[Math.floor(k / 3) + (k % 3) * many]) });
      }
      return new Robot(figure, data, await Promise.all(data.poses.map(samples)), whole);
    }

    constructor(figure, data, poses, whole) {
      Object.assign(this, { data, poses });
      this.canvas = figure.querySelector("canvas");
      this.azimuth = figure.querySelector("[name=azimuth]");
      this.moved = new Set();
      data.bodies.forEach((body, k) => {
        if (body.joints.some((joint) => (whole ? joint.of !== null : joint.of === 0)) || (k > 0 && this.moved.has(body.parent))) this.moved.add(k);
      });
    }

    frame({ start, step, count }, position) { // how far it reaches, where it is measured
      const ends = [[Infinity, -Infinity], [Infinity, -Infinity], [Infinity, -Infinity]];
      for (let k = 0; k < count; k += Math.max(1, Math.floor(count / 40))) {
        if (Number.isNaN(position[k])) continue;
        const places = this.places(start + step * k, position[k]);
        this.data.bodies.forEach((body, b) => body.shapes.forEach((shape) => {
          for (let v = 0; v < shape.at.length; v += 3) this.seen(places[b], shape.at, v).forEach((x, i) => {
            ends[i] = [Math.min(ends[i][0], x), Math.max(ends[i][1], x)];
          });
        }));
      }
      this.middle = ends.map(([low, high]) => (low + high) / 2);
      const [x, y, z] = ends.map(([low, high]) => (high - low) / 2);
      [this.wide, this.high] = [Math.hypot(x, y) || 1, z];
    }

    seen(m, at, v) { // a vertex where the world has it
      return [0, 4, 8].map((r) => m[r] * at[v] + m[r + 1] * at[v + 1] + m[r + 2] * at[v + 2] + m[r + 3]);
    }

    places(time, own, others = [], times = 1) {
      const { bodies, ratio, start, step } = this.data, at = Math.max(0, (time - start) / step), found = [];
      const pose = (values) => {
        const k = Math.min(Math.floor(at), values.length - 2), share = Math.min(1, at - k);
        return values[k] + share * (values[k + 1] - values[k]);
      };
      bodies.forEach((body, b) => {
        let here = b === 0 ? FIXED : within(found[body.parent], turned(body.turn, body.place));
        for (const { of, axis, anchor, slides, zero } of body.joints) {
          const ahead = of > 0 && others.length ? pose(others[of - 1]) : 0; // where it is not known, as measured
          const by = of === null ? 0 : (of === 0 ? own / ratio : pose(this.poses[of - 1]) + times * (ahead || 0)) - zero;
          here = within(here, slides ? turned([1, 0, 0, 0], axis.map((x) => x * by)) : about(axis, anchor, by));
        }
        found.push(here);
      });
      return found;
    }

    draw(time, simulated, measured, others, times) {
      const size = this.canvas.clientWidth, dense = window.devicePixelRatio || 1, pen = this.canvas.getContext("2d");
      [this.canvas.width, this.canvas.height] = [size * dense, size * 0.75 * dense];
      const angle = (Number(this.azimuth.value) * Math.PI) / 180, tilt = 0.35;
      const [s, c, st, ct] = [Math.sin(angle), Math.cos(angle), Math.sin(tilt), Math.cos(tilt)];
      const scale = 0.47 * Math.min(this.canvas.width / this.wide, this.canvas.height / (ct * this.high + st * this.wide));
      const look = ([x, y, z]) => { // right, up, towards the eye
        const [a, b, d] = [x - this.middle[0], y - this.middle[1], z - this.middle[2]], far = -s * a + c * b;
        return [c * a + s * b, ct * d + st * far, st * d - ct * far];
      };
      const style = getComputedStyle(this.canvas), faces = [];
      const add = (places, colour, only) => this.data.bodies.forEach((body, b) => {
        if (only && !this.moved.has(b)) return;
        for (const shape of body.shapes) {
          const at = [];
          for (let v = 0; v < shape.at.length; v += 3) at.push(look(this.seen(places[b], shape.at, v)));
          for (let f = 0; f < shape.corners.length; f += 3) {
            const [p, q, r] = [at[shape.corners[f]], at[shape.corners[f + 1]], at[shape.corners[f + 2]]];
            const u = q.map((x, i) => x - p[i]), w = r.map((x, i) => x - p[i]);
            const n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]], long = Math.hypot(...n) || 1;
            const light = 0.45 + 0.55 * Math.abs((0.3 * n[0] + 0.55 * n[1] + 0.78 * n[2]) / long);
            faces.push([p[2] + q[2] + r[2], p, q, r, colour || `rgb(${shape.colour.map((x) => Math.round(255 * light * (0.15 + 0.85 * x)))})`]);
          }
        }
      });
      if (!Number.isNaN(simulated)) add(this.places(time, simulated, others, times), null, false);
      if (!Number.isNaN(measured)) add(this.places(time, measured), style.color, true);
      pen.translate(this.canvas.width / 2, this.canvas.height / 2);
      for (const [, p, q, r, colour] of faces.sort((one, other) => one[0] - other[0])) {
        pen.globalAlpha = colour === style.color ? 0.22 : 1;
        pen.fillStyle = pen.strokeStyle = colour;
        pen.beginPath();
        for (const [x, y] of [p, q, r]) pen.lineTo(x * scale, -y * scale);
        pen.closePath();
        pen.fill();
        if (pen.globalAlpha === 1) pen.stroke(); // no seam between faces
      }
    }
  }

  class Motion {
    static async of(figure) {
      const data = JSON.parse(figure.querySelector("script[type='application/json']").textContent), every = (of) => Promise.all(of.map(samples));
      const runs = await every(data.runs.map((run) => run.apart)), others = await Promise.all(data.runs.map((run) => every(run.others)));
      const robot = data.robot === null ? null : await Robot.of(figure, data.robot, others[0].length > 0);
      return new Motion(figure, { data, runs, others, robot, position: floats(data.position) });
    }

    constructor(figure, content) {
      Object.assign(this, content);
      this.run = figure.querySelector("[name=run]");
      if (this.robot) this.robot.frame(this.data, this.position);
      this.last = this.data.count - 1;
      this.at = 0; // in instants
      this.from = null; // moment and instant from which it plays; null while it pauses
      for (const name of ["stage", "readout", "play"]) this[name] = figure.querySelector("." + name);
      for (const name of ["simulated", "ghost"]) this[name] = this.stage.querySelector("." + name);
      this.label = figure.querySelector("output.slowed");
      this.instant = figure.querySelector("[name=instant]");
      this.slowed = figure.querySelector("[name=slowed]");
      this.times = figure.querySelectorAll("[type=radio]");
      for (const one of [this.run, this.robot && this.robot.azimuth]) if (one) one.addEventListener("input", () => this.draw());
      if (this.robot) window.addEventListener("resize", () => this.draw());
      this.slowed.value = SLOWED.indexOf(this.data.slowed);
      this.listen(figure);
      this.tempo();
      this.draw();
    }

    listen(figure) {
      const leap = Math.max(1, Math.round(LEAP / this.data.step));
      const faster = (by) => { this.slowed.value = Number(this.slowed.value) + by; this.tempo(); };
      const acts = { first: () => this.halt(0), back: () => this.halt(Math.ceil(this.at) - 1), on: () => this.halt(Math.floor(this.at) + 1),
        play: () => (this.from === null ? this.go() : this.halt(this.at)), faster: () => faster(-1), slower: () => faster(1),
        "leap back": () => this.halt(this.at - leap), "leap on": () => this.halt(this.at + leap) };
      const keys = { " ": "play", ArrowLeft: "back", ArrowRight: "on", "+": "faster", "=": "faster", "-": "slower", "0": "first", Home: "first" };
      figure.querySelectorAll("button").forEach((button) => button.addEventListener("click", acts[button.dataset.do]));
      figure.querySelector("form").addEventListener("submit", (event) => event.preventDefault());
      this.instant.addEventListener("input", () => this.halt(Number(this.instant.value)));
      this.slowed.addEventListener("input", () => this.tempo());
      this.times.forEach((one) => one.addEventListener("change", () => this.draw()));
      this.stage.addEventListener("click", () => this.stage.focus({ preventScroll: true }));
      this.stage.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
        event.preventDefault();
        const act = keys[event.key];
        acts[event.shiftKey && (act === "back" || act === "on") ? "leap " + act : act]();
      });
    }

    tempo() {
      const slowed = SLOWED[Number(this.slowed.value)];
      this.label.value = slowed === 1 ? "real time" : slowed + " times slower";
      this.slowed.setAttribute("aria-valuetext", this.label.value);
      this.perSecond = 1 / (slowed * this.data.step);
      if (this.from !== null) this.from = [performance.now(), this.at];
    }

    go() {
      if (this.at >= this.last) this.at = 0;
      this.from = [performance.now(), this.at];
      this.play.textContent = "halt";
      requestAnimationFrame((now) => this.frame(now));
    }

    frame(now) {
      if (this.from === null) return;
      const [moment, instant] = this.from;
      this.at = Math.min(this.last, instant + (Math.max(0, now - moment) / 1000) * this.perSecond);
      if (this.at === this.last) return this.halt(this.last);
      this.draw();
      requestAnimationFrame((next) => this.frame(next));
    }

    halt(instant) {
      this.from = null;
      this.at = Math.min(this.last, Math.max(0, instant));
      this.play.textContent = "play";
      this.draw();
    }

    read(values) { // between instants: on the straight line, as far as both are known
      const before = Math.floor(this.at), share = this.at - before;
      return share === 0 ? values[before] : values[before] + share * (values[before + 1] - values[before]);
    }

    draw() {
      const { start, step, unit, turns, ghost } = this.data, time = start + step * this.at;
      const run = this.run ? Number(this.run.value) : 0;
      const at = this.read(this.position), ahead = this.read(this.runs[run]);
      const times = Number([...this.times].find((one) => one.checked).value);
      if (this.robot) this.robot.draw(time, at + times * ahead, at, this.others[run], times);
      else {
        this.put(this.ghost, at);
        this.put(this.simulated, at + times * ahead);
      }
      const seconds = time.toFixed(Math.min(6, Math.max(3, Math.ceil(-Math.log10(step))))) + " s";
      this.instant.value = Math.round(this.at);
      this.instant.setAttribute("aria-valuetext", seconds);
      const degrees = turns && !Number.isNaN(ahead) ? " (" + ((ahead * 180) / Math.PI).toPrecision(3).replace(/-/g, "−") + "°)" : "";
      const texts = ["at " + seconds, ghost + " " + figures(at, unit), "simulated " + figures(at + ahead, unit),
        "simulated less " + ghost + " " + figures(ahead, unit) + degrees];
      this.readout.replaceChildren(...texts.map((text) => Object.assign(document.createElement("span"), { textContent: text })));
      window.dispatchEvent(new CustomEvent("instant", { detail: time }));
    }

    put(part, position) {
      const { turns, low, high } = this.data;
      part.classList.toggle("unknown", Number.isNaN(position));
      if (Number.isNaN(position)) return;
      const moved = turns
        ? `rotate(${((-position * 180) / Math.PI) % 360})`
        : `translate(${LEFT + ((position - low) / (high - low)) * (RIGHT - LEFT)})`;
      part.setAttribute("transform", moved);
    }
  }

  document.querySelectorAll("figure.moving").forEach(Motion.of);
})();
