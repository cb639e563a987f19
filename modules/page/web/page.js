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
  const cells = (tag, row) =>
    row.map((cell, i) => element(tag, { class: isNumber[i] ? "n" : null, scope: tag === "th" ? "col" : null }, cell));
  return element("div", { class: "table" }, element("p", { class: "soft" }, caption),
    element("div", { class: "scroll", role: "region", "aria-label": caption, tabindex: "0" }, element("table", { "aria-label": caption },
      element("thead", {}, element("tr", {}, cells("th", titles.map((title) => title.replace(">", ""))))),
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
    byId("again").disabled = !lastFiles.length;
    updateUndo();
  }
}

/** Runs `work` while nothing else can be asked for; tells what it does and what went wrong. */
async function during(text, work) {
  if (busy) return;
  complain("");
  say(text);
  setBusy(true);
  try {
    await work();
    say("");
  } catch (error) {
    say("");
    complain(error.message);
    if (error instanceof Refusal && bench === null) byId("options").open = true;
  } finally {
    setBusy(false);
  }
}

// --- cards

const parts = ["about", "guess", "verdict", "ladder", "missing", "figures", "iso", "take", "terminal"];
const fill = (part, ...children) => byId(part).replaceChildren(...children.filter(Boolean));

function layOut() {
  byId("work").replaceChildren(...parts.map((part) => element("div", { id: part })));
  byId("verdict").setAttribute("role", "status");
  byId("verdict").setAttribute("aria-live", "polite");
  fill("terminal", card("The same in a terminal", element("pre", { id: "commands", tabindex: "0" })));
  byId("work").hidden = false;
}

function showVerdict(said) {
  const { verdict, headline, observations } = said.answer;
  const looks = { adequate: "good", missing_effect: "open", unexplained_structure: "open" };
  const box = element("div", { class: `verdict ${looks[verdict] || ""}`, "data-verdict": verdict, "data-headline": headline },
    element("p", { class: "headline" }, typeset(headline)),
    element("p", {}, element("span", { class: "badge" }, inWords(verdict)), " ",
      typeset(unwrapped(said.text.split("\n\n")[1] || `${observations} readings`))));
  fill("verdict", box);
}

/** A candidate: its title from the library, its standing, its reasons, and the button that adds it. */
function candidateBox(candidate, library) {
  const known = library.get(candidate.effect);
  const facts = [
    ["because", candidate.because], ["but", candidate.but], ["to decide", candidate.decide],
    ["cannot be told from", (candidate.indistinguishable_from || []).map((one) => one.name || one).join(", ")],
    ["cause", known && known.cause], ["check", known && known.check], ["compensated", known && known.how],
    ["next", candidate.next_measurement],
  ].filter(([, text]) => text);
  return element("article", { class: "candidate" },
    element("h3", {}, known ? known.title : candidate.effect, element("code", {}, candidate.name),
      element("span", { class: `badge ${candidate.standing}` }, candidate.standing)),
    element("dl", { class: "facts" },
      facts.flatMap(([name, text]) => [element("dt", {}, name), element("dd", {}, typeset(text))])),
    element("p", {}, element("button", { class: "main", type: "button", "data-add": candidate.name,
      click: () => addEffect(candidate.name, wordsOf(candidate)) }, `Add ${candidate.name} to the model`)));
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

function showMissing(said, library) {
  const { candidates, left, formula, notes, where } = said.answer;
  const inAnswer = candidates.filter((one) => one.standing !== "possible");
  const possible = candidates.filter((one) => one.standing === "possible");
  const rows = possible.map((one) => [
    (library.get(one.effect) || {}).title || one.effect, element("code", {}, one.name), one.rms_after_um.toFixed(3),
    `${(100 * one.explained).toFixed(1)} %`,
    element("button", { type: "button", "data-add": one.name, "aria-label": `Add ${one.name} to the model`,
      click: () => addEffect(one.name, wordsOf(one)) }, "Add")]);
  fill("missing", card("What is missing",
    inAnswer.length ? inAnswer.map((one) => candidateBox(one, library))
      : element("p", {}, said.answer.verdict === "adequate" ? "Nothing is missing." : "No effect is named."),
    formula ? element("article", { class: "candidate" },
      element("h3", {}, "A formula", element("code", {}, Object.values(formula.formula).join(", "))),
      element("p", {}, typeset(formula.why)),
      element("p", {}, element("button", { type: "button", "data-add": "formula", click: () => addEffect("formula", []) },
        "Add the formula to the model"))) : null,
    left.filter((one) => one.is).length ? element("dl", { class: "facts" }, left.filter((one) => one.is).flatMap((one) =>
      [element("dt", {}, one.property), element("dd", {}, typeset(`${one.is}. ${one.because}`))])) : null,
    rows.length ? element("details", {}, element("summary", {}, "Other effects that were tried"),
      table("rms after adding each one", ["effect", "name", ">rms after", ">explained", ""], rows)) : null,
    where.length ? element("details", {}, element("summary", {}, "What the residual depends on"),
      table("share of the variance of the residual", ["variable", ">share", "looks like"], where.map((one) =>
        [one.variable, `${(100 * one.strength).toFixed(1)} %`, typeset(one.looks_like || "")]))) : null,
    notes.map((one) => element("p", { class: "soft" }, typeset(one))),
    wholeAnswer("ecs model diagnose", said.text)));
}

/** Where the model fails: readings and model, and a row for each direction. */
function showComparison(said, svg) {
  const rows = said.text.split("\n").map((line) =>
    line.match(/^(\S+(?: \S+)?)\s+(\S+)\s{2,}(\S+(?: \S+)*)\s+(\d+)\s+(-?[\d.]+)\s+([\d.]+)\s+([\d.]+)\s{2,}(.*)$/));
  fill("figures", card("The model against the measurement", figures(svg),
    element("p", {}, typeset(unwrapped(said.text.split("\n\n")[0]))),
    table("the residual, reading − model, in µm (EA, EB and EC in µm/m)",
      ["sense", "axis", "direction", ">readings", ">bias", ">rms", ">peak", "lack of fit"],
      rows.filter(Boolean).map((row) => row.slice(1))),
    wholeAnswer("ecs model compare", said.text)));
}

async function showLadder() {
  const { answer, text } = await verb("model", "history", bench.model, "--plot", "ladder.svg", "--force");
  if (!answer.history.length) return fill("ladder");
  const number = (value) => (value === null || value === undefined ? "–" : value.toFixed(3));
  fill("ladder", card("How far the error falls", figures(await readText("ladder.svg"), true),
    table("the residual after each step, in µm", ["step", ">rms before", ">rms", ">peak", ">noise", ">held out"],
      answer.history.map((step) => [step.effect || "start", number(step.rms_before_um), number(step.rms_um),
        number(step.peak_um), number(step.noise_um), number(step.held_out_rms_um)])),
    element("p", {}, element("button", { id: "undo", type: "button", click: takeBack }, "Take the last effect out again")),
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

// --- files to take away

function save(name, bytes, type) {
  const link = element("a", { href: URL.createObjectURL(new Blob([bytes], { type })), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** The model with values, fitted to the data where it has none. */
async function fitted() {
  await verb("model", "fit", ...dataWords(), "-o", "fitted.toml", "--force");
  return "fitted.toml";
}

async function saveModel() {
  save("model.toml", await readBytes(await fitted()), "application/toml");
}

async function saveDiagnosis() {
  const said = await verb("model", "diagnose", ...dataWords());
  save("diagnosis.json", said.json, "application/json");
}

async function saveMap() {
  await verb("map", "build", "--from-model", await fitted(), ...machineWords(), "--zero-missing", "not in the model",
    "-o", "map.csv", "--force");
  save("map.csv", await readBytes("map.csv"), "text/csv");
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
  save("report.html", await readBytes("report.html"), "text/html");
}

function showTake() {
  const button = (id, words, work) =>
    element("button", { id, type: "button", click: () => during("The file is being written.", work) }, words);
  fill("take", card("Take away", element("p", { class: "row" },
    button("save-model", "Model (model.toml)", saveModel), button("save-map", "Error map (map.csv)", saveMap),
    button("save-report", "Report (report.html)", saveReport),
    button("save-diagnosis", "Diagnosis (diagnosis.json)", saveDiagnosis))));
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
  showVerdict(said);
  showMissing(said, await effectLibrary());
}

async function compare() {
  const said = await verb("model", "compare", ...dataWords(), "--plot", "model.svg", "--force");
  showComparison(said, await readText("model.svg"));
}

/** Adds an effect; afterwards everything is shown again. */
function addEffect(name, more) {
  return during(`Adding ${name}.`, async () => {
    clearGame();
    const before = await readBytes(bench.model);
    const said = await verb("model", "add", bench.model, name, "--data", ...bench.data, ...machineWords(), ...more,
      ...bench.importWords.map((word) => (word === "--sense" ? "--reading-sense" : word)), "-o", bench.model);
    bench.added.push(before);
    if (bench.game) showGuessed(said);
    await showAll();
    focusOn(byId(bench.game ? "guess" : "ladder").querySelector("h2"));
    if (!bench.game) byId("verdict").scrollIntoView({ block: "start" });
  });
}

/** What was said of the model before it changed. */
function clearGame() {
  for (const part of bench.game ? ["guessed", "revealed"] : []) byId(part).replaceChildren();
}

function takeBack() {
  return during("Taking the last effect out.", async () => {
    await write(bench.model, bench.added.pop());
    clearGame();
    await showAll();
    focusOn(byId("about").querySelector("h2"));
  });
}

async function showAll() {
  if (!bench.game || bench.hinted) await diagnose();
  await compare();
  await showLadder();
  if (!byId("iso").firstChild) await showIso();
  showTake();
}

// --- the game

function showGuessed(said) {
  const lines = said.text.split("\n\n")[0].split("\n");
  const [summary, values] = [(line) => !line.startsWith(" "), (line) => line.startsWith(" ")].map((is) =>
    typeset(unwrapped(lines.filter(is).join("\n"))));
  byId("guessed").replaceChildren(element("p", {}, element("strong", {}, summary)), element("p", {}, values));
}

async function showGuess() {
  const library = await effectLibrary();
  const describe = () => {
    const one = library.get(byId("suspect").value);
    byId("about-suspect").textContent = one ? `${sentence(one.cause)} ${sentence(`distinguished by: ${one.tells_apart}`)}` : "";
  };
  const options = [...library.values()].filter((one) => one.effect !== "user").map((one) =>
    element("option", { value: one.effect }, one.title));
  fill("guess", card("Which effect do you suspect?",
    element("p", {}, "Look at the residual below: does it depend on the position, on the approach, on the time? Choose an "
      + "effect and add it to the model. The right one makes the residual fall to the noise."),
    element("p", { class: "row" }, element("label", { for: "suspect" }, "Effect"),
      element("select", { id: "suspect", change: describe, "aria-describedby": "about-suspect" }, options),
      element("button", { id: "try", class: "main", type: "button", click: () => addEffect(byId("suspect").value, []) },
        "Add it to the model")),
    element("p", { id: "about-suspect", class: "soft" }),
    element("div", { id: "guessed", role: "status", "aria-live": "polite" }),
    element("p", { class: "row" },
      element("button", { id: "hint", type: "button", click: hint }, "Show the diagnosis"),
      element("button", { id: "truth", type: "button", click: showTruth }, "Show the truth")),
    element("div", { id: "revealed", role: "status", "aria-live": "polite" })));
  describe();
}

function hint() {
  return during("The diagnosis is being computed.", async () => {
    bench.hinted = true;
    await diagnose();
    byId("verdict").scrollIntoView({ block: "nearest" });
  });
}

function showTruth() {
  return during("The truth is being opened.", async () => {
    const said = await run("ecs", "model", "reveal", ".");
    note(["model", "reveal", "."]);
    const { history } = (await run("ecs", "model", "history", bench.model)).answer;
    const hidden = said.answer.truth.effects.map((one) => one.name);
    const found = hidden.filter((name) => history.some((step) => step.effect === name));
    const wrong = history.map((step) => step.effect).filter((name) => name && !hidden.includes(name));
    byId("revealed").replaceChildren(
      element("p", {}, element("strong", { id: "hidden-text" }, typeset(said.answer.truth.text))),
      element("p", {}, found.length === hidden.length ? "Your model has it." : "Your model does not have it.",
        wrong.length ? ` It also has what this machine does not have: ${wrong.join(", ")}.` : ""),
      wholeAnswer("ecs model reveal", said.text));
  });
}

function play(event) {
  event.preventDefault();
  if (!byId("game").reportValidity()) return;
  const seed = byId("seed").value;
  return during("The emulated machine is being measured.", async () => {
    bench = null;
    await ask({ action: "clear" });
    const words = ["hide", "--seed", seed, "--kind", "single", "-o", "made"];
    const said = await run("ecs-emulator", ...words);
    const files = ["machine.toml", "model.toml", "data.csv", "truth.sealed"];
    if ((await ask({ action: "has", path: "made/map.csv" }))) files.push("map.csv");
    for (const file of files) await write(file, await readBytes(`made/${file}`));
    await write("mine.toml", await readBytes("model.toml"));
    bench = { game: true, hinted: false, model: "mine.toml", machine: "machine.toml", data: ["data.csv"], lines: ["data.csv"], importWords: [],
      commands: [], added: [] };
    layOut();
    note(words.slice(0, -1).concat("case"), "ecs-emulator");
    bench.commands.push("cd case", "cp model.toml mine.toml");
    fill("about", element("h2", { tabindex: "-1", id: "case" }, `Case ${seed}`),
      element("p", {}, said.text.trim().replace(/^[^:]*: /, "")));
    await showGuess();
    await showAll();
    focusOn(byId("case"));
    byId("seed").value = String(Number(seed) + 1);
  });
}

// --- files of one's own

let lastFiles = [];

/** "--a 'b c'" as words, quotes as in a shell. */
const wordsIn = (line) =>
  [...line.matchAll(/(?:"([^"]*)"|'([^']*)'|[^\s"']+)+/g)].map(([word]) => word.replace(/"([^"]*)"|'([^']*)'/g, "$1$2"));

function importWords() {
  const words = wordsIn(byId("more").value);
  if (byId("axis").value) words.push("--axis", byId("axis").value);
  if (byId("sense").value) words.push("--sense", byId("sense").value);
  return words;
}

/** Without the line that speaks of an option of the command. */
const withoutHints = (text) => text.split("\n").filter((line) => !line.startsWith("nothing written")).join("\n").trim();

/** A free name for a new model. */
function newModelName(names) {
  let name = "model.toml";
  for (let k = 2; names.includes(name); ++k) name = `model_${k}.toml`;
  return name;
}

/** @param files  name and bytes of each */
function analyse(files) {
  lastFiles = files;
  return during("The files are being read.", async () => {
    bench = null;
    byId("work").hidden = true;
    await ask({ action: "clear" });
    const names = files.map(({ name }) => name);
    for (const { name, bytes } of files) await write(name, bytes);
    const { files: looks } = (await run("look", ...names)).answer;
    const of = (...kinds) => looks.filter((one) => kinds.includes(one.kind)).map((one) => one.file);
    const given = { machine: of("machine")[0], model: of("model")[0] };
    const others = ["machine", "model", "error map", "parameters", "recipe", "measurement plan"];
    const data = looks.filter((one) => !others.includes(one.kind)).map((one) => one.file);
    const words = importWords();
    if (!data.length) await run("ecs", "laser", "import", ...names);  // it says what they are
    if (!data.length) throw new Refusal("No measurement is among the files. Choose a file of readings as well.");
    const paths = of("circular test", "diagonal test");
    const lines = data.filter((name) => !paths.includes(name));
    const imported = lines.length ? await run("ecs", "laser", "import", ...lines, ...words) : null;
    bench = { game: false, model: given.model || newModelName(names), machine: given.machine || null, data, lines,
      importWords: words, commands: [], added: [] };
    layOut();
    if (!given.model) await verb("model", "new", ...dataWords());
    fill("about", element("h2", { tabindex: "-1", id: "case" }, data.join(", ")),
      imported ? element("pre", { tabindex: "0", "aria-label": "What was read" }, withoutHints(imported.text)) : null,
      imported && imported.messages ? element("p", { class: "soft" }, typeset(unwrapped(imported.messages))) : null);
    say("The diagnosis is being computed.");
    await showAll();
    focusOn(byId("case"));
  });
}

async function analyseChosen(list) {
  const files = [];
  for (const file of list)
    files.push({ name: file.name.replace(/[/\\\n]/g, "_"), bytes: new Uint8Array(await file.arrayBuffer()) });
  if (files.length) await analyse(files);
}

function listen() {
  byId("game").addEventListener("submit", play);
  byId("own").addEventListener("submit", (event) => event.preventDefault());
  byId("files").addEventListener("change", (event) => analyseChosen(event.target.files));
  byId("again").addEventListener("click", () => analyse(lastFiles));
  const drop = byId("drop");
  for (const kind of ["dragenter", "dragover"])
    document.addEventListener(kind, (event) => { event.preventDefault(); drop.classList.add("over"); });
  document.addEventListener("dragleave", (event) => { if (!event.relatedTarget) drop.classList.remove("over"); });
  document.addEventListener("drop", (event) => {
    event.preventDefault();
    drop.classList.remove("over");
    analyseChosen(event.dataTransfer.files);
  });
}

listen();
begin().then(() => { say("Ready."); setBusy(false); }, (error) => { say(""); complain(error.message); });
