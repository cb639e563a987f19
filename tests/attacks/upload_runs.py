"""Runs of `line_faults` in which a map is sent while something fails: the line, the unit, its supply, the host."""
import json
import signal
import time

import modbus_host as modbus
from faulty_line import HOST, OTHER, UNIT, Delivery, DrawnFaults, Faults, SecondMaster, interrupt, through_line
from workplace import CODE, Place, is_wrong, judged

FRAMES = {"small": 44, "smooth": 54, "rough": 66}  # about this many pass in a clean upload
SECONDS = {"small": 0.1, "smooth": 0.2, "rough": 0.5}
FRAMES_AFTER = 8  # of the commit's request, it included, and one more
SILENCE_S = 0.06  # an unanswered request: the unit has no supply
COMPENSATING = (2, 3)


class UploadRun:
    """A unit that holds one map while another one is sent. Every trial begins with the state that its number draws."""

    battery = False

    def __init__(self, options, folder):
        self.options = options
        self.place = Place(options, folder, tcp=options.tcp, battery=self.battery, modules=1)
        self.maps = options.maps
        self.masters = {}

    def end(self):
        self.place.end()

    def family(self, rng):
        return self.options.map or rng.choices(("small", "smooth", "rough"), (70, 15, 15))[0]

    def drawn(self, rng):
        """(active before, to be sent): never the same, and the other bank never holds the one to be sent whole."""
        family = self.family(rng)
        sent = rng.choice([name for name in self.maps.names if name.startswith(family)])
        before = rng.choice([name for name in self.maps.names if name != sent])
        return before, sent

    def prepare(self, before, sent, beside):
        """@param beside  what the bank that is not active holds: zeros, another map, or a part of the one to be sent"""
        images = self.maps.images
        with self.place.judge() as host:
            if host.active()[1] != images[before]:
                host.upload(images[before])
            part = images[sent][:480 * (len(images[sent]) // 960)]
            other = next(images[name] for name in self.maps.names if name not in (before, sent))
            token = host.stage({"zeros": b"", "part": part, "other": other}[beside])
            host.command(modbus.ABANDON, modbus.long(token))

    def master(self, armed):
        """A second host on the line, with a session of its own, before the trial begins."""
        key, secret = self.masters.get(armed, (None, None))
        host = self.place.host(key=key, secret=secret, tries=6)
        if host.look().armed < 60 and armed:
            host.arm(CODE)
            host.look()
        self.masters[armed] = host.key, host.secret
        host.close()
        return SecondMaster(host)

    def send(self, sent, faults, **more):
        return through_line(self.place, self.maps.send(sent) + ["--json"], faults, self.options.limit,
                            self.options.pace, **more)

    def verdict(self, ending, before, sent):
        with self.place.judge() as host:
            now = self.maps.name_of(host.active()[1])
            if any(host.relays()):
                return "WRONG a relay is closed"
        return judged(ending.code, ending.said, before, sent, now, ending.line.commands[modbus.BEGIN] > 0)


class Upload(UploadRun):
    """Faulted uploads; some go on after a transfer that was cut."""

    def trial(self, rng):
        before, sent = self.drawn(rng)
        self.prepare(before, sent, rng.choice(("zeros", "other", "part")))
        armed = rng.random() < 0.5
        master, frames = self.master(armed), FRAMES[sent.rstrip("0123456789")]
        cut = ""
        if rng.random() < 0.15:
            faults = DrawnFaults(rng, self.place.tcp, frames, master, shape="closed")
            ending = self.send(sent, faults)
            verdict = self.verdict(ending, before, sent)
            yield "before a resume: closed", verdict, ending, faults.counts
            if not verdict.startswith("kept"):
                return
            cut = "resumed: "
        faults = DrawnFaults(rng, self.place.tcp, frames, master)
        at = rng.uniform(0.02, 2 * SECONDS[sent.rstrip("0123456789")]) if rng.random() < 0.08 else None

        def step(line, process, spent):
            nonlocal at
            if at is not None and spent > at:
                at = None
                interrupt(process)

        ending = self.send(sent, faults, on_step=step)
        name = faults.label + (", armed" if armed and faults.counts["second_master"] else "")
        verdict = self.verdict(ending, before, sent)
        if verdict == "right" and self.options.number % 50 == 49:
            code, said = self.place.run("map", "verify", *self.maps.send(sent)[2:])
            verdict = verdict if code == 0 else "WRONG verify says otherwise: " + said[-200:]
        yield cut + name, verdict, ending, faults.counts


class Restarts(UploadRun):
    """The emulator is killed and started again in the middle of a faulted upload; some are sent again afterwards."""

    battery = True

    def trial(self, rng):
        before, sent = self.drawn(rng)
        self.prepare(before, sent, rng.choice(("zeros", "other", "part")))
        family = sent.rstrip("0123456789")
        at, done = rng.uniform(0.01, SECONDS[family] + 0.05), False
        kinds = [kind for kind in ("drop", "flip", "repeat", "delay") if not self.place.tcp or kind in ("repeat", "delay")]
        faults = DrawnFaults(rng, self.place.tcp, FRAMES[family], self.master(True), kinds, "mixture", 0.02)

        def step(line, process, spent):
            nonlocal done
            if not done and spent > at:
                done = True
                line.close(UNIT)
                self.place.restart()
                line.lead_to(None if self.place.tcp else self.place.descriptor())
                if self.place.tcp:
                    line.close(HOST)

        ending = self.send(sent, faults, on_step=step)
        verdict = self.verdict(ending, before, sent)
        yield "restart " + family, verdict, ending, faults.counts
        if verdict.startswith("kept") and rng.random() < 0.5:
            ending = self.send(sent, Faults())
            yield "sent again " + family, self.verdict(ending, before, sent), ending, {}


class AtFrame(Faults):
    """Acts once, at a frame: before it passes, or this many seconds after."""

    def __init__(self, frame, after, action):
        self.frame, self.after, self.action = frame, after, action

    def deliveries(self, line, sender, frame):
        if self.action is None or line.frames - 1 < self.frame:
            return super().deliveries(line, sender, frame)
        action, self.action = self.action, None
        if self.after is not None:
            line.write(OTHER[sender], frame)
            time.sleep(self.after)
        action(line)
        return []


class AtByte(Faults):
    """Acts once, within a frame, after this many bytes have passed both ways."""

    def __init__(self, at, action):
        self.at, self.action = at, action

    def deliveries(self, line, sender, frame):
        if self.action is None or line.bytes <= self.at:
            return super().deliveries(line, sender, frame)
        line.write(OTHER[sender], frame[:len(frame) - (line.bytes - self.at)])
        action, self.action = self.action, None
        action(line)
        return []


class EmulatorKilled(UploadRun):
    """kill -9 of the emulator at a frame of an upload (trial / 4), before it or some time after, and a start on the same
    battery; with --every byte at each byte of the line."""

    battery = True
    after = (None, 0.0005, 0.003, 0.02)

    def trial(self, rng):
        before, sent = self.drawn(rng)
        self.prepare(before, sent, "zeros")

        def cut(line):
            line.close(UNIT)
            self.place.restart()
            if self.place.tcp:
                line.close(HOST)
            else:
                line.lead_to(self.place.descriptor())

        number = self.options.number
        if self.options.every == "byte":
            name, faults = "killed at a byte", AtByte(number, cut)
        else:
            frame, phase = divmod(number, len(self.after))
            after = self.after[phase]
            name = "killed %s" % ("before the frame" if after is None else "%g ms after" % (1000 * after))
            faults = AtFrame(frame, after, cut)
        ending = self.send(sent, faults)
        yield name if faults.action is None else "upload over before", self.verdict(ending, before, sent), ending, {}


class SupplyFails(UploadRun):
    """The unit's supply fails after as many bytes written to axis memory as the number of the trial says, and comes
    back as soon as a request is unanswered, or when the host has ended."""

    attempts = 12

    def powered(self):
        return self.place.state()["unit"]["powered"]

    def trial(self, rng):
        """A map that is over before this many bytes, or whose host gave up before, is followed by another one."""
        for attempt in range(self.attempts):
            name, verdict, ending = self.attempt(rng)
            if name != "supply lasted" or is_wrong(verdict) or attempt == self.attempts - 1:
                yield name, verdict, ending, {"map before": attempt} if attempt else {}
                return

    def attempt(self, rng):
        before, sent = self.drawn(rng)
        self.prepare(before, sent, "zeros")
        number = self.options.number
        waits, back, asked = number % 10 == 9, False, None
        self.place.workshop("fault", "power_fails", "--count", str(number))

        def supply_back():
            nonlocal back
            back = True
            self.place.workshop("fault", "clear")
            self.place.workshop("power", "cycle")

        def step(line, process, spent):
            nonlocal asked
            if back or waits or not line.history:
                return
            asked = (line.frames, asked[1] if asked and asked[0] == line.frames else spent)
            if line.history[-1][0] == HOST and spent - asked[1] > SILENCE_S and not self.powered():
                supply_back()

        ending = self.send(sent, Faults(), on_step=step)
        name = "supply lasted" if self.powered() and not back else "back at the end" if not back else "back at once"
        if not back:
            supply_back()
        return name, self.verdict(ending, before, sent), ending


class HostKilled(UploadRun):
    """kill -9 of the host at a moment by chance."""

    def trial(self, rng):
        before, sent = self.drawn(rng)
        self.prepare(before, sent, rng.choice(("zeros", "other", "part")))
        family = sent.rstrip("0123456789")
        at = rng.uniform(0.0, 1.3 * SECONDS[family])

        def step(line, process, spent):
            if spent > at and process.poll() is None:
                process.kill()

        ending = self.send(sent, Faults(), on_step=step)
        if ending.code != -signal.SIGKILL:
            yield "ended before", self.verdict(ending, before, sent), ending, {}
            return
        now = self.maps.name_of(self.place.held())
        verdict = "killed, %s" % now.rstrip("0123456789") if now not in (before, sent) else \
            "killed, %s active" % ("old" if now == before else "new")
        yield "kill " + family, verdict if now in (before, sent) else "WRONG " + now, ending, {}


class AfterCommit(UploadRun):
    """The line dies, is closed, or the host is interrupted at a frame after the commit was asked for (trial / 4 frames
    later): do the words name the map that is active?"""

    ways = ("dead", "closed", "interrupted", "interrupted, dead")

    def trial(self, rng):
        before, sent = self.drawn(rng)
        self.prepare(before, sent, "zeros")
        frames, way = divmod(self.options.number % (len(self.ways) * FRAMES_AFTER), len(self.ways))
        faults = AroundCommit(frames, self.ways[way])

        def step(line, process, spent):
            if faults.wants_interrupt:
                faults.wants_interrupt = False
                interrupt(process)

        ending = self.send(sent, faults, on_step=step)
        name = self.ways[way] if faults.acted else "upload over before"
        yield name, self.verdict(ending, before, sent), ending, {}


class AroundCommit(Faults):
    def __init__(self, frames, way):
        self.left, self.way, self.acted, self.wants_interrupt, self.over = frames, way, False, False, False

    def may_connect(self):
        return not self.acted

    def deliveries(self, line, sender, frame):
        if line.commands[modbus.COMMIT] == 0:
            return super().deliveries(line, sender, frame)
        self.left -= 1
        if self.left >= 0:
            return super().deliveries(line, sender, frame)
        if not self.acted:
            self.acted = True
            self.wants_interrupt = self.way.startswith("interrupted")
            if self.way == "closed":
                if sender == HOST:
                    line.write(UNIT, frame)
                line.close(HOST)
        return super().deliveries(line, sender, frame) if self.way == "interrupted" else []
