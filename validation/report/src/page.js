"use strict";
// A click on a column's head sorts the table by it; a second click turns the order.
document.querySelectorAll("thead th").forEach(function (head) {
  head.addEventListener("click", function () {
    var row = head.parentElement;
    var column = Array.prototype.indexOf.call(row.children, head);
    var body = row.closest("table").tBodies[0];
    var turn = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    var key = function (tr) {
      var cell = tr.children[column];
      return cell.dataset.value === undefined ? cell.textContent.trim() : Number(cell.dataset.value);
    };
    var compare = function (a, b) {
      var x = key(a), y = key(b);
      if (typeof x === "number") { return typeof y === "number" ? turn * (x - y) : -1; }
      return typeof y === "number" ? 1 : turn * x.localeCompare(y);
    };
    Array.from(row.children).forEach(function (th) { th.removeAttribute("aria-sort"); });
    head.setAttribute("aria-sort", turn === 1 ? "ascending" : "descending");
    Array.from(body.rows).sort(compare).forEach(function (tr) { body.appendChild(tr); });
  });
});
// A click on a count of the banner leaves only the rows with that verdict; a second click undoes it.
var buttons = document.querySelectorAll("button[data-filter]");
buttons.forEach(function (button) {
  button.addEventListener("click", function () {
    var chosen = button.getAttribute("aria-pressed") === "true" ? null : button.dataset.filter;
    buttons.forEach(function (b) { b.setAttribute("aria-pressed", String(b.dataset.filter === chosen)); });
    document.querySelectorAll("tr[data-status]").forEach(function (tr) {
      tr.hidden = chosen !== null ? tr.dataset.status !== chosen : false;
    });
  });
});
