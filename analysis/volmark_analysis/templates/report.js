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
// The search field above a long table hides the rows without its words.
for (const field of document.querySelectorAll(".filter")) {
  field.hidden = false;
  const rows = [...field.nextElementSibling.querySelectorAll("tbody tr")];
  field.querySelector("input").addEventListener("input", event => {
    const words = event.target.value.toLowerCase().split(/\s+/).filter(Boolean);
    rows.forEach(row => { row.hidden = !words.every(word => row.textContent.toLowerCase().includes(word)); });
    field.querySelector("output").textContent = `${rows.filter(row => !row.hidden).length} of ${rows.length}`;
  });
}
// What colours the heat maps.
for (const maps of document.querySelectorAll(".maps")) {
  const choose = shade => {
    maps.dataset.by = shade;
    for (const scale of maps.querySelectorAll("[data-shade]")) scale.hidden = scale.dataset.shade !== shade;
  };
  maps.querySelector(".picks").hidden = maps.querySelectorAll("[data-shade]").length < 2;
  maps.addEventListener("change", event => choose(event.target.value));
  choose("0");
}
// Of plots that are a choice, one is shown.
for (const choice of new Set([...document.querySelectorAll("[data-choice]")].map(plot => plot.dataset.choice))) {
  const plots = [...document.querySelectorAll("[data-choice]")].filter(plot => plot.dataset.choice === choice);
  if (plots.length < 2) continue;
  const show = chosen => plots.forEach((plot, i) => { plot.hidden = i !== chosen; });
  const picks = document.createElement("p");
  picks.className = "picks";
  plots.forEach((plot, i) => {
    const label = document.createElement("label"), radio = document.createElement("input");
    Object.assign(radio, {type: "radio", name: choice, checked: i === 0});
    radio.addEventListener("change", () => show(i));
    label.append(radio, " ", plot.querySelector("h3").textContent);
    picks.append(label);
  });
  plots[0].before(picks);
  show(0);
}
// Two pictures of a captured frame, one over the other, with a divider to drag.
for (const [number, block] of [...document.querySelectorAll(".block")].entries()) {
  const pictures = [...block.querySelectorAll("img.zoom")];
  if (pictures.length < 2) continue;
  const make = (tag, properties, ...children) => {
    const made = Object.assign(document.createElement(tag), properties);
    made.append(...children);
    return made;
  };
  const chooser = title => make("select", {ariaLabel: title},
    ...pictures.map((picture, i) => make("option", {value: i, textContent: picture.dataset.name})));
  const [left, right] = [chooser("left picture"), chooser("right picture")];
  const [under, over] = [make("img", {}), make("img", {className: "over"})];
  const divider = make("input", {type: "range", min: 0, max: 100, step: "any", value: 50, ariaLabel: "divider"});
  const stage = make("div", {className: "stage"}, under, over, make("i", {}));
  const frame = make("details", {className: "compare"}, make("summary", {textContent: "Compare two pictures"}),
    make("p", {className: "pair"}, left, right), stage, divider);
  const show = () => {
    [[over, left], [under, right]].forEach(([image, choice]) => {
      image.src = pictures[choice.value].src;
      image.alt = pictures[choice.value].alt;
    });
    stage.style.setProperty("--at", `${divider.value}%`);
  };
  const drag = event => {
    if (event.type === "pointermove" && !event.buttons) return;
    event.preventDefault();
    const box = stage.getBoundingClientRect();
    divider.value = 100 * (event.clientX - box.left) / box.width;
    show();
  };
  // The first point's picture on the left, what it is judged by on the right.
  const hasReference = pictures[0].closest(".reference") !== null;
  left.value = hasReference ? 1 : 0;
  right.value = hasReference ? 0 : 1;
  stage.addEventListener("pointerdown", event => { stage.setPointerCapture(event.pointerId); drag(event); });
  stage.addEventListener("pointermove", drag);
  frame.addEventListener("input", show);
  frame.addEventListener("toggle", show);
  frame.open = number === 0;
  block.before(frame);
}
