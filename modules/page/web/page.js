// The page: it asks the program (in the worker) and shows its answers. What is said about a machine comes from the program;
// here are only the headings and buttons around it.
"use strict";

// --- elements

const byId = (id) => document.getElementById(id);

/** An element; `attributes` may hold functions, which become listeners: {click: f}. */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(name, value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null) made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== null));
  return made;
}

/** Answers are in ASCII; a page writes units and signs as people do. */
const typeset = (text) =>
  String(text)
    .replace(/\bum\b/g, "µm")
    .replace(/\bdegC\b/g, "°C")
    .replace(/\+-\s?/g, "± ")
    .replace(/ -> /g, " → ")
    .replace(/(\de)-(?=\d)/g, "$1\u2011");

/** A paragraph of a text of 80 columns, as one line. */
const unwrapped = (text) => text.replace(/\s*\n\s*/g, " ").trim();
const inWords = (word) => word.replaceAll("_", " ");

/** Titles beside their cells; those that begin with ">" are numbers. */
function table(caption, titles, rows) {
  const isNumber = titles.map((title) => title.startsWith(">"));
  const names = titles.map((title) => title.replace(">", ""));
  const cells = (tag, row) =>  // a narrow screen shows each row as a card, with the title in front of each cell
    row.map((cell, i) => element(tag, { class: isNumber[i] ? "n" : null, ...(tag === "th" ? { scope: "col" } : { "data-title": names[i] }) },
      cell));
  return element("div", { class: "table" }, element("p", { class: "soft" }, caption),
    element("div", { class: "scroll", role: "region", "aria-label": caption, tabindex: "0" }, element("table", { "aria-label": caption },
      element("thead", {}, element("tr", {}, cells("th", names))),
      element("tbody", {}, rows.map((row) => element("tr", {}, cells("td", row)))))));
}

/** SVG of the program: it has escaped what comes from files, and scripts in it do not run. */
function figures(svg, single = false) {
  const holder = element("div", { class: single ? "figures single" : "figures" });
  const parsed = new DOMParser().parseFromString(svg, "text/html");
  holder.append(...parsed.querySelectorAll("svg"));
  return holder;
}

const card = (title, ...children) =>
  element("section", { class: "card", "aria-label": title }, element("h2", { tabindex: "-1" }, title), ...children);
const sentence = (text) => typeset(text.charAt(0).toUpperCase() + text.slice(1) + (text.endsWith(".") ? "" : "."));
const wholeAnswer = (verb, text) =>
  element("details", {}, element("summary", {}, `The whole answer of ${verb}`), element("pre", { tabindex: "0" }, text));

/** The words of the screens (docs/glossary.md), longest first, so that "reversal error" goes before a shorter one. */
const words = JSON.parse(byId("words").textContent).sort((a, b) => b.word.length - a.word.length);
const wordPattern = new RegExp(`(?<![\\w-])(?:${words.map(({ word }) => `(${word.replace(/[ -]/g, "[ -]")}s?)`).join("|")})(?![\\w-]| or yaw)`, "i");

/** Marks the first occurrence of each word in a card, with its meaning. */
function explainWords(part) {
  for (const one of part.querySelectorAll(".card, .verdict")) {
    const seen = new Set();
    const texts = document.createTreeWalker(one, NodeFilter.SHOW_TEXT, (node) =>
      node.parentElement.closest("pre, code, button, select, svg, dfn, label") ? NodeFilter.FILTER_REJECT : NodeFilter.FILTER_ACCEPT);
    for (let node = texts.nextNode(); node; node = texts.nextNode()) {
      const found = wordPattern.exec(node.data);
      if (!found) continue;
      const { word, meaning } = words[found.slice(1).findIndex(Boolean)];
      const rest = node.splitText(found.index);
      rest.splitText(found[0].length);
      texts.currentNode = rest;
      if (seen.has(word)) continue;
      seen.add(word);
      const marked = element("dfn", { title: meaning, "data-word": word });
      rest.replaceWith(marked);
      marked.append(rest);
    }
  }
}

/** `?` of the screens: the words that are seen, with their meanings. */
function showWords() {
  const seen = new Set([...document.querySelectorAll("#work dfn")].map((one) => one.dataset.word));
  const rows = words.filter(({ word }) => seen.has(word)).sort((a, b) => (a.word < b.word ? -1 : 1));
  byId("explained").replaceChildren(...(rows.length ? [element("details", { class: "card" },
    element("summary", {}, "? Words on this page"),
    element("dl", { class: "facts" }, rows.flatMap(({ word, meaning }) => [element("dt", {}, word), element("dd", {}, meaning)])))] : []));
}

// --- the worker

let worker = null;
let asked = 0;
const waiting = new Map();

function ask(message, transfer = []) {
  return new Promise((resolve, reject) => {
    message.number = ++asked;
    waiting.set(message.number, { resolve, reject });
    worker.postMessage(message, transfer);
  });
}

async function begin() {
  worker = new Worker(URL.createObjectURL(new Blob([byId("worker").textContent], { type: "text/javascript" })));
  worker.onmessage = ({ data }) => {
    const { resolve, reject } = waiting.get(data.number);
    waiting.delete(data.number);
    if ("failed" in data) reject(new Error(`The analysis stopped: ${data.failed}. Reload the page to begin again.`));
    else resolve(data.value);
  };
  const packed = Uint8Array.from(atob(byId("wasm").textContent), (letter) => letter.charCodeAt(0));
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const wasm = await new Response(unpacked).arrayBuffer();
  byId("wasm").remove();
  await ask({ action: "begin", wasm }, [wasm]);
  byId("version").textContent = (await run("ecs", "--version")).answer.version;
}

/** What a verb refused, in its words. */
class Refusal extends Error {}

/** Runs a command line. @return what it answered with --json, its text and its messages */
async function run(program, ...words) {
  const asJson = program === "ecs" ? [...words, "--json"] : words;
  const said = await ask({ action: "run", words: [program, ...asJson] });
  const answer = said.json ? JSON.parse(said.json) : {};
  if (answer.error) {
    const { message, file, line, column } = answer.error;
    throw new Refusal([file, line, line && column].filter(Boolean).join(":") + (file ? ": " : "") + message);
  }
  return { ...said, answer };
}

const write = (path, bytes) => ask({ action: "write", path, bytes });
const readBytes = (path) => ask({ action: "read", path });
const readText = async (path) => new TextDecoder().decode(await readBytes(path));

// --- what is on the bench

/** The files of the case, by name; the commands that were run on them. */
let bench = null;

const machineWords = () => (bench.machine ? ["--machine", bench.machine] : []);
const dataWords = () => [bench.model, ...bench.data, ...machineWords(), ...bench.importWords];

/** Runs a verb of `ecs` and keeps its command for who wants to do the same in a terminal. */
async function verb(...words) {
  const said = await run("ecs", ...words);
  note(words.filter((word) => word !== "--force"));
  return said;
}
const quoted = (word) => (/^[\w.,:/=+-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);
function note(words, program = "ecs") {
  const line = [program, ...words].map(quoted).join(" ");
  if (!bench.commands.includes(line)) bench.commands.push(line);
  byId("commands").textContent = bench.commands.join("\n");
}

// --- one thing at a time

/** Where reading goes on; what was worked may be gone. */
function focusOn(heading) {
  if (!heading) return;
  heading.focus({ preventScroll: true });
  heading.scrollIntoView({ block: "start" });
}

let busy = false;
const say = (text) => (byId("state").textContent = text);

function complain(text) {
  byId("problem").textContent = typeset(text);
  byId("problem").hidden = !text;
}

function setBusy(now) {
  busy = now;
  byId("work").setAttribute("aria-busy", String(now));
  for (const control of document.querySelectorAll("button, #files")) control.disabled = now;
  if (!now) {
    byId("again").disabled = byId("restart").disabled = !given.size;
    updatePlay();
    updateUndo();
    updateSealed();
  }
}

/** Runs `work` while nothing else can be asked for; tells what it does and what went wrong. */
async function during(text, work) {
  if (busy) return;
  complain("");
  say(text);
  setBusy(true);
  try {
    const done = await work();
    say(done || "");
    if (bench) showWords();
  } catch (error) {
    say("");
    complain(error.message);
    if (error instanceof Refusal && bench === null) byId("options").open = true;
    byId("problem").scrollIntoView({ block: "nearest" });
  } finally {
    setBusy(false);
  }
}

// --- cards

const parts = ["about", "guess", "verdict", "take", "ladder", "fails", "missing", "figures", "sealed", "iso", "explained", "terminal"];
function fill(part, ...children) {
  byId(part).replaceChildren(...children.flat().filter(Boolean));
  explainWords(byId(part));
}

function layOut() {
  byId("work").replaceChildren(...parts.map((part) => element("div", { id: part })));
  byId("verdict").setAttribute("role", "status");
  byId("verdict").setAttribute("aria-live", "polite");
  fill("terminal", card("The same in a terminal", element("pre", { id: "commands", tabindex: "0" })));
  byId("work").hidden = false;
}

/** The causes of a diagnosis, with the one that comes first; those that are only possible are no answer. */
const causesOf = ({ candidates }) => candidates.filter((one) => one.standing !== "possible");

const addButton = (candidate) => element("button", { class: "main", type: "button", "data-add": candidate.name,
  click: () => addEffect(candidate.name, wordsOf(candidate), candidate) }, `Add ${candidate.name} to the model`);

function showVerdict(said) {
  const { verdict, headline, observations } = said.answer;
  const [first] = causesOf(said.answer);
  const looks = { adequate: "good", missing_effect: "open", unexplained_structure: "open" };
  const warnings = [...said.messages.matchAll(/^warning: (.*(?:\n .*)*)/gm)].map(([, words]) => unwrapped(words));
  const box = element("div", { class: `verdict ${looks[verdict] || ""}`, "data-verdict": verdict, "data-headline": headline },
    element("p", { class: "headline" }, typeset(headline)),
    element("p", {}, element("span", { class: "badge" }, inWords(verdict)), " ",
      typeset(unwrapped(said.text.split("\n\n")[1] || `${observations} readings`))),
    paragraphOf(said.text, "Effects that may be hidden"),
    warnings.map((one) => element("p", { class: "warning" }, element("strong", {}, "Warning: "), typeset(one))),
    first ? element("div", { class: "decide" }, addButton(first), rivalsOf(first)) : null);
  fill("verdict", box);
}

/** "thermal_drift:X:EX with t_spindle_degC", as the answers name it. */
const placeOf = ({ name, approach, sensor, sensor2 }) => name + (approach && approach !== "both" ? `, ${approach}` : "")
  + (sensor ? ` with ${sensor}${sensor2 ? ` and ${sensor2}` : ""}` : "");

/** A candidate: its title from the library, its standing, its reasons, and the button that adds it. */
function candidateBox(candidate, library) {
  const known = library.get(candidate.effect);
  const facts = [
    ["because", candidate.because], ["but", candidate.but], ["to decide", candidate.decide],
    ["cause", known && known.cause], ["check", known && known.check], [known && known.compensated ? "usual compensation" : "not compensated", known && known.how],
    ["next", candidate.next_measurement],
  ].filter(([, text]) => text);
  return element("article", { class: "candidate" },
    element("h3", {}, known ? known.title : candidate.effect, element("code", {}, placeOf(candidate)),
      element("span", { class: `badge ${candidate.standing}` }, candidate.standing
        + ((candidate.indistinguishable_from || []).length ? ": this or one that these data cannot distinguish from it" : ""))),
    element("dl", { class: "facts" },
      facts.flatMap(([name, text]) => [element("dt", {}, name), element("dd", {}, typeset(text))])),
    element("div", { class: "decide" }, addButton(candidate), rivalsOf(candidate)));
}

const percent = (part) => `${Number((100 * part).toPrecision(3))} %`;

/** The effects that these data cannot distinguish from a candidate, in the words of the diagnosis; null where there are none. */
function rivalsOf({ indistinguishable_from, set }) {
  const rivals = (indistinguishable_from || []).map((one) => one.name || one);
  if (!rivals.length) return null;
  return element("div", { class: "rivals" }, element("p", {}, element("strong", {}, "cannot be distinguished from: "), rivals.join(", ")),
    set && set.length > 1 ? element("p", {}, "one of these (more than 99 % together): ", set.map((one) => `${one.name} ${percent(one.probability)}`).join(", ")) : null);
}

/** What `ecs model add` takes beside the name of a candidate. */
function wordsOf(candidate) {
  const words = [];
  if (candidate.approach && candidate.approach !== "both") words.push("--approach", candidate.approach);
  if (candidate.sensor) words.push("--sensor", candidate.sensor);
  if (candidate.sensor2) words.push("--sensor2", candidate.sensor2);
  for (const rival of candidate.indistinguishable_from || []) words.push("--or", rival.name || rival);
  return words;
}

/** A paragraph of an answer that begins with `begin`; null where there is none. */
const paragraphOf = (text, begin) => {
  const found = new RegExp(`^${begin}.*(?:\\n {2,}.*)*`, "m").exec(text);
  return found && element("p", {}, typeset(unwrapped(found[0])));
};

/** A run, or all from one on, that differ: the sentences of the diagnosis, and the button that adds it for all senses of the data. */
function runsBox(different) {
  if (!different || !different.is_shifted) return null;
  const { run, from_there_on, text } = different;
  const name = from_there_on ? "jump" : "odd run";
  const formulas = bench.senses.map((sense) =>
    `${sense} = h${bench.senses.length > 1 ? `_${sense}` : ""} * (run ${from_there_on ? ">=" : "=="} ${run})`);
  return element("article", { class: "candidate", id: "runs" }, element("h3", {}, element("code", {}, formulas.join(", "))),
    element("p", {}, typeset(text)), element("p", {}, element("button", { class: "main", type: "button", "data-add": `user:${name}`,
      click: () => addFormula(name, formulas) },
    "Add this to the model")));
}

function showMissing(said, library) {
  const { candidates, left, formula, notes, where, different_run, outliers } = said.answer;
  const inAnswer = causesOf(said.answer);
  const possible = candidates.filter((one) => one.standing === "possible").sort((a, b) => a.rms_after_um - b.rms_after_um);
  const rows = possible.map((one) => [
    (library.get(one.effect) || {}).title || one.effect, element("code", {}, placeOf(one)), one.rms_after_um.toFixed(3),
    `${(100 * Math.max(0, one.explained)).toFixed(1)} %`,
    element("button", { type: "button", "data-add": one.name, "aria-label": `Add ${placeOf(one)} to the model`,
      click: () => addEffect(one.name, wordsOf(one), one) }, "Add")]);
  const runs = runsBox(different_run);
  const proposed = formula && element("article", { class: "candidate" },
    element("h3", {}, "A formula", element("code", {}, Object.values(formula.formula).join(", "))),
    paragraphOf(said.text, "As a formula"),
    element("p", {}, element("button", { type: "button", "data-add": "formula", click: () => addEffect("formula", []) },
      "Add the formula to the model")));
  fill("missing", card(inAnswer.length || runs ? "What is missing" : "Other effects", runs,
    inAnswer.map((one) => candidateBox(one, library)),
    runs ? null : proposed,
    left.filter((one) => one.is).length ? element("dl", { class: "facts" }, left.filter((one) => one.is).flatMap((one) =>
      [element("dt", {}, one.property), element("dd", {}, typeset(`${one.is}. ${one.because}`))])) : null,
    outliers.length ? paragraphOf(said.text, "outliers: ") : null,
    rows.length || (runs && proposed) ? element("details", {}, element("summary", {}, "Other effects that were tried"),
      rows.length ? table("rms after adding each one", ["effect", "name", ">rms after", ">explained", ""], rows) : null,
      runs ? proposed : null) : null,
    bench.game ? null : element("details", { id: "another", toggle: ({ target }) => { if (target.open) rankEffects(); } },
      element("summary", {}, "Another effect, or a formula of your own"), chooser(library), ownFormula()),
    where.length ? element("details", {}, element("summary", {}, "What the residual depends on"),
      table("share of the variance of the residual", ["variable", ">share", "looks like"], where.map((one) =>
        [one.variable, `${(100 * one.strength).toFixed(1)} %`, typeset(one.looks_like || "")]))) : null,
    notes.length ? element("details", {}, element("summary", {}, "Notes, and effects that cannot be tried with these readings"),
      notes.map((one) => element("p", { class: "soft" }, typeset(one)))) : null,
    wholeAnswer("ecs model diagnose", said.text)));
}

// --- every effect of the library, by what adding it would do

/** Effects in two groups: those that act on these data, and those that do not, with the reason of the program. */
function effectOptions(library, ranked) {
  const all = [...library.values()].filter((one) => one.effect !== "user");
  if (!ranked) return all.map((one) => element("option", { value: one.effect }, one.title));
  const acts = all.filter((one) => ranked.get(one.effect).rms !== undefined);
  if (ranked.sorted) acts.sort((a, b) => ranked.get(a.effect).place - ranked.get(b.effect).place || ranked.get(a.effect).rms - ranked.get(b.effect).rms);
  const others = all.filter((one) => !acts.includes(one));
  return [
    element("optgroup", { label: "these data can show it" }, acts.map((one) => element("option", { value: one.effect },
      ranked.sorted ? `${one.title}: rms ${ranked.get(one.effect).rms.toFixed(3)} µm` : one.title))),
    element("optgroup", { label: "these data cannot show it" }, others.map((one) =>
      element("option", { value: one.effect, disabled: true }, typeset(`${one.title}: ${ranked.get(one.effect).why}`)))),
  ].filter((group) => group.children.length);
}

function describeSuspect(event) {
  if (event) byId("suspect").dataset.touched = "yes";
  const one = effects.get(byId("suspect").value);
  byId("about-suspect").textContent = one ? `${sentence(one.cause)} ${sentence(`distinguished by: ${one.tells_apart}`)}` : "";
}

/** A list of the effects, and the button that adds the one that was chosen. */
function chooser(library) {
  return element("div", {}, element("p", { class: "row" }, element("label", { for: "suspect" }, "Effect"),
    element("select", { id: "suspect", change: describeSuspect, "aria-describedby": "about-suspect" }, effectOptions(library, null)),
    element("button", { id: "try", class: "main", type: "button", click: () => addEffect(byId("suspect").value, []) }, "Add it to the model")),
  element("p", { id: "about-suspect", class: "soft" }));
}

function ownFormula() {
  return element("div", {}, element("p", { class: "row" }, element("label", { for: "formula" }, "Formula"),
    element("input", { id: "formula", type: "text", autocomplete: "off", spellcheck: "false", placeholder: `${bench.senses[0]} = h * (run >= 5)` }),
    element("button", { id: "add-formula", type: "button",
      click: () => (byId("formula").value.trim() ? addFormula("own formula", [byId("formula").value]) : byId("formula").focus()) },
    "Add the formula")), element("p", { class: "soft" }, "A formula gives one component (EX, EY, EZ in µm; EA, EB, EC in µm/m) from "
    + "the columns of the readings, such as x_mm, run, approach (+1 forward, −1 reverse) or time_s. Any other name is a constant that is fitted."));
}

/** Adds formulas, one for a sense, under a name that the model does not have yet. */
function addFormula(name, formulas) {
  const times = bench.added.filter((one) => one.name.startsWith(`user:${name}`)).length;
  return addEffect(`user:${name}${times ? ` ${times + 1}` : ""}`, formulas.flatMap((one) => ["--formula", one]));
}

/** Tries each effect in the background; then the list has those first that leave the least, and the others with the reason. In the
 *  game before its diagnosis the order stays that of the library: it would be the answer. */
async function rankEffects() {
  const asked = bench;
  const before = bench.changes;
  const current = () => bench === asked && bench.changes === before && byId("suspect");
  const library = await effectLibrary();
  const ranked = new Map();
  const inModel = new Set((await effectsInModel()).map((name) => name.split(":")[0]));
  const candidates = asked.diagnosis ? asked.diagnosis.candidates.map((one) => one.effect) : [];
  for (const one of library.keys()) {
    if (one === "user") continue;
    if (!current()) return;
    const place = candidates.includes(one) ? candidates.indexOf(one) : candidates.length;
    try {
      const { answer } = await run("ecs", "model", "add", ...changing(one, []));
      ranked.set(one, { rms: answer.rms_after_um, place });
    } catch (error) {
      const why = error.message.replace(/^[^:]*(?::[A-Z]\w*)*: /, "").replace(/ \(`ecs [^)]*\)/, "").replace(/^these data cannot show it.*/, "cannot be detected at any place in these data");
      ranked.set(one, { why: inModel.has(one) ? "it is in the model" : why });
    }
  }
  if (!current()) return;
  ranked.sorted = !asked.game || asked.hinted;
  const select = byId("suspect");
  const chosen = select.value;
  const touched = select.dataset.touched;
  select.replaceChildren(...effectOptions(library, ranked));
  if (touched && ranked.get(chosen).rms !== undefined) select.value = chosen;
  select.dataset.ranked = ranked.sorted ? "sorted" : "grouped";
  describeSuspect();
}

/** Where the model fails: readings and model, and a row for each direction. */
function showComparison(said, svg, residual, inModel) {
  const rows = said.text.split("\n").map((line) =>
    line.match(/^(\S+(?: \S+)?)\s+(\S+)\s{2,}(\S+(?: \S+)*)\s+(\d+)\s+(-?[\d.]+)\s+([\d.]+)\s+([\d.]+)\s{2,}(.*)$/));
  // The diagnosis states rms, noise and lack of fit; without it the comparison does.
  const mostDrawn = 3;
  const drawn = bench.lineCount > mostDrawn
    ? () => element("p", { class: "soft" }, `The ${mostDrawn} of ${bench.lineCount} lines with the largest error are drawn.`) : () => null;
  const lines = figures(svg);
  const left = element("div", { class: "figures" }, [...lines.children].filter((one) => /: residual of the model\b/.test(one.getAttribute("aria-label"))));
  fill("fails", card(bench.diagnosis && bench.diagnosis.verdict === "adequate" ? "The residual" : "Where the model fails", overAbscissa(left, residual), drawn(),
    byId("verdict").firstChild ? null : element("p", {}, typeset(unwrapped(said.text.split("\n\n")[0]))),
    table("the residual, reading − model, in µm (EA, EB and EC in µm/m)",
      ["sense", "axis", "direction", ">readings", ">bias", ">rms", ">peak", "lack of fit"],
      rows.filter(Boolean).map((row) => row.slice(1))),
    wholeAnswer("ecs model compare", said.text)));
  fill("figures", card("The model against the measurement",
    element("p", { id: "effects", class: "soft" }, `In the model: ${inModel.join(", ")}.`), lines, drawn()));
}

/** The residual over the position, or over another variable, as the reader chooses. The variable on which it depends most comes
 *  first. */
function overAbscissa(overPosition, residual) {
  const shown = new Map([["position", overPosition]]);
  for (const figure of residual ? [...figures(residual).children] : []) {
    const over = / over (.*?)\. /.exec(`${figure.getAttribute("aria-label")} `)[1];
    if (!shown.has(over)) shown.set(over, element("div", { class: "figures" }));
    shown.get(over).append(figure);
  }
  const depends = bench.diagnosis && bench.diagnosis.where.length ? inWords(bench.diagnosis.where[0].variable.replace(/_\w+$/, "")) : "";
  const first = bench.abscissa && shown.has(bench.abscissa) ? bench.abscissa
    : [...shown.keys()].find((name) => depends && name.startsWith(depends)) || "position";
  const choose = (name) => shown.forEach((holder, one) => (holder.hidden = one !== name));
  choose(first);
  const choices = element("p", { class: "row", role: "radiogroup", "aria-label": "Abscissa" }, "Over ", [...shown.keys()].map((name) =>
    element("label", { class: "choice" }, element("input", { type: "radio", name: "abscissa", value: name, checked: name === first,
      change: () => { bench.abscissa = name; choose(name); } }), name)));
  return [shown.size > 1 ? choices : null, ...shown.values()].filter(Boolean);
}

/** The steps after which held-out readings are predicted worse than before. */
function heldOutWorse(history) {
  return history.map((step, i) => {
    const before = i === history.length - bench.added.length ? bench.heldOutAtStart : i ? history[i - 1].held_out_rms_um : null;
    return typeof step.held_out_rms_um === "number" && typeof before === "number" && step.held_out_rms_um > 1.001 * before;
  });
}

async function showLadder() {
  const { answer, text } = await verb("model", "history", bench.model, "--plot", "ladder.svg", "--force");
  if (!answer.history.length) return fill("ladder");
  const number = (value) => (value === null || value === undefined ? "–" : value.toFixed(3));
  const worse = heldOutWorse(answer.history);
  const last = answer.history.length - 1;
  fill("ladder", card("How far the error falls", bench.added.length ? addedWords() : null,
    worse[last] ? element("p", { class: "worse", id: "worse" }, "Held-out readings are predicted worse than before this step.") : null,
    figures(await readText("ladder.svg"), true),
    table("the residual after each step, in µm", ["step", ">rms before", ">rms", ">peak", ">noise", ">held out"],
      answer.history.map((step, i) => [step.effect || "start", number(step.rms_before_um), number(step.rms_um),
        number(step.peak_um), number(step.noise_um),
        worse[i] ? element("span", { class: "worse" }, `${number(step.held_out_rms_um)} ▲ worse`) : number(step.held_out_rms_um)])),
    [...text.matchAll(/^ +(rms and peak of .*)$/gm)].map(([, note]) => element("p", { class: "soft" }, note)),
    element("p", {}, element("button", { id: "undo", type: "button", click: takeBack }, "Remove the last effect")),
    wholeAnswer("ecs model history", text)));
}

const updateUndo = () => {
  if (bench && byId("undo")) byId("undo").disabled = busy || !bench.added.length;
};

/** ISO 230-2 as `ecs laser stats --all` prints it: a heading, quantities in rows, notes. */
async function showIso() {
  let said;
  if (!bench.lines.length) return fill("iso");
  try {
    said = await verb("laser", "stats", ...bench.lines, ...bench.importWords, "--all");
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;
    return fill("iso", card("ISO 230-2", element("p", {}, typeset(error.message))));
  }
  const blocks = said.text.split("\n\n").map((block) => block.split("\n")).filter((lines) => lines[0]);
  fill("iso", card("ISO 230-2", blocks.map((lines, i) => {
    const rows = lines.map((line) => line.match(/^ {2}(\S+(?: \S+)?)\s+(-|-?[\d.]+) (\S+) {2,}(.*)$/)).filter(Boolean);
    const notes = lines.filter((line) => line.startsWith("  note: "));
    if (!rows.length) return element("pre", { tabindex: "0" }, lines.join("\n"));
    const others = rows.filter((row) => row[2] === "-").map((row) => row[1]);
    return element("details", { open: i === 0 }, element("summary", {}, lines[0]),
      table("values of the line", ["", ">value", "unit", "meaning"], rows.filter((row) => row[2] !== "-").map((row) =>
        [row[1], row[2], typeset(row[3]), typeset(row[4])])),
      others.length ? element("p", { class: "soft" }, `Not determined by these readings: ${others.join(", ")}.`) : null,
      notes.map((one) => element("p", { class: "soft" }, typeset(one.slice(8)))));
  })));
}

// --- results to save

function save(name, bytes, type) {
  const link = element("a", { href: URL.createObjectURL(new Blob([bytes], { type })), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  const done = `Saved: ${name}, ${Math.max(1, Math.round(bytes.length / 1000))} kB.`;
  byId("saved").textContent = done;
  return done;
}

/** A name that says what was measured and what was added: "x_axis_with_cyclic-X-EX_model.toml". */
function fileName(end) {
  const several = (names, longest) => (names.length < 2 || names.join("+").length <= longest ? names.join("+") : `${names[0]}_and_${names.length - 1}_more`);
  const [first, ...others] = bench.lines.length ? bench.lines : bench.data;
  const data = first.replace(/^.*\//, "").replace(/\.\w+$/, "") + (others.length ? `_and_${others.length}_more` : "");
  const added = several(bench.added.map(({ name }) => name.replace(/^user:/, "").replace(/[^\w.]+/g, "-")), 60);
  return [bench.game ? `case_${bench.seed}` : data, added && `with_${added}`, end].filter(Boolean).join("_");
}

/** The model with values, fitted to the data where it has none. */
async function fitted() {
  await verb("model", "fit", ...dataWords(), "-o", "fitted.toml", "--force");
  return "fitted.toml";
}

async function saveModel() {
  return save(fileName("model.toml"), await readBytes(await fitted()), "application/toml");
}

async function saveDiagnosis() {
  const said = await verb("model", "diagnose", ...dataWords());
  return save(fileName("diagnosis.json"), said.json, "application/json");
}

async function saveMap() {
  await verb("map", "build", "--from-model", await fitted(), ...machineWords(), "--zero-missing", "not in the model",
    "-o", "map.csv", "--force");
  return save(fileName("map.csv"), await readBytes("map.csv"), "text/csv");
}

/** The measurement lines, a file each, as a report takes them: the readings as `ecs laser import` writes them. */
async function lineFiles() {
  await verb("laser", "import", ...bench.lines, ...bench.importWords, "-o", "all.csv", "--force");
  const lines = (await readText("all.csv")).split("\n").filter(Boolean);
  const comments = lines.filter((line) => line.startsWith("#"));
  const [titles, ...rows] = lines.filter((line) => !line.startsWith("#"));
  const columns = titles.split(",");
  const at = (cells, name) => (columns.includes(name) ? cells[columns.indexOf(name)] : "");
  const files = new Map();
  for (const row of rows) {
    const cells = row.split(",");
    const axis = at(cells, "axis");
    const parked = ["X", "Y", "Z"].filter((one) => one !== axis).map((one) =>
      Number(at(cells, `${one.toLowerCase()}_mm`) || 0).toFixed(1));
    const place = [at(cells, "sense") + axis, ...parked].join(" ");
    if (!files.has(place)) files.set(place, []);
    files.get(place).push(row);
  }
  const used = new Set();
  for (const [place, own] of files) {
    const component = place.split(" ")[0];
    let name = component;
    for (let k = 2; used.has(name); ++k) name = `${component}_${k}`;
    used.add(name);
    await write(`before/${name}.csv`, new TextEncoder().encode([...comments, titles, ...own, ""].join("\n")));
  }
  const told = `# before/ holds the lines of all.csv, a file each: ${[...used].join(", ")}`;
  if (!bench.commands.includes(told)) bench.commands.push(told);
}

async function saveReport() {
  await lineFiles();
  await verb("report", "--before", "before", "--model", bench.model, "--data", ...bench.data, ...machineWords(),
    "-o", "report.html", "--force");
  return save(fileName("report.html"), await readBytes("report.html"), "text/html");
}

/** In the game not before a guess: a diagnosis is the answer. */
function showTake() {
  if (bench.game && !bench.hinted && !bench.added.length) return fill("take");
  const button = (id, words, work) =>
    element("button", { id, type: "button", click: () => during("The file is being written.", work) }, words);
  const [found] = bench.diagnosis ? causesOf(bench.diagnosis) : [];
  fill("take", card("Save results",
    found ? element("p", { id: "lacking" }, `The model does not have ${found.name} yet. Add it before you save the model, the map or the report.`)
      : null,
    element("p", { class: "row" },
    button("save-model", "Model (.toml)", saveModel), button("save-map", "Error map (.csv)", saveMap),
    button("save-report", "Report (.html)", saveReport), button("save-diagnosis", "Diagnosis (.json)", saveDiagnosis)),
  element("p", { id: "saved", role: "status", "aria-live": "polite" })));
}

// --- what a person does

let effects = null;

/** The library of effects, by id. */
async function effectLibrary() {
  if (effects === null)
    effects = new Map((await run("ecs", "model", "effects")).answer.effects.map((one) => [one.effect, one]));
  return effects;
}

async function diagnose() {
  const said = await verb("model", "diagnose", ...dataWords());
  bench.diagnosis = said.answer;
  if (!bench.added.length)
    bench.heldOutAtStart = (said.answer.candidates.find((one) => one.held_out_rms_before_um) || {}).held_out_rms_before_um || null;
  showVerdict(said);
  showMissing(said, await effectLibrary());
}

/** "load:X:EX" for each effect. */
const effectsInModel = async () => (await run("ecs", "model", "history", bench.model)).answer.effects;

async function compare() {
  const said = await verb("model", "compare", ...dataWords(), "--plot", "model.svg", "--force");
  let residual = "";
  try {
    await verb("model", "compare", ...dataWords(), "--plot-residual", "residual.svg", "--force");
    residual = await readText("residual.svg");
  } catch (error) {
    if (!(error instanceof Refusal)) throw error;  // nothing but the position changes
  }
  showComparison(said, await readText("model.svg"), residual, await effectsInModel());
}

/** What `ecs model add` takes: the model, an effect, the data. */
const changing = (name, more) => [bench.model, name, "--data", ...bench.data, ...machineWords(), ...more,
  ...bench.importWords.map((word) => (word === "--sense" ? "--reading-sense" : word))];

/** Adds an effect; afterwards everything is shown again. */
function addEffect(name, more, candidate = null) {
  return during(`Adding ${name}.`, async () => {
    clearGame();
    const before = await readBytes(bench.model);
    const already = bench.commands.length;
    const said = await verb("model", "add", ...changing(name, more), "-o", bench.model);
    bench.added.push({ before, name, said, candidate, command: bench.commands[already] });
    ++bench.changes;
    if (bench.game) showGuessed(said);
    await showAll();
    focusOn(byId(bench.game ? "guess" : "ladder").querySelector("h2"));
    if (!bench.game) byId("verdict").scrollIntoView({ block: "start" });
  });
}

/** What was said of the model before it changed. */
function clearGame() {
  for (const part of ["guessed", "revealed"]) if (byId(part)) byId(part).replaceChildren();
}

function takeBack() {
  return during("The last effect is being removed.", async () => {
    const { name, before, command } = bench.added.pop();
    await write(bench.model, before);
    bench.commands = bench.commands.filter((one) => one !== command);
    ++bench.changes;
    clearGame();
    await showAll();
    focusOn(byId("about").querySelector("h2"));
    return `Removed: ${name}.`;
  });
}

async function showAll() {
  if (!bench.game || bench.hinted) await diagnose();
  await compare();
  await showLadder();
  if (!byId("iso").firstChild) await showIso();
  showTake();
  showSealed();
  if (bench.game) rankEffects();
}

// --- the game

/** What `ecs model add` answered: its first sentence, and the values. */
function wordsOfAnswer(said) {
  const lines = said.text.split("\n\n")[0].split("\n");
  const [summary, values] = [(line) => !line.startsWith(" "), (line) => line.startsWith(" ")].map((is) =>
    typeset(unwrapped(lines.filter(is).join("\n"))));
  return [element("p", {}, element("strong", {}, summary)), element("p", {}, values)];
}
const showGuessed = (said) => byId("guessed").replaceChildren(...wordsOfAnswer(said));

/** What was added last, and what stays open about it. */
function addedWords() {
  const { said, candidate } = bench.added[bench.added.length - 1];
  const rivals = candidate && rivalsOf(candidate);
  return element("div", { id: "added" }, bench.game ? null : wordsOfAnswer(said), rivals,
    rivals && candidate.next_measurement ? element("p", {}, typeset(`next: ${candidate.next_measurement}`)) : null);
}

async function showGuess() {
  const library = await effectLibrary();
  fill("guess", card("Which effect do you suspect?",
    element("p", {}, "Look at the residual below: does it depend on the position, on the approach, on the time? Choose an "
      + "effect and add it to the model. The right one makes the residual fall to the noise."),
    chooser(library),
    element("div", { id: "guessed", role: "status", "aria-live": "polite" }),
    element("p", { class: "row" },
      element("button", { id: "hint", type: "button", click: hint }, "Show the diagnosis"),
      element("button", { id: "truth", type: "button", click: showTruth }, "Show the truth")),
    element("div", { id: "revealed", role: "status", "aria-live": "polite" })));
  describeSuspect();
}

function hint() {
  return during("The diagnosis is being computed.", async () => {
    bench.hinted = true;
    await diagnose();
    showTake();
    byId("verdict").scrollIntoView({ block: "nearest" });
    rankEffects();
  });
}

/** The truth of a case, and whether the model has it. */
function showTruth() {
  return during("The truth is being opened.", async () => {
    const said = await run("ecs", "model", "reveal", bench.sealed);
    note(["model", "reveal", bench.sealed]);
    const { history } = (await run("ecs", "model", "history", bench.model)).answer;
    const { truth } = said.answer;
    const hidden = truth.effects.map((one) => one.name);
    const added = history.map((step) => step.effect).filter(Boolean);
    // One of a group that these data cannot tell apart is the answer too.
    const isTrue = (name) => hidden.includes(name) || truth.group.includes(name);
    const found = hidden.filter((name) => added.some((one) => one === name || (truth.group.includes(one) && truth.group.includes(name))));
    const wrong = added.filter((name) => hidden.length && !isTrue(name));
    byId("revealed").replaceChildren(
      element("p", {}, element("strong", { id: "hidden-text" }, typeset(truth.text))),
      hidden.length ? element("p", {}, found.length === hidden.length ? "Your model has it." : "Your model does not have it.",
        wrong.length ? ` It also has what this machine does not have: ${wrong.join(", ")}.` : "") : "",
      wholeAnswer("ecs model reveal", said.text));
  });
}

/** A case whose truth is sealed among the files: to be opened after an answer. */
function showSealed() {
  if (bench.game || !bench.sealed || byId("revealed")) return updateSealed();
  fill("sealed", card("What was hidden",
    element("p", {}, "The truth of this case is sealed. Add the effects that you suspect, or answer that nothing is missing; then open it."),
    element("p", { class: "row" },
      element("button", { id: "nothing", type: "button", click: () => { bench.answered = true; updateSealed(); } }, "Nothing is missing"),
      element("button", { id: "truth", class: "main", type: "button", click: showTruth }, "Show what was hidden")),
    element("div", { id: "revealed", role: "status", "aria-live": "polite" })));
  updateSealed();
}
function updateSealed() {
  if (bench && !bench.game && bench.sealed && byId("truth")) byId("truth").disabled = busy || !(bench.answered || bench.added.length);
}

const isDrawn = () => Boolean(bench && bench.seed === byId("seed").value);
const updatePlay = () => (byId("play").textContent = isDrawn() ? "Draw the next case" : "Draw this case");

function play(event) {
  event.preventDefault();
  if (!byId("game").reportValidity()) return;
  if (isDrawn()) byId("seed").value = String(Number(bench.seed) + 1);
  const seed = byId("seed").value;
  return during("The emulated machine is being measured.", async () => {
    bench = null;
    given.clear();
    byId("given").textContent = "";
    await ask({ action: "clear" });
    const words = ["hide", "--seed", seed, "--kind", "single", "-o", "made"];
    const said = await run("ecs-emulator", ...words);
    const files = ["machine.toml", "model.toml", "data.csv", "truth.sealed"];
    if ((await ask({ action: "has", path: "made/map.csv" }))) files.push("map.csv");
    for (const file of files) await write(file, await readBytes(`made/${file}`));
    await write("mine.toml", await readBytes("model.toml"));
    putOnBench({ game: true, seed, hinted: false, model: "mine.toml", machine: "machine.toml", data: ["data.csv"], lines: ["data.csv"],
      sealed: ".", ...countsOf(await run("ecs", "laser", "import", "data.csv")) });
    note(words.slice(0, -1).concat("case"), "ecs-emulator");
    bench.commands.push("cd case", "cp model.toml mine.toml");
    fill("about", element("h2", { tabindex: "-1", id: "case" }, `Case ${seed}`),
      element("p", {}, said.text.trim().replace(/^[^:]*: /, "")));
    await showGuess();
    await showAll();
    focusOn(byId("case"));
  });
}

// --- files of one's own

/** Name and bytes of all files that were dropped or chosen. */
const given = new Map();
/** Names of those that took the place of others at last. */
let replaced = [];
/** The measured file that comes first, and with it its machine; of files that do not go together. */
let preferred = null;

/** "--a 'b c'" as words, quotes as in a shell. */
const wordsIn = (line) =>
  [...line.matchAll(/(?:"([^"]*)"|'([^']*)'|[^\s"']+)+/g)].map(([word]) => word.replace(/"([^"]*)"|'([^']*)'/g, "$1$2"));

function importWords() {
  const words = wordsIn(byId("more").value);
  if (byId("axis").value) words.push("--axis", byId("axis").value);
  if (byId("sense").value) words.push("--sense", byId("sense").value);
  return words;
}

/** A free name for a new model. */
function newModelName(names) {
  let name = "model.toml";
  for (let k = 2; names.includes(name); ++k) name = `model_${k}.toml`;
  return name;
}

/** What is on the bench from now on; nothing was added yet. */
function putOnBench(what) {
  bench = { importWords: [], commands: [], added: [], changes: 0, ...what };
  layOut();
}

/** The reason of a refusal, without the name of the file in front. */
const whyNot = (name, { message }) => (message.startsWith(name) ? message.slice(name.length).replace(/^[:\d]*: /, "") : message);

/** The measured files among `names` that can be read together; the others with the reason, in `unread`. One that stands alone is
 *  refused as `ecs laser import` refuses it. */
async function readable(names, importWith, unread, hasPaths) {
  if (names.length < 2 && !hasPaths) return names;
  const refusal = async (...files) => {
    try {
      const { answer } = await run("ecs", "laser", "import", ...files, ...importWith);
      if (answer.files.some((one) => !one.readings)) await run("ecs", "model", "new", "none.toml", files.at(-1), ...importWith);
      const turns = (axis) => "ABC".includes(axis);
      if (answer.axes.some(turns) && !answer.axes.every(turns)) await run("ecs", "model", "new", "none.toml", ...files, ...importWith);
      return null;
    } catch (error) {
      if (error instanceof Refusal) return error;
      throw error;
    }
  };
  const good = [];
  for (const name of names) {
    const why = await refusal(...good, name);
    const alone = why && good.length ? await refusal(name) : why;
    if (!why) good.push(name);
    else unread.push([name, whyNot(name, alone || why), !alone]);
  }
  if (!good.length && !hasPaths) throw new Refusal(unread.map(([name, why]) => `${name}: ${why}`).join("\n"));
  return good;
}

/** The models among `names` that can be read; the others with the reason, in `unread`. */
async function readableModels(names, unread) {
  const good = [];
  for (const name of names) {
    try {
      await run("ecs", "model", "history", name);
      good.push(name);
    } catch (error) {
      if (!(error instanceof Refusal)) throw error;
      unread.push([name, whyNot(name, error)]);
    }
  }
  return good;
}

const folderOf = (name) => name.slice(0, name.lastIndexOf("/") + 1);

/** A file and why it is not used; a long reason opens behind its first clause. */
function reason(name, why) {
  const [first, ...more] = why.split("; ");
  const line = [element("strong", {}, name), `: ${first}`];
  return more.length ? element("details", {}, element("summary", {}, line), more.join("; ")) : line;
}

/** Senses and number of the lines that `ecs laser import` answered; null where there are only circles or diagonals. */
const countsOf = (imported) => (imported ? { senses: imported.answer.senses, lineCount: imported.answer.lines.length }
  : { senses: ["EX", "EY", "EZ"], lineCount: 0 });

/** The lines that were measured, as `ecs laser import` lists them. On a narrow screen they are closed: the verdict comes first. */
function linesTable({ lines }) {
  const number = (value) => (value === null || value === undefined ? "varies" : String(Number(value.toPrecision(6))));
  const rows = lines.map((line) => [line.axis, line.sense, Object.entries(line.parked_mm || {}).map(([axis, at]) => `${axis.toUpperCase()} ${number(at)}`).join(", "),
    number(line.from_mm ?? line.from_deg), number(line.to_mm ?? line.to_deg), number(line.step_mm ?? line.step_deg), String(line.targets), String(line.runs),
    line.forward && line.reverse ? "both" : line.forward ? "forward" : line.reverse ? "reverse" : "unknown"]);
  const titles = ["axis", "sense", "parked", ">from", ">to", ">step", ">targets", ">runs", "approach"];
  const most = 6;
  const wide = matchMedia("(min-width: 521px)").matches;
  return [element("details", { open: wide }, element("summary", {}, rows.length > 1 ? `${rows.length} measured lines` : "The measured line"),
    table("measured lines", titles, rows.slice(0, most))), rows.length > most ? element("details", {},
    element("summary", {}, `${rows.length - most} more lines`), table("more measured lines", titles, rows.slice(most))) : null];
}

function analyse() {
  return during("The files are being read.", async () => {
    bench = null;
    byId("work").hidden = true;
    await ask({ action: "clear" });
    const names = [...given.keys()].sort((a, b) => (b === preferred) - (a === preferred) || (a < b ? -1 : 1));
    byId("given").textContent = (names.length ? `Files: ${names.join(", ")}` : "") + (replaced.length ? `. Replaced: ${replaced.join(", ")}` : "");
    for (const [name, bytes] of given) await write(name, bytes);
    const { files: looks } = (await run("look", ...names)).answer;
    const of = (...kinds) => looks.filter((one) => kinds.includes(one.kind)).map((one) => one.file);
    const others = ["machine", "model", "error map", "parameters", "recipe", "measurement plan"];
    const words = importWords();
    const unread = [];
    const isSealed = (name) => /(^|\/)truth\.sealed$/.test(name);
    const measured = looks.filter((one) => !others.includes(one.kind) && !isSealed(one.file)).map((one) => one.file);
    if (!measured.length) await run("ecs", "laser", "import", ...names);  // it says what they are
    if (!measured.length) throw new Refusal("No measurement is among the files. Choose a file of readings as well.");
    const paths = of("circular test", "diagonal test");
    const lines = await readable(measured.filter((name) => !paths.includes(name)), words, unread, paths.length > 0);
    const data = measured.filter((name) => paths.includes(name) || lines.includes(name));
    // Of several machines and models those that lie beside the readings.
    const beside = (list) => list.find((name) => folderOf(name) === folderOf(data[0])) || list[0];
    const machine = beside(of("machine")) || null;
    const models = await readableModels(of("model"), unread);
    let model = beside(models);
    const sealed = model && machine && names.find((name) => isSealed(name) && folderOf(name) === folderOf(model));
    for (const name of [...of("machine"), ...models])
      if (name !== machine && name !== model) unread.push([name, looks.find((one) => one.file === name).what]);
    const imported = lines.length ? await run("ecs", "laser", "import", ...lines, ...words) : null;
    putOnBench({ game: false, model: model || newModelName(names), machine, data, lines, importWords: words,
      ...countsOf(imported), sealed: sealed ? folderOf(sealed) || "." : null });
    if (sealed) {  // its model stays as it is: the truth is compared with it
      bench.model = `${folderOf(model)}mine.toml`;
      await write(bench.model, await readBytes(model));
      bench.commands.push(`cp ${model} ${bench.model}`);
    }
    if (!model) await verb("model", "new", ...dataWords());
    fill("about", element("h2", { tabindex: "-1", id: "case" }, data.join(", ")),
      unread.length ? element("div", { id: "unread", class: "card" }, element("h3", {}, "Not used"),
        element("ul", {}, unread.map(([name, why, readable]) => element("li", {}, reason(name, typeset(why)),
          readable ? element("button", { type: "button", click: () => { preferred = name; analyse(); } }, `Analyse ${name} instead`) : null)))) : null,
      imported ? linesTable(imported.answer) : null,
      imported && imported.messages ? element("p", { class: "soft" }, typeset(unwrapped(imported.messages))) : null);
    say("The diagnosis is being computed.");
    await showAll();
    focusOn(byId("case"));
  });
}

/** Adds files to those that are there, by name; the additions to a model stay where no other model comes. */
async function takeIn(files) {
  if (busy || !files.length) return;
  if (bench && !bench.game && bench.added.length && given.size) given.set(bench.model, await readBytes(bench.model));
  replaced = [];
  for (const { name: path, file } of files) {
    const name = path.replace(/[\\\n]/g, "_");
    if (given.has(name)) replaced.push(name);
    given.set(name, new Uint8Array(await file.arrayBuffer()));
  }
  await analyse();
}

function startAgain() {
  given.clear();
  preferred = bench = null;
  byId("given").textContent = "";
  for (const field of ["files", "axis", "sense", "more"]) byId(field).value = "";
  say("");
  byId("work").hidden = true;
  byId("work").replaceChildren();
  complain("");
  setBusy(false);
  byId("files").focus();
}

const chosenFiles = (list) => [...list].map((file) => ({ name: file.name.replaceAll("/", "_"), file }));

/** The files below a folder that was dropped, each with its way from there; what begins with a dot is of the system. */
async function filesBelow(folder, way = "") {
  const files = [];
  const take = async (name, isFolder, one, file) => {
    if (name.startsWith(".")) return;
    if (isFolder) files.push(...await filesBelow(one, `${way}${name}/`));
    else files.push({ name: way + name, file: await file() });
  };
  if (folder.values) {
    for await (const one of folder.values()) await take(one.name, one.kind === "directory", one, () => one.getFile());
    return files;
  }
  const reader = folder.createReader();
  for (;;) {  // it gives a hundred at a time
    const some = await new Promise((found, failed) => reader.readEntries(found, failed));
    if (!some.length) return files;
    for (const one of some) await take(one.name, one.isDirectory, one, () => new Promise((found, failed) => one.file(found, failed)));
  }
}

/** What was dropped; one folder alone is the case, so its files need no way from above it. A handle can be walked on a page from a disc
 *  too, an entry cannot (Chromium). */
async function droppedFiles(transfer) {
  const files = [...transfer.files];
  const items = [...transfer.items].filter((item) => item.kind === "file");
  const folders = items.map((item) => {
    const entry = item.webkitGetAsEntry && item.webkitGetAsEntry();
    if (!entry || !entry.isDirectory) return null;
    return { name: entry.name, folder: item.getAsFileSystemHandle ? item.getAsFileSystemHandle() : entry };
  });
  const found = chosenFiles(files.filter((_, i) => !folders[i]));
  const alone = items.length === 1;
  for (const one of folders.filter(Boolean)) found.push(...await filesBelow(await one.folder, alone ? "" : `${one.name}/`));
  return found;
}

function listen() {
  byId("game").addEventListener("submit", play);
  byId("seed").addEventListener("input", updatePlay);
  byId("own").addEventListener("submit", (event) => event.preventDefault());
  byId("files").addEventListener("change", (event) => takeIn(chosenFiles(event.target.files)));
  byId("again").addEventListener("click", analyse);
  for (const field of ["axis", "sense"]) byId(field).addEventListener("change", () => given.size && analyse());
  byId("restart").addEventListener("click", startAgain);
  const drop = byId("drop");
  for (const kind of ["dragenter", "dragover"])
    document.addEventListener(kind, (event) => { event.preventDefault(); drop.classList.add("over"); });
  document.addEventListener("dragleave", (event) => { if (!event.relatedTarget) drop.classList.remove("over"); });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    drop.classList.remove("over");
    droppedFiles(event.dataTransfer).then(takeIn).catch((error) => complain(error.message));
  });
}

listen();
begin().then(() => { say("Ready."); setBusy(false); }, (error) => { say(""); complain(error.message); });
