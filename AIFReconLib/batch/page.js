for (const button of document.querySelectorAll(".cases-table th button")) button.onclick = () => {
  const head = button.parentElement, body = head.closest("table").tBodies[0], column = head.cellIndex;
  const down = head.getAttribute("aria-sort") === "ascending";
  for (const other of head.parentElement.cells) other.removeAttribute("aria-sort");
  head.setAttribute("aria-sort", down ? "descending" : "ascending");
  const key = row => { const d = row.cells[column].dataset; return "n" in d ? (d.n === "" ? NaN : +d.n) : row.cells[column].textContent; };
  const order = (a, b) => a === b ? 0 : a !== a ? (b !== b ? 0 : 1) : b !== b ? -1
    : (typeof a === "number" ? a - b : a.localeCompare(b, undefined, { numeric: true })) * (down ? -1 : 1);
  body.append(...[...body.rows].map(row => [key(row), row]).sort((a, b) => order(a[0], b[0])).map(pair => pair[1]));
};
