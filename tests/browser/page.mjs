// Opens a page of the report in Chromium, uses it as a reader does, and prints what it found:
//
//     node page.mjs PAGE [--full]
//
// search, filters, order and links of the table of verdicts, printing, and axe-core at two widths in
// light and dark. With --full it also checks the limits of a whole report: height, words, bytes, printed pages.
import { chromium } from "playwright-core";
import axe from "axe-core";
import { execFileSync } from "node:child_process";
import { statSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [file, ...options] = process.argv.slice(2);
const full = options.includes("--full");
const url = pathToFileURL(resolve(file)).href;
const wide = { width: 1400, height: 1000 };
const narrow = { width: 390, height: 844 };
let failures = 0;

function check(what, holds, found = "") {
  failures += holds ? 0 : 1;
  console.log(`${holds ? "ok  " : "FAIL"} ${what}${found === "" ? "" : `: ${found}`}`);
}

const found = execFileSync("sh", ["-c", "command -v chromium"], { encoding: "utf8" }).trim();
const executablePath = process.env.CHROMIUM ?? found;
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });

async function open(settings, hash = "") {
  const page = await browser.newPage(settings);
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(String(error)));
  page.on("console", (message) => message.type() === "error" && page.errors.push(message.text()));
  page.requests = [];
  page.on("request", (request) => page.requests.push(request.url()));
  await page.goto(url + hash);
  return page;
}
const shown = (page) => page.locator("#gates tbody tr:visible:not(.why)").count();

// Layout and accessibility.
for (const viewport of [wide, narrow]) {
  for (const colorScheme of ["light", "dark"]) {
    const page = await open({ viewport, colorScheme });
    const at = `${viewport.width} px, ${colorScheme}`;
    const size = await page.evaluate(() => ({
      height: document.documentElement.scrollHeight,
      width: document.documentElement.scrollWidth,
    }));
    check(`no error and no request (${at})`, page.errors.length === 0 && page.requests.length === 1, page.errors.join());
    await page.evaluate(axe.source);
    for (const state of ["folded", "open"]) {
      if (state === "open") await page.evaluate(() => document.querySelectorAll("details").forEach((it) => (it.open = true)));
      const found = await page.evaluate(() => axe.run(document, { resultTypes: ["violations"] }));
      const seen = found.violations.map((v) => `${v.id} at ${v.nodes[0].target}`).join("; ");
      check(`axe-core finds nothing (${at}, ${state})`, found.violations.length === 0, seen);
      const width = await page.evaluate(() => document.documentElement.scrollWidth);
      check(`nothing is wider than the page (${at}, ${state})`, width <= viewport.width, width);
      if (full && viewport === wide && colorScheme === "light") {
        const words = await page.evaluate(() => document.body.innerText.split(/\s+/).length);
        check(`words (${state})`, words <= (state === "open" ? 20_000 : 3_000), words);
      }
    }
    if (full && colorScheme === "light") {
      check(`height (${at})`, size.height < (viewport === wide ? 12_000 : 20_000), size.height);
    }
    await page.close();
  }
}

// The table of verdicts.
const page = await open({ viewport: wide });
const all = await page.locator("#gates tbody tr").count();
const first = await shown(page);
check("some verdicts are shown first", first > 0 && first <= all, `${first} of ${all}`);
const id = await page.locator("#gates tbody tr").last().getAttribute("id");
await page.locator(".filters input[name=q]").fill(id);
check("the search finds a gate by its name", (await shown(page)) >= 1 && (await page.locator(`tr[id="${id}"]`).isVisible()));
check("the address keeps the search", page.url().includes("q="), page.url().split("#")[1]);
const again = await open({ viewport: wide }, "#" + page.url().split("#")[1]);
check("the address brings the search back", (await shown(again)) === (await shown(page)));
await again.close();
await page.locator(".filters input[name=q]").fill("");
const status = await page.locator("#gates tbody tr").first().getAttribute("data-status");
await page.locator(".filters select[name=status]").selectOption(status);
const kept = await page.locator("#gates tbody tr:visible").evaluateAll((rows) => rows.map((row) => row.dataset.status));
check("the filter keeps one verdict", kept.length > 0 && kept.every((one) => one === status), status);
const head = page.locator("#gates thead th").nth(1);
await head.locator("button").focus();
await page.keyboard.press("Enter");
check("a column is sorted by the keyboard", (await head.getAttribute("aria-sort")) === "ascending");
const names = await page.locator("#gates tbody tr:visible td:nth-child(2)").allInnerTexts();
check("it is in order", names.every((name, k) => k === 0 || names[k - 1].localeCompare(name) <= 0));
const linked = await open({ viewport: wide }, "#" + encodeURIComponent(id));
check("a link to a gate shows it with its reasons", (await linked.locator(`tr[id="${id}"]`).isVisible())
  && (await linked.locator("tr.why p").first().innerText()).length > 10);
await linked.close();
const chip = page.locator("section .counts a[href*='case=']").first();
if (await chip.count()) {
  await chip.click();
  const wanted = new URLSearchParams((await chip.getAttribute("href")).split("?")[1]);
  const form = page.locator(".filters");
  check("a count in a case filters the verdicts",
    (await form.locator("select[name=status]").inputValue()) === wanted.get("status")
    && (await form.locator("select[name=case]").inputValue()) === wanted.get("case"));
}
const figure = await page.locator("figure").first().getAttribute("id");
const atFigure = await open({ viewport: wide }, "#" + figure);
const arrived = await atFigure.waitForFunction((id) => {
  const box = document.getElementById(id).getBoundingClientRect();
  return box.top < innerHeight && box.bottom > 0;
}, figure, { timeout: 10_000 }).then(() => true, () => false);
check("a link to a figure leads to it", arrived, figure);
await atFigure.close();

// Figures: values at the pointer, series on and off, files.
const drawn = await open({ viewport: wide }, "#" + figure);
const card = drawn.locator(`figure[id="${figure}"]`);
const panel = card.locator(".panels svg").first();
await panel.scrollIntoViewIfNeeded();
const box = await panel.boundingBox();
for (let k = 0; k < 60 && (await drawn.locator(".tip:visible").count()) === 0; k++) {
  await drawn.mouse.move(box.x + box.width * (0.2 + 0.012 * k), box.y + box.height * (0.15 + 0.01 * k));
}
check("a value is shown at the pointer", (await drawn.locator(".tip").innerText()).includes(":"));
const series = card.locator(".legend button").first();
await series.hover();
check("a series is lit in all figures", (await drawn.locator(".has-lit .lit").count()) > 1);
await series.click();
check("a series can be switched off", (await card.locator(".panels .off").count()) > 0
  && (await series.getAttribute("aria-pressed")) === "false");
for (const kind of ["CSV", "SVG", "PNG"]) {
  const [file] = await Promise.all([drawn.waitForEvent("download"), card.locator(".files button", { hasText: kind }).click()]);
  check(`a figure is kept as ${kind}`, statSync(await file.path()).size > 100, file.suggestedFilename());
}
await drawn.close();

// Printing.
const pdf = await page.pdf({ format: "A4" });
const pages = (pdf.toString("latin1").match(/\/Type\s*\/Page\b/g) ?? []).length;
check("it prints", pages > 0 && (!full || pages <= 12), `${pages} pages`);
await page.emulateMedia({ media: "print" });
await page.setViewportSize({ width: 703, height: 1000 }); // what is left of A4 between its margins
const cut = await page.locator("table:visible").evaluateAll((tables) => tables
  .filter((table) => table.getBoundingClientRect().right > 704).map((table) => table.innerText.slice(0, 40)));
check("no column is cut off in print", cut.length === 0, cut.join("; "));
if (full) {
  const bytes = statSync(file).size;
  check("size", bytes < 5_000_000, `${bytes} bytes`);
}
await browser.close();
console.log(failures === 0 ? "the page works" : `${failures} failed`);
process.exit(failures === 0 ? 0 : 1);
