"use strict";
(() => {
  const SLOWED = [1, 2, 5, 10, 20, 50, 100], LEFT = 80, RIGHT = 680, LEAP = 0.1; // px of the rail, as drawing.py has them; s
  const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const figures = (value, unit) => (Number.isNaN(value) ? "not known" : value.toPrecision(4).replace(/-/g, "−") + " " + unit);

  class Motion {
    constructor(figure) {
      this.data = JSON.parse(figure.querySelector("script[type='application/json']").textContent);
      this.position = floats(this.data.position);
      this.apart = floats(this.data.apart);
      this.last = this.data.count - 1;
      this.at = 0; // in instants
      this.from = null; // moment and instant from which it plays; null while it stands
      for (const name of ["stage", "readout", "play"]) this[name] = figure.querySelector("." + name);
      for (const name of ["simulated", "ghost"]) this[name] = this.stage.querySelector("." + name);
      this.told = figure.querySelector("output.slowed");
      this.instant = figure.querySelector("[name=instant]");
      this.slowed = figure.querySelector("[name=slowed]");
      this.times = figure.querySelectorAll("[type=radio]");
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
      this.told.value = slowed === 1 ? "real time" : slowed + " times slower";
      this.slowed.setAttribute("aria-valuetext", this.told.value);
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
      const at = this.read(this.position), apart = this.read(this.apart);
      const times = Number([...this.times].find((one) => one.checked).value);
      this.put(this.ghost, at);
      this.put(this.simulated, at + times * apart);
      const seconds = time.toFixed(Math.min(6, Math.max(3, Math.ceil(-Math.log10(step))))) + " s";
      this.instant.value = Math.round(this.at);
      this.instant.setAttribute("aria-valuetext", seconds);
      const degrees = turns && !Number.isNaN(apart) ? " (" + ((apart * 180) / Math.PI).toPrecision(3).replace(/-/g, "−") + "°)" : "";
      const texts = ["at " + seconds, ghost + " " + figures(at, unit), "simulated " + figures(at + apart, unit),
        "simulated less " + ghost + " " + figures(apart, unit) + degrees];
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

  document.querySelectorAll("figure.moving").forEach((figure) => new Motion(figure));
})();
