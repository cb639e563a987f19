"""Runs of `line_faults` about hosts: paused, moved to another unit, two at a time, misled by late or false replies."""
import re
import signal
import struct
import time

import modbus_host as modbus
from faulty_line import OTHER, UNIT, Delivery, DrawnFaults, Ending, Faults, through_line
from upload_runs import FRAMES, UploadRun
from workplace import SAYS_DOUBT, SAYS_NEW, Place, judged

IDENTITY_READ = 4  # this many frames have passed when the host knows the unit's serial number
CONTROL_CHARACTERS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")


class AtBegin(Faults):
    """Passes everything; tells when this many frames have passed since begin staging."""

    def __init__(self, frames):
        self.left, self.reached = frames, False

    def deliveries(self, line, sender, frame):
        if line.commands[modbus.BEGIN]:
            self.left -= 1
            self.reached = self.reached or self.left < 0
        return super().deliveries(line, sender, frame)


class Stalled(UploadRun):
    """A host is stopped after begin staging (Ctrl-Z, a laptop that sleeps), another one sends its map, the first goes on."""

    def trial(self, rng):
        before, sent = self.drawn(rng)
        between = rng.choice([name for name in self.maps.names if name not in (before, sent)])
        self.prepare(before, sent, rng.choice(("zeros", "other", "part")))
        faults, other = AtBegin(rng.randrange(1, 8)), None

        def step(line, process, spent):
            nonlocal other
            if faults.reached and other is None and process.poll() is None:
                process.send_signal(signal.SIGSTOP)
                time.sleep(0.02)
                other = self.place.run(*self.maps.send(between))[0]
                process.send_signal(signal.SIGCONT)

        ending = self.send(sent, faults, on_step=step)
        now = self.maps.name_of(self.place.held())
        if other is None:
            yield "ended before", judged(ending.code, ending.said, before, sent, now), ending, {}
            return
        if other == 0 and now == between and ending.code != 0:
            told = SAYS_DOUBT.search(ending.said) or "this transfer changed nothing" in ending.said
            verdict = "right: refused, told" if told and not SAYS_NEW.search(ending.said) else "WRONG refused, unsaid"
        elif other == 0 and now == sent and ending.code == 0:
            verdict = "right: came last"  # it began again after the other one
        else:
            verdict = "WRONG other exit %s, stopped one exit %s, %s active" % (other, ending.code, now)
        yield "stopped", verdict, ending, {}


class Swapped(UploadRun):
    """The cable is moved to another unit of the same kind, with a map of its own in either bank, during an upload."""

    def __init__(self, options, folder):
        super().__init__(options, folder)
        self.other = Place(options, folder / "other", serial="MCM-0108", tcp=options.tcp, modules=1)
        self.other_images = {name: self.other.sends(name) for name in ("small4", "small3")}

    def end(self):
        super().end()
        self.other.end()

    def trial(self, rng):
        before, sent = self.drawn(rng)
        self.prepare(before, sent, "zeros")
        theirs = rng.choice(list(self.other_images))
        self.other.holds(self.other_images[theirs])
        if rng.random() < 0.5:  # the same map, in the other bank
            host = self.other.judge()
            host.upload(self.other_images[theirs])
            host.close()
        at, moved = rng.randrange(IDENTITY_READ, FRAMES[sent.rstrip("0123456789")]), False

        def step(line, process, spent):
            nonlocal moved
            if not moved and line.frames >= at:
                moved = True
                line.lead_to(self.other.descriptor())

        ending = self.send(sent, Faults(), on_step=step)
        now, held = self.maps.name_of(self.place.held()), self.other.held()
        verdict = judged(ending.code, ending.said, before, sent, now, False)
        if held != self.other_images[theirs]:
            verdict = "WRONG the other unit's map has changed, exit %s" % ending.code
        elif verdict == "kept, not begun" or verdict == "kept":
            verdict = "both keep theirs"
        yield "moved" if moved else "ended before", verdict, ending, {}


class TwoHosts(UploadRun):
    """Two hosts send different maps over TCP at the same time."""

    def trial(self, rng):
        before = rng.choice(self.maps.names)
        one, two = rng.sample([name for name in self.maps.names if name != before and name[:5] != "small"], 2)
        self.prepare(before, one, "zeros")
        begun, hosts = time.monotonic(), []
        for name in (one, two):
            hosts.append(self.place.ecs(*self.maps.send(name)))
            time.sleep(rng.uniform(0.0, 0.06))
        ends = [(host.communicate(timeout=self.options.limit)[0], host.returncode) for host in hosts]
        now = self.maps.name_of(self.place.held())
        succeeded = [name for name, end in zip((one, two), ends) if end[1] == 0]
        if now in ("MIXTURE", "none"):
            verdict = "WRONG %s active, success told by %d" % (now, len(succeeded))
        elif now in succeeded or (now == before and not succeeded):
            verdict = "right: success told by %d" % len(succeeded)
        elif now in (one, two):
            said = ends[(one, two).index(now)][0]
            verdict = "new, told" if SAYS_NEW.search(said) or SAYS_DOUBT.search(said) else "WRONG new active, unsaid"
        else:
            verdict = "WRONG success told, old active"
        said = "\n".join("exit %d: %s" % (code, text) for text, code in ends)
        yield "two hosts", verdict, Ending(0, said, "", time.monotonic() - begun, None), {}


VARYING = re.compile(r'"events":\[.*?\](?=[,}])|"(time_s|ticks|uptime_s|unit_time_us|unit_time_s|sample_number|number|time|taken|t|loop_overruns|'
                     r'pointers_at_tick|link|at|up_s|seconds)":\s*("[^"]*"|[-0-9.e+]+|null),?')


class Late(UploadRun):
    """Replies come late, twice, or not at all while verbs read: what is printed must be what the unit holds."""

    kinds = ("delay", "late_repeat", "repeat", "swallow", "merge", "second_master", "replay")

    def __init__(self, options, folder):
        super().__init__(options, folder)
        self.place.workshop("jog", "--X", "-123.4", "--Y", "-700", "--Z", "-50")
        self.prepare("small2", "small1", "zeros")
        for axis, value in (("X", "-111.5"), ("Y", "-222.25"), ("Z", "-33.125")):
            code, said = self.place.run("utility", "position", axis, value)
            if code:
                raise RuntimeError(said)
        first = "0x%06X" % modbus.BANK[self.active_bank()]
        self.verbs = (["memory", "read", first, "912", "--hex"], ["memory", "read", "0x400", "480", "--hex"],
                      ["params", "show", "--unit", "--json"], ["map", "receive", "--json"],
                      ["map", "verify", str(self.maps.path("small2")), "--params", self.maps.parameters, "--json"],
                      ["utility", "status", "--json"], ["monitor", "--count", "4", "--interval", "50", "--json"])
        self.clean = [VARYING.sub("", self.place.run(*verb)[1]) for verb in self.verbs]

    def active_bank(self):
        with self.place.judge() as host:
            return host.active()[0]

    def trial(self, rng):
        which = rng.randrange(len(self.verbs))
        kinds = [kind for kind in rng.sample(self.kinds, rng.randint(1, 3)) if not (self.place.tcp and kind == "replay")]
        faults = DrawnFaults(rng, self.place.tcp, 40, self.master(False), kinds or ["delay"], "mixture",
                             rng.choice((0.03, 0.1, 0.25)))
        ending = through_line(self.place, self.verbs[which], faults, self.options.limit)
        out, name = VARYING.sub("", ending.out), " ".join(self.verbs[which][:2])
        times = [float(t) for t in re.findall(r'"time_s":([0-9.]+)', ending.out)] if name.startswith("monitor") else []
        if ending.code == "hang":
            verdict = "hang"
        elif ending.code < 0:
            verdict = "crash, exit %d" % ending.code
        elif times != sorted(set(times)):
            verdict = "WRONG an old sample printed"
        elif ending.code == 0:
            verdict = "right" if out == self.clean[which] else "WRONG data printed"
        else:
            verdict = "failure told" if ending.said.strip() else "WRONG silent failure"
        yield name, verdict, ending, faults.counts


class Lies(Faults):
    """Changes words of replies, but not the echo."""

    words = (0, 1, 0xFFFF, 0x7FFF, 0x8000, 0x7FF0, 0x7FF8, 0x1B5B, 0x9B33, 0x0A0D)

    def __init__(self, rng):
        self.rng, self.likelihood, self.counts = rng, rng.choice((0.05, 0.2, 0.5, 1.0)), {"lie": 0}

    def deliveries(self, line, sender, frame):
        rng = self.rng
        if sender == UNIT and len(frame) > 13 and frame[7] == 23 and rng.random() < self.likelihood:
            data = bytearray(frame)
            for _ in range(rng.choice((1, 1, 2, 8, 60))):
                at = 11 + 2 * rng.randrange((len(data) - 11) // 2)
                data[at:at + 2] = struct.pack(">H", rng.choice(self.words + (rng.getrandbits(16),)))
            frame = bytes(data)
            self.counts["lie"] += 1
        return [Delivery(frame, OTHER[sender], 0.0)]


class Liar(UploadRun):
    """A unit that answers well-formed nonsense: no crash, no endless wait, no control characters let through."""

    def trial(self, rng):
        self.prepare("small2", "small1", "zeros")
        got = str(self.place.dir / "got")
        verbs = (["utility", "status"], ["utility", "status", "--json"], ["monitor", "--count", "3", "--interval", "50"],
                 ["map", "receive", "-o", got + ".csv", "--force"], ["map", "show", "--unit"],
                 ["map", "verify", str(self.maps.path("small2"))], ["params", "show", "--unit"],
                 ["params", "receive", "-o", got + ".toml", "--force"],
                 ["memory", "dump", "-o", got + ".dump", "--force"],
                 ["memory", "show", "--unit"], ["memory", "read", "0x100000", "64"], ["doctor"],
                 self.maps.send("small1"), ["params", "send", self.maps.parameters],
                 ["utility", "run", "0x041000", "--yes"], ["utility", "ramtest"], ["utility", "clear"],
                 ["utility", "mode", "integrate"], ["utility", "datum", "show", got + ".csv"], ["unit", "events"],
                 ["unit", "arm", "--minutes", "5"])
        verb = list(rng.choice(verbs))
        faults = Lies(rng)
        ending = through_line(self.place, verb, faults, self.options.limit)
        if ending.code == "hang":
            verdict = "hang"
        elif ending.code < 0 or ending.code > 5:
            verdict = "crash, exit %d" % ending.code
        elif CONTROL_CHARACTERS.search(ending.said.replace("\n", "").replace("\t", "")):
            verdict = "WRONG control characters let through"
        elif verb[:2] == ["map", "send"] and ending.code == 0 and self.maps.name_of(self.place.held()) != "small1":
            verdict = "WRONG success told, old active"
        else:
            verdict = "exit %d" % ending.code
        yield " ".join(verb[:2]), verdict, ending, faults.counts
