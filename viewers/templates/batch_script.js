"use strict";
(function () {
  const table = document.getElementById("all-items");
  const field = document.getElementById("filter");
  if (!table || !field) return;
  const body = table.tBodies[0];
  const rows = Array.from(body.rows);
  const heads = Array.from(table.tHead.rows[0].cells);
  const words = new Intl.Collator("en", { numeric: true, sensitivity: "base" });
  const told = document.getElementById("shown");
  const links = Array.from(document.querySelectorAll("a[data-filter]"));
  const buttons = Array.from(document.querySelectorAll("button[data-filter]"));
  const texts = rows.map((row) => row.textContent.toLowerCase());
  let chosen = "";

  function valueOf(cell, isNumber) {
    const number = cell.querySelector("data");
    const text = cell.dataset.sort !== undefined ? cell.dataset.sort : number ? number.value : isNumber ? "" : cell.textContent.trim();
    if (!isNumber) return text;
    if (text === "") return null;
    const value = Number(text.replace("inf", "Infinity"));
    return Number.isNaN(value) ? null : value;
  }

  function sort(place, direction) {
    const isNumber = heads[place].dataset.kind === "number";
    const keyed = rows.map((row, order) => ({ row, order, value: valueOf(row.cells[place], isNumber) }));
    const isMissing = (value) => value === null || value === "";
    keyed.sort((a, b) => {
      if (isMissing(a.value) || isMissing(b.value)) {
        return isMissing(a.value) - isMissing(b.value) || a.order - b.order;
      }
      const found = isNumber ? a.value - b.value : words.compare(a.value, b.value);
      return (found ? direction * found : 0) || a.order - b.order;
    });
    body.append(...keyed.map((each) => each.row));
    heads.forEach((head, k) => {
      if (k === place) head.setAttribute("aria-sort", direction > 0 ? "ascending" : "descending");
      else head.removeAttribute("aria-sort");
    });
  }

  function filter() {
    const parts = field.value.toLowerCase().split(/\s+/).filter(Boolean);
    let count = 0;
    rows.forEach((row, k) => {
      const keys = row.dataset.keys.split(" ");
      const isShown = (!chosen || keys.includes(chosen)) && parts.every((part) => texts[k].includes(part));
      row.hidden = !isShown;
      count += isShown;
    });
    told.textContent = count === rows.length ? `${rows.length} items` : `${count} of ${rows.length} items`;
    buttons.forEach((chip) => chip.setAttribute("aria-pressed", String(chip.dataset.filter === chosen)));
  }

  heads.forEach((head, place) => {
    if (!head.dataset.kind) return;
    // no button element: Chromium prints a head with one on the first sheet only
    const button = document.createElement("span");
    button.tabIndex = 0;
    button.setAttribute("role", "button");
    button.append(...head.childNodes);
    const turn = () => sort(place, head.getAttribute("aria-sort") === "ascending" ? -1 : 1);
    button.addEventListener("click", turn);
    button.addEventListener("keydown", (press) => {
      if (press.key !== "Enter" && press.key !== " ") return;
      press.preventDefault();
      turn();
    });
    head.append(button);
  });
  // a number at the head of the page leads to its items; one above the table turns them on and off
  links.forEach((link) =>
    link.addEventListener("click", () => {
      chosen = link.dataset.filter;
      filter();
    }),
  );
  buttons.forEach((button) =>
    button.addEventListener("click", () => {
      chosen = chosen === button.dataset.filter ? "" : button.dataset.filter;
      filter();
    }),
  );
  field.addEventListener("input", filter);
  // the head of the table stays in sight where the table is not wider than the page
  const frame = table.parentElement;
  const fit = () => {
    frame.classList.remove("fits");
    frame.classList.toggle("fits", frame.scrollWidth <= frame.clientWidth);
  };
  window.addEventListener("resize", fit);
  document.documentElement.classList.add("scripted");
  fit();
  filter();
})();
