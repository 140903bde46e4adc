"use strict";
// Elements by selector, and new elements: for all scripts of the page.
var dom = {
  all: function (selector, within) { return Array.from((within || document).querySelectorAll(selector)); },
  make: function (tag, attributes, text) {
    var element = document.createElement(tag);
    Object.keys(attributes).forEach(function (name) { element.setAttribute(name, attributes[name]); });
    element.textContent = text || "";
    return element;
  }
};
