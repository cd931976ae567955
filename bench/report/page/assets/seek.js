"use strict";
// Sorts the rows of a table by a column: upwards, downwards, then in the first order again.
{
  const raised = "⁰¹²³⁴⁵⁶⁷⁸⁹", power = /·10([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)/;
  const valueOf = (text) => { // its first number with its power of ten; nan of none
    const exponent = power.exec(text), first = parseFloat(text.replace(/−/g, "-").replace(/^[^\d.-]+/, ""));
    return first * 10 ** (exponent ? Number([...exponent[1]].map((one) => (one === "⁻" ? "-" : raised.indexOf(one))).join("")) : 0);
  };
  document.querySelectorAll("main table:not(.heat)").forEach((table) => {
    const body = table.tBodies[0], rows = body ? [...body.rows] : [];
    if (rows.length < 4 || !rows.every((row) => row.cells[0].tagName === "TH" && row.cells.length === rows[0].cells.length)) return;
    [...table.tHead.rows[0].cells].forEach((heading, column) => {
      const button = document.createElement("button");
      button.type = "button";
      button.append(...heading.childNodes);
      heading.append(button);
      button.addEventListener("click", () => {
        const next = { ascending: "descending", descending: null }[heading.getAttribute("aria-sort")];
        const order = next === undefined ? "ascending" : next, sign = order === "descending" ? -1 : 1;
        table.querySelectorAll("th[aria-sort]").forEach((other) => other.removeAttribute("aria-sort"));
        if (order) heading.setAttribute("aria-sort", order);
        const number = heading.classList.contains("number");
        const keys = new Map(rows.map((row) => [row, number ? valueOf(row.cells[column].textContent) : row.cells[column].textContent]));
        const compare = (a, b) => (number ? (Number.isNaN(a) ? 1 : Number.isNaN(b) ? -1 : sign * (a - b)) : sign * a.localeCompare(b));
        body.append(...(order ? [...rows].sort((a, b) => compare(keys.get(a), keys.get(b))) : rows));
      });
    });
  });
}
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
