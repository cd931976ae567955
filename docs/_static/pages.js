// What moves sideways can be reached by keyboard, and captions of the contents say their level.
document.addEventListener("DOMContentLoaded", () => {
  for (const wide of document.querySelectorAll("article pre, article .math, article .table-wrapper"))
    if (wide.scrollWidth > wide.clientWidth) wide.tabIndex = 0;
  for (const caption of document.querySelectorAll("p.caption[role=heading]")) caption.ariaLevel = "2";
});
