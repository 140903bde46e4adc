"use strict";
(function () {
  var all = dom.all, make = dom.make;

  // The button in a column's head sorts the table by that column; pressed again it turns the order.
  var sort = function (head, turn) {
    var row = head.parentElement;
    var column = Array.prototype.indexOf.call(row.children, head);
    var body = row.closest("table").tBodies[0];
    var key = function (tr) {
      var cell = tr.children[column];
      return cell.dataset.v === undefined ? cell.textContent.trim() : Number(cell.dataset.v);
    };
    var compare = function (a, b) {
      var x = key(a), y = key(b);
      if (typeof x === "number") { return typeof y === "number" ? turn * (x - y) : -1; }
      return typeof y === "number" ? 1 : turn * x.localeCompare(y);
    };
    Array.from(row.children).forEach(function (th) { th.removeAttribute("aria-sort"); });
    head.setAttribute("aria-sort", turn === 1 ? "ascending" : "descending");
    all("tr.why", body).forEach(function (tr) { tr.remove(); });
    Array.from(body.rows).sort(compare).forEach(function (tr) { body.appendChild(tr); });
  };
  all("table:not(.overview) thead th").forEach(function (head) {
    var button = make("button", { type: "button", class: "sort" });
    while (head.firstChild) { button.appendChild(head.firstChild); }
    head.appendChild(button);
    button.addEventListener("click", function () {
      sort(head, head.getAttribute("aria-sort") === "ascending" ? -1 : 1);
      if (head.closest("#gates")) { apply(); remember(); }
    });
  });

  // All verdicts: search, filters and order, which the address keeps.
  var table = document.getElementById("gates");
  var rows = table ? Array.from(table.tBodies[0].rows) : [];
  var most = 3;
  var form = make("form", { class: "filters", "aria-label": "Filter the verdicts" });
  var found = make("p", { class: "found", role: "status" });
  var more = make("button", { type: "button", class: "more" });
  var text = function (row, column) { return row.children[column].textContent.trim(); };
  var distinct = function (of) { return Array.from(new Set(rows.map(of))).sort(); };
  var case_of = function (row) { return row.id.split(".")[0]; };
  var fields = {
    "case": case_of,
    "variant": function (row) {
      var name = row.children[5].querySelector("code");
      return name ? name.textContent : "(a study)";
    },
    "status": function (row) { return row.dataset.status; },
    "evidence": function (row) { return text(row, 6); }
  };
  // The name of a gate links to its row.
  var link = function (row) {
    var cell = row.children[1];
    if (!cell.firstElementChild) { cell.replaceChildren(make("a", { href: "#" + row.id }, cell.textContent)); }
  };
  var apply = function () {
    all("tr.why", table).forEach(function (tr) { tr.remove(); });
    var words = form.elements.q.value.toLowerCase().split(" ");
    var count = 0;
    Array.from(table.tBodies[0].rows).forEach(function (row) {
      var content = row.textContent.toLowerCase();
      var fits = words.every(function (word) { return content.includes(word); });
      Object.keys(fields).forEach(function (name) {
        var wanted = form.elements[name].value;
        if (wanted) { fits = fits ? fields[name](row) === wanted : false; }
      });
      count += fits ? 1 : 0;
      row.hidden = fits ? count > most : true;
      if (!row.hidden) { link(row); }
    });
    found.textContent = count + " of " + rows.length + " gates" + (count > most ? ", " + most + " shown" : "");
    more.hidden = most >= count;
    more.textContent = "Show all " + count;
  };
  var remember = function () {
    var state = new URLSearchParams();
    Array.from(form.elements).forEach(function (field) { if (field.value) { state.set(field.name, field.value); } });
    var head = table.querySelector("th[aria-sort]");
    if (head) { state.set(head.getAttribute("aria-sort"), head.textContent); }
    history.replaceState(null, "", "#verdicts?" + state);
  };
  // The row of a gate, with its reasons below it.
  var open = function (row) {
    row.hidden = false;
    link(row);
    all("tr.why", table).forEach(function (tr) { tr.remove(); });
    var why = make("tr", { class: "why" });
    var cell = make("td", { colspan: row.children.length });
    var on = make("p", {}, "");
    row.children[5].childNodes.forEach(function (node) { on.appendChild(node.cloneNode(true)); });
    on.append("; evidence: " + text(row, 6));
    cell.appendChild(on);
    text(row, 7).split(" ").forEach(function (number) {
      cell.appendChild(make("p", {}, document.getElementById("r" + number).textContent));
    });
    why.appendChild(cell);
    row.after(why);
    row.scrollIntoView({ block: "center" });
  };
  var follow = function () {
    var parts = decodeURIComponent(location.hash.slice(1)).split("?");
    var target = document.getElementById(parts[0]);
    if (parts[0] === "verdicts") {
      var state = new URLSearchParams(parts[1] || "");
      form.reset();
      Array.from(form.elements).forEach(function (field) { field.value = state.get(field.name) || ""; });
      all("th", table).forEach(function (head) {
        if (state.get("ascending") === head.textContent) { sort(head, 1); }
        if (state.get("descending") === head.textContent) { sort(head, -1); }
      });
      apply();
      document.getElementById("verdicts").scrollIntoView();
    } else if (rows.includes(target)) { form.reset(); apply(); open(target); }
    else if (target) {
      for (var closed = target.closest("details"); closed; closed = closed.parentElement.closest("details")) {
        closed.open = true;
      }
      target.scrollIntoView();
    }
  };
  if (table) {
    var search = make("label", {}, "search ");
    search.appendChild(make("input", { type: "search", name: "q" }));
    form.appendChild(search);
    Object.keys(fields).forEach(function (name) {
      var label = make("label", {}, name + " ");
      var select = make("select", { name: name });
      select.appendChild(make("option", { value: "" }, "all"));
      distinct(fields[name]).forEach(function (value) { select.appendChild(make("option", { value: value }, value)); });
      label.appendChild(select);
      form.appendChild(label);
    });
    var box = table.closest(".explorer");
    box.before(form, found);
    box.after(more);
    form.addEventListener("submit", function (event) { event.preventDefault(); });
    form.addEventListener("input", function () { most = 10; apply(); remember(); });
    more.addEventListener("click", function () { most = rows.length; apply(); });
    apply();
  }
  addEventListener("hashchange", follow);
  follow();
}());
