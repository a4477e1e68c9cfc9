// Click on a column's title sorts by it; rows without a result stay at the end.
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => head.addEventListener("click", () => {
    const down = head.getAttribute("aria-sort") === "ascending";
    heads.forEach(other => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const keyOf = row => row.cells[column]?.dataset.key ?? "";
    const compare = (a, b) => {
      const [x, y] = [keyOf(a), keyOf(b)];
      if (x === "" || y === "") return (x === "") - (y === "");
      const order = isNaN(x) || isNaN(y) ? x.localeCompare(y) : x - y;
      return down ? -order : order;
    };
    body.append(...[...body.rows].sort((a, b) =>
      a.classList.contains("failed") - b.classList.contains("failed") || compare(a, b)));
  }));
}
// Click on a picture enlarges it; a second click or any key puts it back.
document.addEventListener("click", event => {
  const open = document.querySelector(".zoomed");
  if (open) { open.remove(); return; }
  if (!event.target.matches("img.zoom")) return;
  const shade = document.createElement("div");
  shade.className = "zoomed";
  shade.append(event.target.cloneNode());
  document.body.append(shade);
});
document.addEventListener("keydown", () => document.querySelector(".zoomed")?.remove());
