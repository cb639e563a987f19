"""Runs of `attacks` that need no unit: logbooks and links that another program has prepared, in the folder of the user."""
import hashlib
import os
import shutil
import signal
import sqlite3
import subprocess
import time
import zlib

ENDS_S = 20.0  # a verb on a prepared logbook, on a busy computer
STOPS_S = 5.0  # after Ctrl-C
PARAMETERS = """[identity]
machine = "short lathe"
serial_number = ""
[configuration]
chain = "TX"
axes = "X"
[compensation]
scope = "linear"
[axis.X]
transducer = "encoder"
# end of parameters
"""
READINGS = "# machine: short lathe\naxis,sense,x_mm,reading,approach\n" + "".join(
    "X,EX,%d,%d,%d\n" % (x, x // 10 + a, a) for a in (1, -1) for x in (-200, -100, 0))
COLUMNS = ("number", "time", "kind", "machine", "serial_number", "operator", "instrument", "summary", "content", "previous")
ENDLESS_VIEW = """PRAGMA writable_schema=ON; ALTER TABLE entry RENAME TO entries;
CREATE VIEW entry AS WITH RECURSIVE c(n) AS (SELECT 1 UNION ALL SELECT n + 1 FROM c) SELECT n AS number, '' AS time, '' AS kind,
'' AS machine, '' AS serial_number, '' AS operator, '' AS instrument, '' AS summary, '' AS content, '' AS previous, '' AS hash
FROM c WHERE n < 0;"""
TRIGGER = "CREATE TRIGGER empties AFTER INSERT ON entry BEGIN DELETE FROM entry; END;"
BRACKETS = 40_000_000
LONG_CHECK = 400  # files of 32 MiB in a logbook of 13 MB: minutes of unpacking


def hash_of(row):
    """Of an entry (modules/logbook/README.md): every field behind its length."""
    fields = ["ecs-logbook-1"] + [str(field) for field in row]
    return hashlib.sha256(b"".join(b"%d:%s" % (len(f.encode()), f.encode()) for f in fields)).hexdigest()


class Desk:
    """A folder with a genuine logbook of two entries, and `ecs` in it."""

    def __init__(self, options, name):
        self.options, self.dir = options, options.work / name
        shutil.rmtree(self.dir, ignore_errors=True)
        self.dir.mkdir(parents=True)
        (self.dir / "p.toml").write_text(PARAMETERS)
        (self.dir / "exx.csv").write_text(READINGS)
        self.ecs("map", "build", "exx.csv", "--params", "p.toml", "-o", "map.csv")
        self.ecs("params", "set", "p.toml", "axis.X.deadband_um=3", "-o", "first.toml")
        self.book = next((self.dir / "books").glob("*.ecslog"))

    def started(self, *words):
        environment = dict(os.environ, ECS_STATE_DIR=str(self.dir / "state"), ECS_LOGBOOK="books", NO_COLOR="1")
        return subprocess.Popen([self.options.ecs] + list(words), cwd=self.dir, env=environment, text=True,
                                stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def ecs(self, *words):
        """(exit code, seconds, what it said); exit code `hang` where it did not end."""
        begun, process = time.monotonic(), self.started(*words)
        try:
            said = process.communicate(timeout=ENDS_S)[0]
        except subprocess.TimeoutExpired:
            process.kill()
            return "hang", ENDS_S, process.communicate()[0]
        return process.returncode, time.monotonic() - begun, said

    def stopped(self, *words, after=1.0):
        """The same, with Ctrl-C after a while; seconds from there."""
        process = self.started(*words)
        time.sleep(after)
        running, begun = process.poll() is None, time.monotonic()
        process.send_signal(signal.SIGINT)
        try:
            said = process.communicate(timeout=ENDS_S)[0]
        except subprocess.TimeoutExpired:
            process.kill()
            return "hang", ENDS_S, process.communicate()[0]
        return (process.returncode if running else "ended before"), time.monotonic() - begun, said

    def change(self, sql):
        file = sqlite3.connect(self.book)
        file.executescript(sql)
        file.close()

    def entries(self, table="entry"):
        file = sqlite3.connect("file:%s?mode=ro" % self.book, uri=True)
        try:
            return file.execute("SELECT count(*) FROM " + table).fetchone()[0]
        finally:
            file.close()


def refused_by(desk, table):
    """Each verb on a logbook that another program has changed: it ends, says so, and nothing is lost."""
    before = desk.entries(table)
    for words in (("log", "list"), ("log", "verify"), ("log", "show", "1")):
        code, spent, said = desk.ecs(*words)
        yield "%s: exit %s in %.1f s: %s" % (" ".join(words), code, spent, said[-200:]), \
            code not in (0, "hang") and "changed by another program" in said
    code, spent, said = desk.ecs("params", "set", "p.toml", "axis.X.deadband_um=4", "-o", "second.toml", "--force")
    yield "params set: exit %s in %.1f s: %s" % (code, spent, said[-200:]), \
        code == 0 and "changed by another program" in said and (desk.dir / "second.toml").exists()
    yield "entries of before: %d, now %d" % (before, desk.entries(table)), before == desk.entries(table) > 0


def logbooks(options):
    """A logbook with a trigger, with a view that never ends, with 40 MB of brackets, with minutes of unpacking."""
    for k in range(options.n):
        desk = Desk(options, "trigger")
        desk.change(TRIGGER)
        for what, right in refused_by(desk, "entry"):
            yield "trigger, " + what, right
        desk = Desk(options, "view")
        desk.change(ENDLESS_VIEW)
        for what, right in refused_by(desk, "entries"):
            yield "view, " + what, right
        desk = Desk(options, "brackets")
        yield from brackets(desk)
        desk = Desk(options, "long")
        packed = zlib.compress(b"x" * (32 << 20))
        file = sqlite3.connect(desk.book)
        file.executemany("INSERT INTO original VALUES(?, ?, ?)", (("%064d" % i, 32 << 20, packed) for i in range(LONG_CHECK)))
        file.commit()
        file.close()
        code, spent, said = desk.stopped("log", "verify", after=0.7 + 0.1 * (k % 5))
        yield "Ctrl-C in a long check: exit %s after %.2f s: %s" % (code, spent, said[-200:]), \
            code not in (0, "hang", "ended before") and spent < STOPS_S


def brackets(desk):
    """The content of the last entry, hashed as it must be."""
    file = sqlite3.connect(desk.book)
    row = list(file.execute("SELECT %s FROM entry ORDER BY number DESC LIMIT 1" % ", ".join(COLUMNS)).fetchone())
    row[COLUMNS.index("content")] = "[" * BRACKETS
    file.execute("UPDATE entry SET content = ?, hash = ? WHERE number = ?",
                 (row[COLUMNS.index("content")], hash_of(row), row[0]))
    file.commit()
    file.close()
    for words in (("log", "list"), ("log", "verify"), ("log", "show", str(row[0])),
                  ("params", "set", "p.toml", "axis.X.deadband_um=4", "-o", "second.toml", "--force")):
        code, spent, said = desk.ecs(*words)
        yield "brackets, %s: exit %s in %.1f s: %s" % (" ".join(words[:2]), code, spent, said[-200:]), \
            isinstance(code, int) and code >= 0 and spent < ENDS_S
    code, spent, said = desk.stopped("log", "show", str(row[0]), after=0.1)
    yield "Ctrl-C beside brackets: exit %s after %.2f s: %s" % (code, spent, said[-200:]), code != "hang" and spent < STOPS_S


MACHINE_FILE = 'name = "test mill"\nconfiguration = "TXYZ"\n' + "".join(
    "[axis.%s]\ntravel_mm = [0.0, 1000.0]\n" % axis for axis in "XYZ")
MODEL = '[[effect]]\nid = "offset"\naxis = "X"\nsense = "EX"\n[[effect]]\nid = "scale"\naxis = "X"\nsense = "EX"\n'


def links(options):
    """A link in the place of the file `.work` that `fleet diagnose` makes beside its results, to a file of the user."""
    desk = Desk(options, "fleet")
    (desk.dir / "machine.toml").write_text(MACHINE_FILE)
    (desk.dir / "model.toml").write_text(MODEL)
    (desk.dir / "0.csv").write_text("axis,sense,x_mm,reading,approach\n" + "".join(
        "X,EX,%d,%.1f,1\n" % (x, x / 100 + (x * 7919 % 13) / 10) for x in range(0, 1000, 50)))
    (desk.dir / "fleet.csv").write_text("id,model,data,machine\nm0,model.toml,0.csv,machine.toml\n")
    work, precious = desk.dir / "results.jsonl.work", desk.dir / "precious"
    folder = desk.dir / "folder"
    folder.mkdir()

    def to_file():
        work.symlink_to("precious")

    def to_another_link():
        (desk.dir / "between").symlink_to(precious)
        work.symlink_to("between")

    def to_nothing():
        work.symlink_to("folder/new")

    def to_folder():
        work.symlink_to("folder")

    def same_file():
        os.link(precious, work)

    for k in range(options.n):
        for made in (to_file, to_another_link, to_nothing, to_folder, same_file):
            for path in (work, desk.dir / "between", desk.dir / "results.jsonl"):
                path.unlink(missing_ok=True)
            precious.write_text("keep me %d\n" % k)
            made()
            code, spent, said = desk.ecs("fleet", "diagnose", "fleet.csv", "-o", "results.jsonl", "--blanks", "50")
            kept = precious.read_text() == "keep me %d\n" % k and not list(folder.iterdir())
            yield "%s: exit %s: %s" % (made.__name__.replace("_", " "), code, said[-200:]), code not in (0, "hang") and kept
    work.unlink()
    code, _, said = desk.ecs("fleet", "diagnose", "fleet.csv", "-o", "results.jsonl", "--blanks", "50")
    yield "without a link: exit %s: %s" % (code, said[-200:]), code == 0 and (desk.dir / "results.jsonl").stat().st_size > 0
