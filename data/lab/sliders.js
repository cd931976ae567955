"use strict";
// Sliders in the course's report: tasks 8 to 11 worked out anew in the page, as bench/course does, and drawn over what
// stands there. In SI; without this script the page is the report as it is.
(() => {
  const data = JSON.parse(document.getElementById("live").textContent), RPM = 30 / Math.PI, KG_CM2 = 1e4;
  const floats = (text) => new Float64Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const largest = (values) => { let most = -Infinity; for (let k = 0; k < values.length; k++) if (values[k] > most) most = values[k]; return most; };
  const rms = (values) => Math.sqrt(values.reduce((sum, x) => sum + x * x, 0) / values.length);
  const first = (values, holds, from = 0) => { for (let k = from; k < values.length; k++) if (holds(values[k], k)) return k; return -1; };
  const median = (values) => {
    const sorted = Float64Array.from(values).sort(), half = sorted.length / 2;
    return (sorted[Math.floor(half - 0.5)] + sorted[Math.floor(half)]) / 2;
  };
  const line = (x, y) => { // slope and offset of least squares
    const middle = (values) => values.reduce((a, b) => a + b, 0) / values.length, a = middle(x), b = middle(y);
    const slope = x.reduce((sum, v, k) => sum + (v - a) * (y[k] - b), 0) / x.reduce((sum, v) => sum + (v - a) ** 2, 0);
    return [slope, b - slope * a];
  };
  const gradient = (values, step, k) => {
    const low = Math.max(k - 1, 0), high = Math.min(k + 1, values.length - 1);
    return (values[high] - values[low]) / (step * (high - low));
  };
  const range = (from, to, by = 1) => { const found = []; for (let k = from; k < to; k += by) found.push(k); return found; };

  // Tasks 8 and 9: the filtered acceleration, later than on t_sync by some samples, and the fast samples.
  function friction({ late, least, kT }) {
    const { period, width, delay, kernels } = data.friction, { velocity, torque } = data.friction;
    const count = velocity.length, time = (k) => k * period;
    const mean = (i) => { // differences that end with sample i + width
      const at = Math.floor(i), share = i - at;
      const of = (k) => (velocity[k + width] - velocity[k]) / (width * period);
      return share ? (1 - share) * of(at) + share * of(at + 1) : of(at);
    };
    const from = Math.ceil(width - delay + late), to = Math.min(count, Math.floor(count - delay + late));
    const sync = range(Math.max(from, 0), to), alpha = Float64Array.from(velocity, (_, k) => gradient(velocity, period, k));
    for (const k of sync) alpha[k] = mean(k - width + delay - late);
    const fast = sync.filter((k) => Math.abs(velocity[k]) >= least), M = torque.map((value) => kT * value);
    const smooth = (values, order) => {
      const kernel = kernels[order];
      return range(0, values.length - kernel.length + 1).map((k) => kernel.reduce((sum, weight, j) => sum + weight * values[k + j], 0));
    };
    const speed = sync.map((k) => velocity[k]), bend = smooth(speed, 2), slope = smooth(speed, 1);
    const behind = smooth(sync.map((k) => alpha[k]), 0).map((value, k) => slope[k] - value);
    const lateness = behind.reduce((sum, value, k) => sum + value * bend[k], 0) / bend.reduce((sum, b) => sum + b * b, 0) / period;
    return { velocity, M, time, sync, alpha, fast, period, count, lateness, ...identified(velocity, alpha, M, fast) };
  }

  // J, K_w, K_0 of M = J*alpha + K_w*omega + K_0*sgn(omega) in the least-squares sense over some samples.
  function identified(velocity, alpha, M, fast) {
    const row = (k) => [alpha[k], velocity[k], Math.sign(velocity[k])];
    const scale = [0, 1, 2].map((j) => rms(fast.map((k) => row(k)[j])));
    const A = [0, 1, 2].map(() => [0, 0, 0, 0]);
    for (const k of fast) {
      const values = [...row(k).map((value, j) => value / scale[j]), M[k]];
      for (let i = 0; i < 3; i++) for (let j = 0; j < 4; j++) A[i][j] += values[i] * values[j];
    }
    for (let i = 0; i < 3; i++) for (let j = 0; j < 3; j++) if (j !== i) { // Gauss and Jordan, of a positive definite matrix
      const factor = A[j][i] / A[i][i];
      for (let c = i; c < 4; c++) A[j][c] -= factor * A[i][c];
    }
    const theta = A.map((row, i) => row[3] / row[i] / scale[i]);
    const made = (k) => row(k).reduce((sum, value, j) => sum + value * theta[j], 0);
    return { theta, made, error: fast.reduce((sum, k) => sum + (M[k] - made(k)) ** 2, 0) };
  }

  function task8(state) {
    const f = friction(state), all = range(0, f.count), at = (samples, values) => [samples.map(f.time), samples.map((k) => values[k])];
    const bare = [0, ...range(1, f.count).map((k) => (f.velocity[k] - f.velocity[k - 1]) / f.period)];
    const { edge, reach, delay, close: [times, slope] } = data.friction, close = times.map((t) => f.alpha[Math.round(t / f.period)]);
    const near = range(edge - reach, edge + reach);
    const dashes = friction({ ...state, late: delay });
    return {
      numbers: {
        "samples remaining": f.fast.length, "samples removed": f.count - f.fast.length,
        "alpha_filt late, on t_sync": Math.round(f.lateness * 1e3) / 1e3 + 0,
      },
      charts: [
        [f.velocity, f.alpha, f.M].map((values, k) => [at(k === 1 ? f.sync : all, values), at(f.fast, values)]),
        [[at(all, bare), at(f.sync, f.alpha)], [at(near, bare), at(near, f.alpha), at(near.map((k) => k + delay), dashes.alpha)],
          [[times, slope], [times, close], [times.map((t) => t + f.period / 2), close]]],
      ],
    };
  }

  function task9(state) {
    const f = friction(state), time = range(0, f.count).map(f.time), made = range(0, f.count).map(f.made);
    const left = made.map((value, k) => f.M[k] - value), [J, viscous, coulomb] = f.theta;
    return {
      numbers: {
        J: J * KG_CM2, K_fric_w: viscous, K_fric_0: coulomb, E: f.error, "RMS of M - M_est, all samples": rms(left),
        ...(data.friction.rotor === null ? {} : { J_load: (J - data.friction.rotor) * KG_CM2 }),
      },
      charts: [[[[time, [...f.M]], [time, made]], [[time, left]]]],
    };
  }

  // Task 10: the run-up beside the datasheet's curve and the circuit at a temperature.
  function task10({ T, kT }) {
    const { velocity, full, least, sheet, corner, speeds, bin, tail } = data.fastest, M = data.fastest.torque.map((value) => kT * value);
    const start = first(M, (value) => value > full), kept = start < 0 ? [] : range(start, M.length).filter((k) => M[k] >= least);
    const speed = kept.map((k) => velocity[k]), torque = kept.map((k) => M[k]);
    const numbers = { "peak torque": kept.length ? largest(torque) : NaN }, top = largest(speed), up = speed.indexOf(top);
    const row = speeds.map((n) => median(torque.filter((_, k) => k <= up && speed[k] < tail * top && Math.abs(speed[k] - n / RPM) <= bin)));
    const charts = [[[speed.map((w) => w * RPM), torque], [sheet[0].map((w) => w * RPM), sheet[1]], [[corner[0] * RPM], [corner[1] * kT]]]];
    if (data.winding) {
      const { circuit, peak } = data.winding, R = resistance(circuit, T), currents = range(0, 200).map((k) => peak * (1 - k / 199));
      const reached = currents.map((current) => (circuit.voltage - R * current) / circuit.ke);
      numbers["corner of the cold circuit"] = reached[0] * RPM;
      charts[0].push([[0, ...reached.map((w) => w * RPM)], [peak, ...currents].map((current) => kT * drive(current))]);
    }
    return { numbers, row, charts: [charts] };
  }

  // Task 11: the winding, stepped as bench/course/winding.py lets MuJoCo step it.
  const drive = (current) => (data.winding.curvature * current ** 2 + data.winding.constant) * current;
  const resistance = (circuit, T) => circuit.resistance * (1 + circuit.per_kelvin * (T - data.winding.hot));

  function runUp(circuit, axis, T, tau, kT, across = null) {
    const { step, loop, gain, peak, length } = data.winding, { voltage: limit, ke } = circuit, [J, viscous, coulomb] = axis;
    const constant = kT * data.winding.constant, curvature = kT * data.winding.curvature, top = limit / ke;
    const count = Math.round((length * J * top) / (kT * drive(peak)) / step), x = (viscous * step) / J;
    const heavy = x > 0 ? J * (x / -Math.expm1(-x)) : J, cold = resistance(circuit, T), L = tau * circuit.cold_share * circuit.resistance;
    const kept = L ? Math.exp((-step * cold) / L) : 0, capacity = circuit.thermal_time_constant / circuit.thermal_resistance;
    const [velocity, current, u, v, warming] = range(0, 5).map(() => new Float64Array(count));
    let w = 0, before = 0, warm = 0;
    for (let k = 0; k < count; k++) {
      const target = Math.min(Math.max((gain / constant) * (top - w), -peak), peak), R = resistance(circuit, T + warm);
      const own = across === null ? ke : constant + curvature * before ** 2;
      const wanted = R * target + own * w + (L / loop) * (target - before);
      let full = Math.min(Math.max(wanted, -limit), limit), beside = 0;
      if (across !== null) {
        const bend = (2 * curvature * before * L) / across, steady = -across * w * before, taken = R * before + own * w;
        const square = L ** 2 + bend ** 2, middle = -(taken * L + steady * bend) / square;
        const reach = Math.sqrt(Math.max(middle ** 2 - (taken ** 2 + steady ** 2 - limit ** 2) / square, 0));
        const slope = Math.min(Math.max((wanted - taken) / L, middle - reach), middle + reach);
        full = taken + L * slope;
        beside = steady + bend * slope;
      }
      const settled = (full - own * w) / R, now = settled + (before - settled) * kept;
      velocity[k] = w; current[k] = now; u[k] = full; v[k] = beside; warming[k] = warm;
      const torque = curvature * now ** 3 + constant * now;
      warm += (step * (R * (L ? before : now) ** 2 - warm / circuit.thermal_resistance)) / capacity;
      if (w > 0 || torque > coulomb) w += (step * (torque - viscous * w - coulomb)) / heavy;
      before = now;
    }
    return { circuit, axis, velocity, current, u, v, warming, L, cold, torque: current.map((i) => kT * drive(i)) };
  }

  function corner(run) {
    const most = largest(run.current), started = first(run.current, (i) => i > 0.999 * most), limit = run.circuit.voltage;
    const voltage = (k) => Math.sqrt(run.u[k] ** 2 + run.v[k] ** 2), at = first(run.u, (_, k) => voltage(k) >= limit * (1 - 1e-9), started);
    const [slower, speed] = [run.velocity[at - 2], run.velocity[at - 1]];
    return speed + ((limit - voltage(at - 1)) * (speed - slower)) / (voltage(at - 1) - voltage(at - 2));
  }

  function extrapolated({ velocity, current }) {
    const { top, from, to, tail } = data.winding.fall, most = largest(current), fastest = largest(velocity);
    const last = current.findLastIndex((i) => i > top * most), start = first(current, (i) => i > top * most);
    const speeds = [], currents = [];
    for (let k = last + 1; k < current.length; k++)
      if (current[k] < from * most && current[k] > to * most && velocity[k] < tail * fastest) { speeds.push(velocity[k]); currents.push(current[k]); }
    const [slope, offset] = line(speeds, currents);
    return (median(current.subarray(start, last + 1)) - offset) / slope;
  }

  function speedAt({ velocity, torque }, share) {
    const most = largest(torque), last = torque.findLastIndex((value) => value > 0.999 * most);
    return velocity[first(torque, (value) => value < share * most, last)];
  }

  function power(run) {
    const [J, viscous, coulomb] = run.axis, { step, every } = data.winding, most = largest(run.current), speed = [];
    const from = first(run.current, (i) => i > 0.999 * most), to = run.velocity.indexOf(largest(run.velocity)), parts = [[], [], [], [], []];
    let lost = 0;
    for (let k = from; k < to; k++) {
      const i = run.current[k], w = run.velocity[k], warmer = 1 + ((run.circuit.per_kelvin * run.warming[k]) / run.cold) * run.circuit.resistance;
      const given = run.u[k] * i, heat = run.cold * warmer * i ** 2, field = run.L * warmer * i * gradient(run.current, step, k);
      const axis = (J * gradient(run.velocity, step, k) + viscous * w + coulomb * Math.sign(w)) * w, left = given - heat - field - axis;
      lost = Math.max(lost, Math.abs(left));
      if ((k - from) % every) continue;
      speed.push(w * RPM);
      [given, heat, field, axis, left].forEach((value, part) => parts[part].push(value));
    }
    return { curves: parts.map((part) => [speed, part]), lost };
  }

  // The winding whose power balances and that meets both peak curves.
  function balanced(kT) {
    const { circuit, corners, peak } = data.winding, [[low, one], [high, two]] = corners, ke = (kT * drive(peak)) / peak;
    const q = (two / one) ** 2, a = q - 1, b = 2 * ke * (q * one - two), c = circuit.voltage ** 2 * ((high / low) ** 2 - q);
    const drop = (-b + Math.sqrt(b ** 2 - 4 * a * c)) / (2 * a), R = drop / peak;
    const own = { ...circuit, resistance: R, thermal_resistance: (circuit.thermal_resistance * circuit.resistance) / R };
    return [own, Math.sqrt((circuit.voltage ** 2 - (drop + ke * one) ** 2) / one ** 2) / peak];
  }

  // Peak torque over speed at each mains voltage, hot: the datasheet's, by the course's circuit, and by the one that balances.
  function mains(own, across, kT) {
    const { circuit, corners, peak, constant, curvature, points } = data.winding, currents = range(0, points).map((k) => peak * (1 - k / (points - 1)));
    return corners.map(([volts, corner, idle]) => {
      const along = (R, beside, ke) => [[0, ...currents.map((i) => {
        const a = ke(i) ** 2 + (beside * i) ** 2, b = 2 * ke(i) * R * i, c = (R * i) ** 2 - ((volts / corners[0][0]) * circuit.voltage) ** 2;
        return (RPM * (-b + Math.sqrt(b ** 2 - 4 * a * c))) / (2 * a);
      })], [peak, ...currents].map((i) => kT * drive(i))];
      const balances = along(own.resistance, across, (i) => kT * (constant + curvature * i ** 2));
      return [[[0, corner * RPM, idle * RPM], [drive(peak), drive(peak), 0]], along(circuit.resistance, 0, () => circuit.ke), balances];
    });
  }

  function task11(state) {
    const { T, L, kT } = state, { circuit, hot, cold, taus, shares, sheet, every, axis: found, corners } = data.winding;
    const axis = data.charts["9"] ? friction(state).theta.map((value, k) => (k ? Math.max(value, 0) : value)) : found;
    const tau = L * 1e-3 / (circuit.cold_share * circuit.resistance), runs = [[hot, 0], [T, 0], [T, tau], ...taus.map((other) => [T, other])];
    const [warm, still, inductive, ...others] = runs.map(([start, time]) => runUp(circuit, axis, start, time, kT));
    const [n, shift, falls] = [corner(still), others.map((run) => corner(run) - corner(still)), others.map((run) => extrapolated(run) - extrapolated(still))];
    const speeds = {
      "corner, hot, quasi-static": corner(warm), "corner, cold, quasi-static": n, "corner, cold, with inductance": corner(inductive),
      "shift by temperature": n - corner(warm), "shift by inductance": corner(inductive) - n,
    };
    for (const share of shares) speeds[`with inductance faster at ${Math.round(100 * share)}% of the torque by`] = speedAt(inductive, share) - speedAt(still, share);
    taus.forEach((time, k) => { speeds[`corner, L/R = ${time * 1e3} ms`] = corner(others[k]); speeds[`fall later by, L/R = ${time * 1e3} ms`] = falls[k]; });
    const acceleration = (kT * drive(data.winding.peak) - axis[2]) / axis[0], lost = {}, milliseconds = taus.map((time) => time * 1e3);
    const drawn = (run) => [run.velocity, run.torque].map((values, k) => range(0, values.length, every).map((at) => values[at] * (k ? 1 : RPM)));
    const charts = [
      [[[sheet[0].map((w) => w * RPM), sheet[1]], ...[warm, still, inductive].map(drawn)]],
      [[[milliseconds, shift.map((w) => w * RPM)], [milliseconds, falls.map((w) => w * RPM)], [[0, ...milliseconds], [0, ...taus].map((time) => time * acceleration * RPM)]]],
    ];
    if (corners.length > 1) {
      const [own, across] = balanced(kT), [at120, at20, between] = [hot, T, (hot + cold) / 2].map((start) => runUp(own, axis, start, tau, kT, across));
      const [before, after] = [power(inductive), power(at20)], of = (name) => `power balances: ${name}`;
      Object.assign(speeds, { [of("hot")]: corner(at120), [of(`at ${(hot + cold) / 2} °C`)]: corner(between), [of("cold")]: corner(at20) });
      speeds[of("shift by temperature")] = corner(at20) - corner(at120);
      Object.assign(lost, { "power left over at most, course's circuit": before.lost, "power left over at most, power balances": after.lost });
      charts.push([before.curves, after.curves], mains(own, across, kT));
    }
    return { numbers: { ...Object.fromEntries(Object.entries(speeds).map(([name, w]) => [name, w * RPM])), ...lost }, charts };
  }

  // What is drawn: panels as the page has them, on scales that hold what stood there at first, too.
  const element = (name, attributes, text = "") => {
    const made = document.createElementNS("http://www.w3.org/2000/svg", name);
    Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
    made.textContent = text;
    return made;
  };
  const ends = (curves, axis) => curves.flatMap((one) => one[axis]).reduce(([a, b], v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);

  function ruler(bounds, start, stop) {
    const [low, high] = [Math.min(...bounds), Math.max(...bounds)], margin = 0.04 * (high - low) || 0.5 * Math.abs(high) || 0.5;
    const span = high - low + 2 * margin, place = (value) => start + ((value - low + margin) / span) * (stop - start);
    const power = 10 ** Math.floor(Math.log10(span / 5)), step = power * [1, 2, 2.5, 5, 10].find((s) => s * power >= span / 5);
    const digits = Math.max(0, [0, 1, 2, 3, 4, 5, 6, 7, 8].find((n) => Math.abs(step * 10 ** n - Math.round(step * 10 ** n)) < 1e-6) ?? 9);
    const ticks = range(Math.ceil((low - margin) / step), Math.floor((high + margin) / step) + 1);
    return { place, zero: low - margin < 0 && high + margin > 0, ticks: ticks.map((k) => [place(k * step), (k * step).toFixed(digits).replace("-", "−")]) };
  }

  function redraw(svg, looks, curves, held) {
    const right = svg.viewBox.baseVal.width - 12, bounds = (axis) => [...ends(curves, axis), ...ends(held, axis)];
    const x = ruler(bounds(0), 58, right), y = ruler(bounds(1), 188, 24), parts = [];
    for (const [at, label] of y.ticks)
      parts.push(element("line", { class: "grid", x1: 58, x2: right, y1: at, y2: at }), element("text", { class: "tick", x: 52, y: at + 4, "text-anchor": "end" }, label));
    for (const [at, label] of x.ticks)
      parts.push(element("line", { class: "grid", x1: at, x2: at, y1: 24, y2: 188 }), element("text", { class: "tick", x: at, y: 203, "text-anchor": "middle" }, label));
    if (y.zero) parts.push(element("line", { class: "zero", x1: 58, x2: right, y1: y.place(0), y2: y.place(0) }));
    curves.forEach(([along, up], k) => {
      const { style, colour } = looks[k], points = along.map((value, i) => `${x.place(value).toFixed(1)},${y.place(up[i]).toFixed(1)}`);
      const size = { dots: 5.6, "large dots": 10 }[style]; // as one path: a circle for each sample would take seconds
      if (size) parts.push(element("path", { class: `${colour} spots`, d: points.map((point) => `M${point}h0`).join(""), "stroke-width": size }));
      else parts.push(element("polyline", { class: `line ${style} ${colour}`, points: points.join(" ") }));
    });
    svg.replaceChildren(...parts, ...svg.querySelectorAll(".label, .note"));
  }

  const printed = (value) => { // as Python's .5g
    if (!Number.isFinite(value)) return "–";
    const [digits, power] = value.toExponential(4).split("e").map(Number);
    return power >= -4 && power < 5 ? String(Number(value.toPrecision(5))) : `${digits}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
  };

  const state = Object.fromEntries(data.sliders.map((slider) => [slider.key, slider.start]));
  const tasks = { 8: task8, 9: task9, 10: task10, 11: task11 };
  for (const signals of [data.friction, data.fastest])
    if (signals) for (const name of ["velocity", "torque"]) signals[name] = floats(signals[name]);

  const shown = Object.entries(data.charts).map(([key, looks]) => {
    const section = document.getElementById(`task-${key}`), table = [...section.querySelectorAll("table")].at(-1);
    const panels = [...section.querySelectorAll("figure.chart")].map((figure) => [...figure.querySelectorAll(".panels svg")]);
    const cells = new Map([...table.rows].map((row, k) => {
      const cell = document.createElement(k ? "td" : "th");
      cell.className = "number live";
      if (!k) cell.textContent = "with the sliders";
      row.cells[1].after(cell);
      return [row.cells[0].textContent, cell];
    }));
    const first = tasks[key](state), last = first.row && section.querySelector("table").rows, added = last?.item(last.length - 1).cloneNode(true);
    if (added) {
      added.className = "live";
      added.cells[0].textContent = "the same with the sliders";
      last.item(last.length - 1).after(added);
    }
    const kept = panels.map((figure) => figure.map((svg) => [...svg.childNodes]));
    return { key, looks, panels, cells, added, first, kept, legend: [...section.querySelectorAll(".legend li")].map((entry) => [entry.lastChild, entry.textContent]),
      form: controls(key, section.querySelector("figure.chart")) };
  });

  function controls(key, before) {
    const form = document.createElement("form"), inputs = [];
    form.className = "controls live";
    form.setAttribute("aria-label", `Task ${key} with other values`);
    form.addEventListener("submit", (event) => event.preventDefault());
    for (const slider of data.sliders.filter((one) => one.tasks.includes(key))) {
      const label = document.createElement("label"), input = document.createElement("input"), output = document.createElement("output");
      Object.assign(input, { type: "range", name: slider.key, min: -slider.below, max: slider.above, step: 1, value: 0 });
      input.addEventListener("input", () => { state[slider.key] = slider.start + input.valueAsNumber * slider.step; update(); });
      label.append(slider.label, input, output);
      form.append(label);
      inputs.push(() => {
        input.value = Math.round((state[slider.key] - slider.start) / slider.step);
        const also = slider.also ? ` (${Number((state[slider.key] * slider.also[0]).toPrecision(3))} ${slider.also[1]})` : "";
        output.value = `${Number(state[slider.key].toPrecision(3))} ${slider.unit}${also}`;
      });
    }
    const reset = document.createElement("button");
    Object.assign(reset, { type: "button", textContent: "as in the report" });
    reset.addEventListener("click", () => { for (const slider of data.sliders) state[slider.key] = slider.start; update(); });
    const note = document.createElement("p");
    note.className = "keys";
    note.textContent = "Diagrams and the column “with the sliders” follow them; the text, ± and error are the report’s.";
    form.append(reset, note);
    before.before(form);
    return { reset, tell: () => inputs.forEach((tell) => tell()) };
  }

  let waiting = 0;
  function update() {
    if (!waiting) waiting = requestAnimationFrame(() => { waiting = 0; show(); });
  }
  function show() {
    const still = data.sliders.every((slider) => state[slider.key] === slider.start);
    for (const { key, looks, panels, cells, added, first, kept, legend, form } of shown) {
      const now = still ? first : tasks[key](state);
      form.tell();
      form.reset.disabled = still;
      for (const [place, name] of legend) place.textContent = name.replace(/\b20 °C/, `${state.T} °C`).replace(/by ([\d.]+)(?= samples|,)/, (_, n) => `by ${n - state.late}`);
      for (const [name, value] of Object.entries(now.numbers)) if (cells.has(name)) cells.get(name).textContent = printed(value);
      now.row?.forEach((value, k) => { added.cells[k + 1].textContent = Number.isFinite(value) ? Number(value.toPrecision(3)) : "-"; });
      now.charts.forEach((curves, k) => curves.forEach((panel, j) => {
        const svg = panels[k]?.[j];
        if (svg && still) svg.replaceChildren(...kept[k][j]);
        else if (svg) redraw(svg, looks[k][j], panel, first.charts[k][j]);
      }));
    }
  }
  show();
})();
