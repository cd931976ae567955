"use strict";
// Shows those rows of a table in which every word that is sought occurs; and names the cells of rows that a narrow
// window stacks.
document.querySelectorAll(".seek").forEach((form) => {
  const rows = [...form.nextElementSibling.querySelectorAll("tbody tr")], output = form.querySelector("output");
  const headings = [...form.nextElementSibling.querySelectorAll("thead th")].map((cell) => cell.textContent);
  for (const row of rows) [...row.cells].forEach((cell, k) => { if (k > 1) cell.dataset.heading = headings[k]; });
  const texts = rows.map((row) => row.textContent.toLowerCase());
  form.hidden = false;
  form.addEventListener("submit", (event) => event.preventDefault());
  form.querySelector("input").addEventListener("input", (event) => {
    const words = event.target.value.toLowerCase().split(/\s+/).filter(Boolean);
    const shown = texts.map((text) => words.every((word) => text.includes(word)));
    rows.forEach((row, k) => { row.hidden = !shown[k]; });
    output.value = words.length ? `${shown.filter(Boolean).length} of ${rows.length}` : "";
  });
});
