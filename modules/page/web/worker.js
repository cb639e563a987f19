// The worker: the program and its files in memory. It answers one message after the other.
let program = null;
const folder = "/case";

function removeAll(path) {
  for (const name of program.FS.readdir(path)) {
    if (name === "." || name === "..") continue;
    const one = path + "/" + name;
    if (program.FS.isDir(program.FS.stat(one).mode)) {
      removeAll(one);
      program.FS.rmdir(one);
    } else {
      program.FS.unlink(one);
    }
  }
}

const actions = {
  async begin({ wasm }) {
    program = await ecs_program({ wasmBinary: wasm, print: () => {}, printErr: () => {} });
    program.FS.ignorePermissions = true;  // its umask would forbid everything
    // Its rename leaves a file that it replaces in the table of names.
    const { rename } = program.FS;
    program.FS.rename = (from, to) => {
      if (program.FS.analyzePath(to).exists) program.FS.unlink(to);
      rename(from, to);
    };
    program.FS.mkdir(folder);
    program.FS.chdir(folder);
  },
  clear() {
    removeAll(folder);
  },
  write({ path, bytes }) {
    const folders = path.split("/").slice(0, -1);
    folders.forEach((_, i) => {
      const one = folders.slice(0, i + 1).join("/");
      if (!program.FS.analyzePath(one).exists) program.FS.mkdir(one);
    });
    program.FS.writeFile(path, bytes);
  },
  has({ path }) {
    return program.FS.analyzePath(path).exists;
  },
  read({ path }) {
    return program.FS.readFile(path);
  },
  run({ words }) {
    return JSON.parse(program.ccall("ecs_answer", "string", ["string"], [words.join("\n")]));
  },
};

self.onmessage = async ({ data }) => {
  try {
    self.postMessage({ number: data.number, value: await actions[data.action](data) });
  } catch (error) {
    self.postMessage({ number: data.number, failed: String(error && error.message ? error.message : error) });
  }
};
