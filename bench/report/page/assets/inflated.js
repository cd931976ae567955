"use strict";
const inflated = (text) => // a response of what is deflated, in base 64
  new Response(new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]).stream().pipeThrough(new DecompressionStream("deflate")));
const NOTHING = -32768; // the number of no value
const numbers = async (text) => { // 16 bits: differences, folded, upper bytes before lower ones, deflated (bench/report/html.py)
  const bytes = new Uint8Array(await inflated(text).arrayBuffer()), found = new Int16Array(bytes.length / 2);
  for (let k = 0, value = 0; k < found.length; k++) {
    const folded = (bytes[k] << 8) | bytes[k + found.length];
    found[k] = value = (value + ((folded >>> 1) ^ -(folded & 1))) & 0xffff;
  }
  return found;
};

const unfolded = (async () => { // what lies below headings of a large page (bench/report/html.py)
  const folded = document.querySelector("script.folded");
  if (!folded) return;
  const [content, ...bins] = folded.textContent.split(" "), texts = (await inflated(content).text()).split("\0");
  const places = document.querySelectorAll("[data-folded]"), paths = texts.splice(places.length);
  places.forEach((place, k) => {
    const section = place.parentNode, data = [...section.querySelectorAll("script")];
    place.outerHTML = texts[k].replace(/\x01/g, () => paths.shift()).replace(/\x02/g, () => bins.shift());
    section.querySelectorAll("script:empty").forEach((script, at) => { script.textContent = data[at].textContent; });
    data.forEach((script) => script.remove());
  });
  if (location.hash) document.getElementById(location.hash.slice(1))?.scrollIntoView();
})();

unfolded.then(() => document.querySelectorAll("a[data-content]").forEach(async (link) => { // files to take along
  const content = await inflated(link.dataset.content).arrayBuffer();
  link.href = URL.createObjectURL(new Blob([content], { type: link.dataset.media }));
}));
