"use strict";
(() => {
  const HEIGHT = { first: 170, other: 130, paper: 90 }, LEAST = 8, DENSE = 8;
  const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const line = uPlot.paths.linear();
  const shown = (value, unit) => (value == null ? "–" : String(Number(value.toPrecision(4))).replace(/-/g, "−") + (unit ? " " + unit : ""));

  const labels = (u, splits, axis, space, step) => { // with as many digits as distinguish them
    let digits = 0;
    while (digits < 15 && Math.abs(Math.round(step * 10 ** digits) / (step * 10 ** digits) - 1) > 1e-6) digits++;
    const text = (value) => (digits > 4 ? value.toExponential(Math.max(0, Math.floor(Math.log10(Math.abs(value)) + digits))) : value.toFixed(digits));
    return splits.map((value) => (Math.abs(value) < step / 2 ? "0" : text(value).replace(/-/g, "−")));
  };

  // Whether a curve of lowest and highest values goes up and down in nearly every pixel.
  const dense = (u, i) => {
    const y = u.data[i], { min, max } = u.scales.y;
    let way = 0;
    for (let k = 0; k < y.length; k += 2) if (y[k] !== null) way += y[k + 1] - y[k];
    return (way / (max - min)) * u.bbox.height > DENSE * u.bbox.width;
  };

  // Such a curve as an upright bar for each pair, which reaches as far as the one before: a line up and down looks the
  // same and takes a browser several times as long to draw.
  const bars = (u, i, colour) => {
    const [x, y] = [u.data[0], u.data[i]], thick = u.series[i].width * devicePixelRatio, { left, top, width, height } = u.bbox;
    const wide = Math.max(thick, ((x[2] - x[0]) / (u.scales.x.max - u.scales.x.min)) * width);
    u.ctx.save();
    u.ctx.beginPath();
    u.ctx.rect(left, top, width, height);
    u.ctx.clip();
    u.ctx.fillStyle = colour;
    let before = null;
    for (let k = 0; k < y.length; k += 2) {
      if (y[k] === null) { before = null; continue; }
      const low = u.valToPos(y[k], "y", true), high = u.valToPos(y[k + 1], "y", true); // downwards on the screen
      const [from, to] = before === null ? [high, low] : [Math.min(high, before[1]), Math.max(low, before[0])];
      const at = u.valToPos((x[k] + x[k + 1]) / 2, "x", true) - wide / 2;
      u.ctx.fillRect(Math.floor(at), Math.round(from - thick / 2), Math.ceil(wide), Math.max(1, Math.round(to - from + thick)));
      before = [high, low];
    }
    u.ctx.restore();
  };

  class TimeGraph {
    static async of(figure) {
      const data = JSON.parse(figure.querySelector("script[type='application/json']").textContent);
      await Promise.all(data.panels.flatMap((panel) => panel.curves).map(async (curve) => {
        const { low, high } = curve.samples;
        curve.low = await numbers(low);
        curve.high = high === null ? curve.low : await numbers(high);
      }));
      return new TimeGraph(figure, data);
    }

    constructor(figure, data) {
      this.data = data;
      this.place = figure.querySelector(".graph");
      this.range = figure.querySelector(".range");
      this.choice = Math.max(0, this.data.choices.length - 1);
      this.whole = [-0.5, this.data.count - 0.5]; // in intervals of the grid
      this.view = [...this.whole];
      this.ranges = []; // shaded, in intervals
      this.single = this.data.panels.every((p) => p.curves.every((c) => c.samples.high === null));
      this.listen(figure);
      this.build();
    }

    listen(figure) {
      const acts = { left: () => this.pan(-0.2), right: () => this.pan(0.2), in: () => this.zoom(0.5), out: () => this.zoom(2), all: () => this.show(...this.whole) };
      acts.next = () => this.next();
      const keys = { ArrowLeft: "left", ArrowRight: "right", "+": "in", "=": "in", "-": "out", "0": "all", Home: "all", Enter: "next" };
      figure.querySelectorAll("button").forEach((button) => button.addEventListener("click", acts[button.dataset.do]));
      figure.querySelectorAll("input").forEach((input) =>
        input.addEventListener("change", () => { this.choice = Number(input.value); this.build(); }));
      figure.querySelector("form").addEventListener("submit", (event) => event.preventDefault());
      this.place.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.metaKey || event.altKey || !(event.key in keys)) return;
        event.preventDefault();
        acts[keys[event.key]]();
      });
      this.place.addEventListener("wheel", (event) => {
        if (!event.ctrlKey && document.activeElement !== this.place) return; // else the page scrolls
        event.preventDefault();
        const over = this.plots[0].over.getBoundingClientRect();
        this.zoom(event.deltaY > 0 ? 1.25 : 0.8, (event.clientX - over.left) / over.width);
      }, { passive: false });
      this.place.addEventListener("pointerdown", (event) => {
        this.place.focus({ preventScroll: true });
        if (!event.shiftKey) return;
        event.preventDefault();
        event.stopPropagation();
        const from = event.clientX, view = [...this.view], wide = this.plots[0].over.clientWidth;
        const move = (next) => {
          const by = ((from - next.clientX) / wide) * (view[1] - view[0]);
          this.show(view[0] + by, view[1] + by);
        };
        window.addEventListener("pointermove", move);
        window.addEventListener("pointerup", () => window.removeEventListener("pointermove", move), { once: true });
      }, { capture: true });
      this.place.addEventListener("mousedown", (event) => { if (event.shiftKey) event.stopPropagation(); }, { capture: true });
      window.addEventListener("instant", (event) => this.point(event.detail));
      new ResizeObserver(() => this.fit()).observe(this.place);
      for (const query of ["(prefers-color-scheme: dark)", "print"])
        window.matchMedia(query).addEventListener("change", () => this.build());
      window.addEventListener("beforeprint", () => this.build(true)); // before pages are counted, whose heights are these
    }

    point(time) { // the cursor of all panels, for other parts that have a time; beyond what is in sight it is gone
      for (const plot of this.plots) {
        const left = plot.valToPos(time, "x");
        plot.setCursor(left < 0 || left > plot.over.clientWidth ? { left: -10, top: -10 } : { left, top: 0 });
      }
    }

    curves(panel) {
      const chosen = panel.curves.filter((c) => c.choice === null || c.choice === this.choice);
      const first = panel.first && this.choice > 0 ? panel.curves.filter((c) => c.choice === 0) : [];
      return [...first, ...chosen];
    }

    build(paper = window.matchMedia("print").matches) {
      this.paper = paper;
      this.place.replaceChildren();
      const key = uPlot.sync(Math.random().toString(36));
      this.plots = this.data.panels.map((panel, k) => this.plot(panel, k, key));
      this.draw();
    }

    plot(panel, k, sync) {
      const readout = document.createElement("div");
      readout.className = "readout";
      this.place.append(readout);
      const barred = []; // curves that are drawn as bars
      const curves = this.curves(panel), last = k === this.data.panels.length - 1;
      const colours = curves.map((c) => colour(panel.first && c.choice === 0 && this.choice > 0 ? "first" : c.role));
      const axis = { stroke: colour("soft"), grid: { stroke: colour("rule"), width: 1 }, ticks: { stroke: colour("rule"), width: 1 }, font: "12px system-ui, sans-serif" };
      const readOut = (u) => this.readOut(u, readout, panel, curves, colours);
      const plot = new uPlot({
        width: this.place.clientWidth || 600,
        height: (this.paper ? HEIGHT.paper : k === 0 ? HEIGHT.first : HEIGHT.other) + (last ? 38 : 0),
        legend: { show: false },
        padding: [6, 20, 0, 0],
        scales: { x: { time: false } },
        axes: [
          { ...axis, size: last ? 42 : 4, label: last ? "time / s" : undefined, labelSize: 18, labelFont: axis.font, values: last ? labels : (u, splits) => splits.map(() => "") },
          { ...axis, size: 68, space: 24, values: labels },
        ],
        series: [{}, ...curves.map((c, i) => ({ label: c.name, stroke: colours[i], width: c.role === "measured" ? 3 : 1.3,
          points: { show: false }, spanGaps: false, paths: (u, at, from, to) => ((barred[at] = !this.plain && dense(u, at)) ? null : line(u, at, from, to)) }))],
        cursor: { sync: { key: sync.key, scales: ["x", null] }, drag: { x: true, y: false, setScale: false }, y: false, points: { size: 6 },
          bind: { dblclick: () => () => { this.show(...this.whole); return null; } } },
        hooks: {
          drawClear: [(u) => this.shade(u)],
          drawSeries: [(u, i) => { if (barred[i]) bars(u, i, colours[i - 1]); }],
          setCursor: [readOut],
          setSelect: [(u) => {
            if (u.select.width < 4) return;
            const at = (pixel) => (u.posToVal(pixel, "x") - this.data.start) / this.data.step;
            const [left, right] = [at(u.select.left), at(u.select.left + u.select.width)];
            u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
            this.show(left, right);
          }],
        },
      }, [[], ...curves.map(() => [])], this.place);
      sync.sub(plot);
      Object.assign(plot, { curves, readOut: () => readOut(plot) });
      plot.readOut();
      return plot;
    }

    shade(u) {
      const { left, top, width, height } = u.bbox, at = (k) => u.valToPos(this.data.start + this.data.step * k, "x", true);
      u.ctx.save();
      u.ctx.beginPath();
      for (const [from, to] of this.ranges) {
        const a = Math.max(left, at(from - 0.5)), b = Math.min(left + width, at(to + 0.5));
        if (b > a) u.ctx.rect(a, top, Math.max(devicePixelRatio, b - a), height);
      }
      u.ctx.globalAlpha = 0.22;
      u.ctx.fillStyle = colour("focus");
      u.ctx.fill();
      u.ctx.restore();
    }

    mark(ranges) {
      this.ranges = ranges;
      this.turn = -1;
      this.show(...this.view);
    }

    next() { // shaded range, with as much before and after it
      if (!this.ranges.length) return;
      const [from, to] = this.ranges[(this.turn = (this.turn + 1) % this.ranges.length)], around = Math.max(LEAST, to - from);
      this.show(from - around, to + around);
      this.place.focus();
    }

    readOut(u, readout, panel, curves, colours) {
      const at = u.cursor.idx;
      const name = document.createElement("b");
      name.textContent = panel.label + (panel.unit ? " / " + panel.unit : "");
      const parts = curves.map((curve, i) => {
        const part = document.createElement("span"), line = document.createElement("i");
        line.style.color = colours[i];
        part.append(line, curve.name + (at == null ? "" : " " + shown(u.data[i + 1][at], "")));
        return part;
      });
      const when = document.createElement("span");
      when.textContent = at == null || u.data[0][at] == null ? "" : "at " + Number(u.data[0][at].toFixed(4)) + " s";
      readout.replaceChildren(name, ...parts, when);
    }

    pan(share) {
      const by = share * (this.view[1] - this.view[0]);
      this.show(this.view[0] + by, this.view[1] + by);
    }

    zoom(factor, around = 0.5) {
      const [a, b] = this.view, centre = a + around * (b - a);
      this.show(centre - around * (b - a) * factor, centre + (1 - around) * (b - a) * factor);
    }

    show(from, to) {
      const [first, last] = this.whole, size = Math.min(Math.max(to - from, LEAST), last - first);
      const middle = (from + to) / 2;
      const start = Math.min(Math.max(middle - size / 2, first), last - size);
      this.view = [start, start + size];
      if (this.waiting) return;
      this.waiting = requestAnimationFrame(() => { this.waiting = 0; this.draw(); });
    }

    draw() {
      const { start, step } = this.data, [a, b] = this.view;
      const from = Math.max(0, Math.floor(a) - 1), to = Math.min(this.data.count, Math.ceil(b) + 2);
      const size = Math.max(1, Math.floor((to - from) / Math.max(200, this.plots[0].over.clientWidth || 600)));
      const plain = (this.plain = this.single && size === 1);
      const x = [];
      for (let k = from; k < to; k += size) {
        x.push(start + step * (plain ? k : k - 0.5 + size * 0.25));
        if (!plain) x.push(start + step * (k - 0.5 + size * 0.75));
      }
      const scale = { min: start + step * a, max: start + step * b };
      for (const plot of this.plots) {
        const columns = plot.curves.map((curve) => (plain ? this.values(curve, from, to) : this.extremes(curve, from, to, size)));
        plot.batch(() => { plot.setData([x, ...columns], false); plot.setScale("x", scale); });
        plot.readOut();
      }
      const digits = Math.min(9, Math.max(0, Math.ceil(-Math.log10(step))));
      const [first, last] = [Math.max(a, 0), Math.min(b, this.data.count - 1)].map((k) => Number((start + step * k).toFixed(digits)));
      this.range.value = `${first} to ${last} s`;
      this.bins?.see(b - a < this.whole[1] - this.whole[0] ? [Math.max(0, Math.ceil(a)), Math.min(this.data.count - 1, Math.floor(b))] : null);
    }

    values(curve, from, to) {
      const { offset, scale } = curve.samples, found = [];
      for (let k = from; k < to; k++) found.push(curve.low[k] === NOTHING ? null : offset + scale * curve.low[k]);
      return found;
    }

    extremes(curve, from, to, size) {
      const { offset, scale } = curve.samples, found = [];
      for (let k = from; k < to; k += size) {
        let low = 32767, high = NOTHING;
        for (let i = k, end = Math.min(k + size, to); i < end; i++) {
          if (curve.low[i] === NOTHING) continue;
          if (curve.low[i] < low) low = curve.low[i];
          if (curve.high[i] > high) high = curve.high[i];
        }
        if (high === NOTHING) found.push(null, null);
        else found.push(offset + scale * low, offset + scale * high);
      }
      return found;
    }

    fit() {
      const width = this.place.clientWidth;
      if (!width || width === this.plots[0].width) return;
      this.plots.forEach((plot) => plot.setSize({ width, height: plot.height }));
      this.draw();
    }
  }

  // A chart whose dots are bins of the recording that a graph over time shows: the graph shades when the recording was in
  // those that are chosen, and those of the time range in sight there are marked.
  class Bins {
    static async of(figure, graph) {
      const panels = await Promise.all([...figure.querySelectorAll("svg[data-bins]")].map(async (svg) => {
        let x = 0, y = 0;
        const steps = svg.querySelector(".spots").getAttribute("d").matchAll(/[Mm](-?[\d.]+),(-?[\d.]+)/g);
        const dots = [...steps].map((step) => [(x += Number(step[1])), (y += Number(step[2]))]);
        const [brush, shown] = ["rect", "path"].map((name) => document.createElementNS(svg.namespaceURI, name));
        brush.setAttribute("class", "brush");
        shown.setAttribute("class", "spots shown");
        svg.append(brush, shown);
        return { svg, dots, brush, shown, along: await numbers(svg.dataset.bins) };
      }));
      return new Bins(figure, graph, panels);
    }

    constructor(figure, graph, panels) {
      Object.assign(this, { graph, panels, form: figure.querySelector("form.bins") });
      this.form.hidden = false;
      const acts = { next: () => graph.next(), none: () => this.choose(null) };
      this.form.querySelectorAll("button").forEach((button) => button.addEventListener("click", acts[button.dataset.do]));
      panels.forEach((panel) => this.listen(panel));
      this.choose(null);
      graph.bins = this;
    }

    listen(panel) {
      const { svg, dots } = panel, last = dots.length - 1;
      for (const [name, value] of [["role", "slider"], ["tabindex", 0], ["aria-valuemin", 0], ["aria-valuemax", last]]) svg.setAttribute(name, value);
      const under = (event) => {
        const { x } = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
        return dots.reduce((best, dot, k) => (Math.abs(dot[0] - x) < Math.abs(dots[best][0] - x) ? k : best), 0);
      };
      svg.addEventListener("pointerdown", (event) => {
        svg.setPointerCapture(event.pointerId);
        this.choose(panel, under(event));
      });
      svg.addEventListener("pointermove", (event) => { if (svg.hasPointerCapture(event.pointerId)) this.choose(panel, this.from, under(event)); });
      svg.addEventListener("keydown", (event) => {
        const here = this.panel === panel, step = { ArrowLeft: -1, ArrowDown: -1, ArrowRight: 1, ArrowUp: 1, Home: -Infinity, End: Infinity }[event.key];
        if (event.ctrlKey || event.metaKey || event.altKey || !(step || event.key === "Escape" || event.key === "Enter")) return;
        event.preventDefault();
        if (event.key === "Enter") this.graph.next();
        else if (event.key === "Escape") this.choose(null);
        else {
          const to = Math.min(Math.max((here ? this.to : step < 0 ? last + 1 : -1) + step, 0), last);
          this.choose(panel, here && event.shiftKey ? this.from : to, to);
        }
      });
    }

    choose(panel, from = 0, to = from) {
      Object.assign(this, { panel, from, to });
      const [low, high] = [Math.min(from, to), Math.max(from, to)], ranges = [], far = this.graph.data.count / 500; // two pixels
      let inside = 0;
      panel?.along.forEach((bin, k) => {
        if (bin < low || bin > high) return;
        inside++;
        const before = ranges.at(-1);
        if (before && k - before[1] <= Math.max(1, far)) before[1] = k;
        else ranges.push([k, k]);
      });
      for (const one of this.panels) {
        const chosen = one === panel, edge = (k, other) => (one.dots[Math.min(Math.max(k, 0), one.dots.length - 1)][0] + one.dots[other][0]) / 2;
        const at = chosen ? edge(low - 1, low) : 0, wide = chosen ? edge(high + 1, high) - at : 0;
        for (const [name, value] of [["x", at], ["y", 24], ["height", 164], ["width", wide && Math.max(2, wide)]]) one.brush.setAttribute(name, value);
        one.svg.setAttribute("aria-valuenow", chosen ? to : 0);
        one.svg.setAttribute("aria-valuetext", chosen ? this.text(one, low, high, ranges.length, inside) : "no bin");
      }
      this.form.querySelector("output").value = panel ? this.text(panel, low, high, ranges.length, inside) : "";
      this.graph.mark(ranges);
    }

    text({ svg, dots }, low, high, ranges, inside) {
      const from = Number(svg.dataset.low), wide = svg.viewBox.baseVal.width - 70; // between the margins
      const value = (k, unit) => shown(from + ((dots[k][0] - 58) / wide) * (svg.dataset.high - from), unit);
      return `${svg.dataset.of} ${low < high ? value(low, "") + " to " : ""}${value(high, svg.dataset.unit)}: ${shown(inside * this.graph.data.step, "s")} in ${ranges} time range${ranges === 1 ? "" : "s"}`;
    }

    see(range) {
      for (const { dots, along, shown } of this.panels) {
        const bins = new Set(range ? along.subarray(range[0], range[1] + 1) : []);
        shown.setAttribute("d", dots.map(([x, y], k) => (bins.has(k) ? `M${x.toFixed(1)},${y.toFixed(1)}h0` : "")).join(""));
      }
    }
  }

  document.querySelectorAll("figure.time").forEach(async (figure) => {
    const graph = await TimeGraph.of(figure);
    const graphOf = (chart) => chart.closest("section")?.querySelector("figure.time") ?? document.querySelector("figure.time");
    document.querySelectorAll("figure:has(svg[data-bins])").forEach((chart) => { if (graphOf(chart) === figure) Bins.of(chart, graph); });
  });
})();
