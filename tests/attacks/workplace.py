"""One emulator with its files in a folder of its own, and maps whose images in a unit are known byte by byte."""
import collections
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import time
import tty

from modbus_host import BANK, DONE, INTEGRATE, Host, NoAnswer, number

CODE = "271828"
MACHINE = pathlib.Path("samples/mill/machine.toml").resolve()
TRIES = 6


class Place:
    """An emulator with a unit, and `ecs` with a state of its own."""

    def __init__(self, options, folder, serial="MCM-0107", tcp=True, battery=False, modules=5, mode="integrate",
                 real_time=False):
        self.options, self.dir, self.tcp, self.serial, self.modules = options, folder, tcp, serial, modules
        self.battery, self.mode, self.real_time = battery, mode, real_time
        self.process, self.judged_as = None, (None, None)
        folder.mkdir(parents=True, exist_ok=True)
        self.start()

    def start(self):
        (self.dir / "line").unlink(missing_ok=True)  # left by a killed emulator; its terminal may be another's by now
        words = ["serve", "--machine", str(MACHINE), "--mode", self.mode, "--workshop", str(self.dir / "shop"),
                 "--serial-number", self.serial, "--arm-code", CODE, "--modules", str(self.modules), "--with-parent"]
        words += ["--tcp", "0"] if self.tcp else ["--pty", str(self.dir / "line")]
        words += ["--memory", str(self.dir / "battery")] if self.battery else []
        words += ["--real-time"] if self.real_time else []
        with open(self.dir / "emulator.err", "ab") as errors:
            self.process = subprocess.Popen([self.options.emulator] + words, stdout=subprocess.PIPE, stderr=errors)
        said = self.process.stdout.readline()
        if not said:
            raise RuntimeError("the emulator does not start: %s" % (self.dir / "emulator.err").read_text()[-300:])
        self.ready = json.loads(said)
        self.port = int(self.ready["tcp"].split(":")[1]) if self.tcp else None

    def end(self, kill=False):
        if self.process is None:
            return
        self.process.kill() if kill else self.process.terminate()
        self.process.wait()
        self.process.stdout.close()
        self.process = None

    def restart(self):
        """As after a kill -9."""
        self.end(kill=True)
        self.start()

    def descriptor(self):
        """The unit's end of the serial line."""
        fd = os.open(os.path.realpath(self.dir / "line"), os.O_RDWR | os.O_NOCTTY)
        tty.setraw(fd)
        return fd

    def host(self, **more):
        return Host(port=self.port, **more) if self.tcp else Host(fd=self.descriptor(), **more)

    def link(self):
        return "tcp:127.0.0.1:%d" % self.port if self.tcp else "rtu:%s:921600" % (self.dir / "line")

    def environment(self):
        return dict(os.environ, ECS_STATE_DIR=str(self.dir / "state"), ECS_ARM_CODE=CODE, NO_COLOR="1")

    def ecs(self, *words, link=None, port=None, **more):
        """`ecs` under way."""
        link = link or ("tcp:127.0.0.1:%d" % port if port else self.link())
        more = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT, "text": True, **more}
        return subprocess.Popen([self.options.ecs] + list(words) + ["--link", link], env=self.environment(),
                                stdin=subprocess.DEVNULL, **more)

    def run(self, *words, **more):
        """(exit code, what it said) of `ecs`."""
        process = self.ecs(*words, **more)
        said = process.communicate(timeout=120)[0]
        return process.returncode, said

    def workshop(self, *words):
        done = subprocess.run([self.options.emulator, "workshop", str(self.dir / "shop")] + list(words),
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=120)
        return done.returncode, done.stdout

    def state(self):
        return json.loads(self.workshop("state")[1])

    def sends(self, name):
        """A clean upload by `ecs`: the image that the unit then holds."""
        code, said = self.run(*self.options.maps.send(name))
        if code:
            raise RuntimeError("clean upload of %s: %s" % (name, said))
        with self.host() as host:
            return host.active()[1]

    def judge(self):
        """A host of the test's own, armed, on the clean line, in integration mode; it asks again where a fault is still
        under way."""
        for attempt in range(TRIES):
            key, secret = self.judged_as
            host = self.host(key=key, secret=secret, tries=TRIES)
            try:
                host.drain(0.02)
                if host.look().armed < 60:
                    time.sleep(host.wait)  # after a wrong code of another host
                    if host.arm(CODE)[0] != DONE:
                        raise RuntimeError("the judge is not armed")
                self.judged_as = host.key, host.secret
                if host.status()[1] != 1:
                    host.command(INTEGRATE)
                return host
            except (NoAnswer, OSError, RuntimeError):
                host.close()
                if attempt == TRIES - 1:
                    raise
                time.sleep(0.2)

    def held(self):
        """The image that the unit holds as active."""
        with self.judge() as host:
            return host.active()[1]

    def holds(self, image):
        """Makes the image active, unless it is."""
        with self.judge() as host:
            if host.active()[1] != image:
                host.upload(image)


MapForm = collections.namedtuple("MapForm", "points value")


def rough(gain):
    return lambda k: gain * (k * 7919 % 101 / 3 - 15)


def smooth(gain):
    return lambda k: gain * 30 * math.sin(k / 70) * math.exp(-k / 3000)


class Maps:
    """Maps of the sample mill, the parameters for them, and the image of each in the unit of serial number MCM-0107."""

    def __init__(self, options, forms):
        self.dir, self.names, self.images = options.work / "maps", list(forms), {}
        self.dir.mkdir(parents=True)
        self.parameters = str(self.dir / "p.toml")
        environment = dict(os.environ, ECS_STATE_DIR=str(self.dir / "state"))
        first = str(self.dir / "p0.toml")
        for words in (["params", "new", "--machine", str(MACHINE), "-o", first],
                      ["params", "set", first, "compensation.scope", "linear", "-o", self.parameters]):
            subprocess.run([options.ecs] + words, env=environment, check=True, stdout=subprocess.DEVNULL)
        for name, form in forms.items():
            self.path(name).write_text("\n".join(self.lines(form)) + "\n")
        options.maps = self
        place = Place(options, options.work / "first")
        try:
            self.images = {name: place.sends(name) for name in forms}
        finally:
            place.end()

    @staticmethod
    def lines(form):
        yield from ("# machine: moving column mill", "# configuration: TXYZ", "axis,sense,approach,p_mm,value_um")
        for axis, sense, low in (("X", "EX", -4100), ("Y", "EY", -1400), ("Z", "EZ", -1000)):
            count = form.points if axis == "X" else 4
            for approach in (1, -1):
                for k in range(count):
                    yield "%s,%s,%d,%.4f,%g" % (axis, sense, approach, low - low * k / (count - 1),
                                                round(form.value(k) + approach, 2))

    def path(self, name):
        return self.dir / (name + ".csv")

    def send(self, name):
        return ["map", "send", str(self.path(name)), "--params", self.parameters]

    def name_of(self, image):
        if image is None:
            return "none"
        for name, known in self.images.items():
            if known == image:
                return name
        return "MIXTURE"


# What the words of `ecs` say about the map that is active.
SAYS_NEW = re.compile(r'"verified":true|it is active \(commit')
SAYS_OLD = re.compile(r"the old map is active \(commit|the unit contains no map, as before")
SAYS_DOUBT = re.compile(r"it is not known which map is active|the active map has changed|another map is now active|"
                        r"the active map in the unit differs|unless another host has sent one")


DOUBLED = re.compile(r"\b([a-z]{2,})[ ,;:]+\1\b")


def judged(code, said, before, sent, now, begun=True):
    """The verdict on an upload: exit code and words of `ecs` against the names of the maps in the unit.

    @param begun  the unit was asked to begin staging: from then on every failure names the map that is active
    """
    if now in ("MIXTURE", "none"):
        return "WRONG %s active, exit %s" % (now, code)
    if now not in (before, sent):
        return "WRONG another map active"
    if code == "hang":
        return "hang, %s active" % ("old" if now == before else "new")
    if code == -signal.SIGINT and not begun and not said:
        return "kept, not begun"  # before the program had begun to listen for signals
    if code < 0:
        return "crash, exit %d" % code
    if DOUBLED.search(said):
        return "WRONG a word twice: %s" % DOUBLED.search(said).group(0)
    if code != 0 and '"verified":true' in said:
        return "WRONG exit %d with success" % code
    if code == 0:
        return "right" if now == sent else "WRONG success told, old active"
    if now == sent != before:
        if SAYS_OLD.search(said):
            return "WRONG words say old, new active"
        return "new, told" if SAYS_NEW.search(said) or SAYS_DOUBT.search(said) else "WRONG new active, unsaid"
    if SAYS_NEW.search(said):
        return "WRONG words say new, old active"
    if SAYS_OLD.search(said):
        return "kept"
    if SAYS_DOUBT.search(said):
        return "kept, in doubt"
    return "WRONG kept, map unnamed" if begun else "kept, not begun"


def is_wrong(verdict):
    return verdict.startswith(("WRONG", "hang", "crash", "failed"))
