"use strict";
// Figures: values at the pointer, series on and off, one variant lit in all figures, files of data and drawing.
(function () {
  var all = dom.all, make = dom.make;
  var variant = function (name) { return name.split(",")[0]; };
  var shown = function (value) { return typeof value === "number" ? String(Number(value.toPrecision(4))) : value; };

  // Dims whatever does not belong to the variant of a series, in every figure that shows the variant.
  var light = function (name) {
    all("[data-series]").forEach(function (element) {
      element.classList.toggle("lit", name ? variant(element.dataset.series) === variant(name) : false);
    });
    all("figure").forEach(function (figure) {
      figure.classList.toggle("has-lit", figure.querySelector(".lit") !== null);
    });
  };

  var download = function (name, blob) {
    var link = make("a", { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(function () { URL.revokeObjectURL(link.href); }, 1000);
  };

  var csv = function (panels) {
    var cell = function (value) {
      var text = value === null || value === undefined ? "" : String(value);
      return /[",\n]/.test(text) ? '"' + text.replaceAll('"', '""') + '"' : text;
    };
    var rows = [["panel", "series", "point", "x axis", "x", "y axis", "y", "value"]];
    panels.forEach(function (panel) {
      panel.series.forEach(function (of) {
        of.x.forEach(function (x, k) {
          rows.push([panel.title, of.name, (of.names || [])[k], panel.labels[0], x, panel.labels[1], of.y[k],
            (of.values || [])[k]]);
        });
      });
    });
    return rows.map(function (row) { return row.map(cell).join(","); }).join("\n") + "\n";
  };

  // The panels and the legend as one drawing: panels in rows of at most 1100 pixels.
  var drawing = function (figure) {
    var space = "http://www.w3.org/2000/svg";
    var sheet = document.createElementNS(space, "svg");
    var x = 0, y = 0, row = 0, width = 0;
    var put = function (svg, room) {
      var size = [Number(svg.getAttribute("width")), Number(svg.getAttribute("height"))];
      if (x + size[0] > 1100) { x = 0; y += row; row = 0; }
      var copy = svg.cloneNode(true);
      copy.setAttribute("x", x);
      copy.setAttribute("y", y);
      sheet.appendChild(copy);
      x += size[0] + room;
      row = Math.max(row, size[1]);
      width = Math.max(width, x);
    };
    all(".panels svg", figure).forEach(function (svg) { put(svg, 0); });
    y += row; x = 8; row = 0;
    all(".legend button", figure).forEach(function (button) {
      var text = document.createElementNS(space, "text");
      var room = button.textContent.length * 7 + 24;
      put(button.querySelector("svg"), room);
      text.setAttribute("x", x - room + 6);
      text.setAttribute("y", y + 10);
      text.setAttribute("font-size", 11);
      text.setAttribute("font-family", "DejaVu Sans, Verdana, sans-serif");
      text.textContent = button.textContent;
      sheet.appendChild(text);
    });
    var height = y + row + 8;
    sheet.setAttribute("width", width);
    sheet.setAttribute("height", height);
    sheet.setAttribute("viewBox", [0, 0, width, height].join(" "));
    var ground = document.createElementNS(space, "rect");
    ground.setAttribute("width", "100%");
    ground.setAttribute("height", "100%");
    ground.setAttribute("fill", "#fff");
    sheet.prepend(ground);
    return sheet;
  };
  var text_of = function (sheet) { return new XMLSerializer().serializeToString(sheet); };
  var pixels = function (sheet, name) {
    var image = new Image();
    image.onload = function () {
      var canvas = make("canvas", { width: 2 * image.width, height: 2 * image.height });
      canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
      canvas.toBlob(function (blob) { download(name + ".png", blob); });
    };
    image.src = "data:image/svg+xml;charset=utf-8," + encodeURIComponent(text_of(sheet));
  };

  var tip = make("div", { class: "tip", role: "status", hidden: "" });
  document.body.appendChild(tip);
  var place = function (axis, value) {
    return axis[0] ? Math.log(value / axis[1]) / Math.log(axis[2] / axis[1]) : (value - axis[1]) / (axis[2] - axis[1]);
  };
  // The point that is nearest to the pointer, at most 24 pixels away.
  var nearest = function (panel, is_on, px, py) {
    var found = { far: 24 };
    var area = panel.area;
    panel.series.filter(function (of) { return is_on(of.name); }).forEach(function (of) {
      of.x.forEach(function (x, k) {
        if (typeof x !== "number" || typeof of.y[k] !== "number") { return; }
        var far = Math.hypot(area[0] + area[2] * place(panel.axes[0], x) - px,
          area[1] + area[3] * (1 - place(panel.axes[1], of.y[k])) - py);
        if (found.far > far) { found = { far: far, of: of, k: k }; }
      });
    });
    return found;
  };
  var tell = function (panel, found, event) {
    var k = found.k, of = found.of;
    var lines = [of.name, (of.names || [])[k], panel.labels[0] + ": " + shown(of.x[k]),
      (panel.labels[1] || "y") + ": " + shown(of.y[k])];
    if (of.values) { lines.push(of.name + ": " + shown(of.values[k])); lines[0] = ""; }
    tip.replaceChildren();
    lines.filter(Boolean).forEach(function (line) { tip.appendChild(make("div", {}, line)); });
    tip.hidden = false;
    tip.style.left = Math.max(0, Math.min(event.pageX + 14, document.documentElement.clientWidth - tip.offsetWidth - 8)) + "px";
    tip.style.top = event.pageY + 14 + "px";
  };

  all("figure").forEach(function (figure) {
    var source = figure.querySelector("script");
    if (!source) { return; }
    var data = JSON.parse(source.textContent);
    var panels = data.panels;
    panels.forEach(function (panel) {
      panel.series.forEach(function (of) {
        ["x", "y", "values"].forEach(function (name) {
          if (of[name] !== undefined) { of[name] = data.columns[of[name]]; }
        });
      });
    });
    var off = new Set();
    all(".panels svg", figure).forEach(function (svg, k) {
      svg.addEventListener("pointermove", function (event) {
        var box = svg.getBoundingClientRect();
        var scale = Number(svg.getAttribute("width")) / box.width;
        var found = nearest(panels[k], function (name) { return !off.has(name); },
          (event.clientX - box.left) * scale, (event.clientY - box.top) * scale);
        if (found.of) { tell(panels[k], found, event); } else { tip.hidden = true; }
      });
      svg.addEventListener("pointerleave", function () { tip.hidden = true; });
    });
    all(".legend button", figure).forEach(function (button) {
      var name = button.dataset.series;
      button.addEventListener("click", function () {
        var is_on = off.delete(name) ? true : !off.add(name);
        button.setAttribute("aria-pressed", String(is_on));
        all(".panels [data-series]", figure).forEach(function (group) {
          if (group.dataset.series === name) { group.classList.toggle("off", !is_on); }
        });
      });
      ["pointerenter", "focus"].forEach(function (kind) { button.addEventListener(kind, function () { light(name); }); });
      ["pointerleave", "blur"].forEach(function (kind) { button.addEventListener(kind, function () { light(""); }); });
    });
    var files = make("span", { class: "files" });
    [["CSV", function () { download(figure.id + ".csv", new Blob([csv(panels)], { type: "text/csv" })); }],
      ["SVG", function () { download(figure.id + ".svg", new Blob([text_of(drawing(figure))], { type: "image/svg+xml" })); }],
      ["PNG", function () { pixels(drawing(figure), figure.id); }]].forEach(function (file) {
      var button = make("button", { type: "button", "aria-label": file[0] + " file of this figure" }, file[0]);
      button.addEventListener("click", file[1]);
      files.appendChild(button);
    });
    figure.querySelector("figcaption").appendChild(files);
  });

  // A film can be stopped; where readers want no motion it stands still until they start it.
  all("picture.movie").forEach(function (picture) {
    var still = picture.querySelector("source");
    var is_still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    var button = make("button", { type: "button", class: "play" });
    var show = function () {
      still.media = is_still ? "all" : "not all";
      button.textContent = is_still ? "Play" : "Pause";
    };
    button.addEventListener("click", function () { is_still = !is_still; show(); });
    picture.after(button);
    show();
  });
}());
