"""A line between a host and a unit that spoils what passes, on pseudo-terminals or TCP, and as slow as a wire if asked.

A `Line` carries frames, asks its `Faults` what becomes of each, and brings it when its time has come.
"""
import collections
import errno
import heapq
import os
import pty
import select
import signal
import socket
import struct
import time
import tty

import modbus_host as modbus

HOST, UNIT = "host", "unit"
OTHER = {HOST: UNIT, UNIT: HOST}
PAUSE_S = 0.0008  # ends a frame on a serial line
CHUNK = 16  # bytes that come at once on a paced line
LATE_S = 0.35  # longer than the host waits for a reply on a fast line
FOREVER = 1e9

Delivery = collections.namedtuple("Delivery", "data to after")


class Line:
    def __init__(self, faults, host=None, unit=None, tcp=False, baud=None):
        self.faults, self.tcp, self.baud = faults, tcp, baud
        self.fd = {HOST: host, UNIT: unit}
        self.parts = {HOST: b"", UNIT: b""}
        self.frame_ends = {HOST: None, UNIT: None}
        self.free_at = {HOST: 0.0, UNIT: 0.0}
        self.queue, self.posted = [], 0
        self.frames = self.bytes = 0
        self.history = collections.deque(maxlen=40)
        self.commands = collections.Counter()  # that the host gave, by code

    def post(self, delivery):
        at = max(time.monotonic() + delivery.after, self.free_at[delivery.to])
        size = CHUNK if self.baud else len(delivery.data)
        for k in range(0, len(delivery.data), max(size, 1)):
            part = delivery.data[k:k + size]
            at += 10 * len(part) / self.baud if self.baud else 0
            self.posted += 1
            heapq.heappush(self.queue, (at, self.posted, delivery.to, part))
        if self.baud:
            self.free_at[delivery.to] = at

    def write(self, to, data):
        if self.fd[to] is None:
            return
        try:
            while data:
                data = data[os.write(self.fd[to], data):]
        except OSError:
            pass  # the other end has gone: its bytes are lost, as on a wire

    def close(self, end):
        if self.fd[end] is not None:
            os.close(self.fd[end])
            self.fd[end] = None

    def lead_to(self, unit):
        """Another descriptor at the unit's end."""
        self.close(UNIT)
        self.fd[UNIT] = unit

    def note_command(self, frame):
        pdu = frame[7:] if self.tcp else frame[1:]
        if len(pdu) > 10 + 2 * modbus.AT_CODE + 1 and pdu[0] == 23 and struct.unpack(">H", pdu[5:7])[0] == modbus.COMMAND:
            at = 10 + 2 * modbus.AT_CODE
            self.commands[struct.unpack(">H", pdu[at:at + 2])[0]] += 1

    def take(self, sender, frame):
        self.frames += 1
        self.bytes += len(frame)
        self.history.append((sender, frame))
        if sender == HOST:
            self.note_command(frame)
        for delivery in self.faults.deliveries(self, sender, frame):
            self.post(delivery)

    def read(self, end):
        try:
            data = os.read(self.fd[end], 4096)
        except OSError as problem:
            data = b"" if problem.errno in (errno.EIO, errno.ECONNRESET, errno.EPIPE) else None
        if not data:
            if self.tcp:  # one end has closed: the other one sees it too
                self.close(HOST)
                self.close(UNIT)
            else:
                time.sleep(0.001)  # nobody has the terminal open yet, or any more
            return
        self.parts[end] += data
        if not self.tcp:
            self.frame_ends[end] = time.monotonic() + PAUSE_S
            return
        while len(self.parts[end]) >= 6:
            length = 6 + struct.unpack(">H", self.parts[end][4:6])[0]
            if len(self.parts[end]) < length:
                break
            frame, self.parts[end] = self.parts[end][:length], self.parts[end][length:]
            self.take(end, frame)

    def step(self, wait):
        now = time.monotonic()
        times = [now + wait] + [at for at in self.frame_ends.values() if at is not None]
        times += [self.queue[0][0]] if self.queue else []
        ready = select.select([fd for fd in self.fd.values() if fd is not None], [], [], max(0.0, min(times) - now))[0]
        for end in (HOST, UNIT):
            if self.fd[end] is not None and self.fd[end] in ready:
                self.read(end)
        for end in (HOST, UNIT):
            if self.frame_ends[end] is not None and self.frame_ends[end] <= time.monotonic():
                frame, self.parts[end], self.frame_ends[end] = self.parts[end], b"", None
                self.take(end, frame)
        while self.queue and self.queue[0][0] <= time.monotonic():
            _, _, to, data = heapq.heappop(self.queue)
            self.write(to, data)


class Faults:
    """Passes everything; the base of what does not."""

    label = "clean"

    def deliveries(self, line, sender, frame):
        return [Delivery(frame, OTHER[sender], 0.0)]

    def may_connect(self):
        """Whether a new TCP connection of the host is led to the unit."""
        return True


# ---------------------------------------------------------------- faults of one frame: (rng, line, sender, frame, master)

def passed(sender, data, after=0.0):
    return [Delivery(data, OTHER[sender], after)]


def drop(rng, line, sender, frame, master):
    data = bytearray(frame)
    for _ in range(rng.choice((1, 1, 2, 5))):
        if len(data) > 1:
            del data[rng.randrange(len(data))]
    return passed(sender, bytes(data))


def flip(rng, line, sender, frame, master):
    data = bytearray(frame)
    for _ in range(rng.choice((1, 1, 2, 3, 8))):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return passed(sender, bytes(data))


def mended_flip(rng, line, sender, frame, master):
    """One bit, and a CRC-16 that agrees with it."""
    if len(frame) < 6:
        return passed(sender, frame)
    data = bytearray(frame[:-2])
    data[rng.randrange(1, len(data))] ^= 1 << rng.randrange(8)
    return passed(sender, bytes(data) + struct.pack("<H", modbus.crc16(data)))


def repeat(rng, line, sender, frame, master):
    return passed(sender, frame) + passed(sender, frame, rng.choice((0.0, 0.002)))


def late_repeat(rng, line, sender, frame, master):
    return passed(sender, frame) + passed(sender, frame, rng.choice((0.01, 0.1, LATE_S, 1.0)))


def swallow(rng, line, sender, frame, master):
    return []


def delay(rng, line, sender, frame, master):
    return passed(sender, frame, rng.choice((0.02, 0.2, LATE_S, 2 * LATE_S, 1.2)))


def split(rng, line, sender, frame, master):
    at = rng.randrange(1, len(frame)) if len(frame) > 1 else 1
    return passed(sender, frame[:at]) + passed(sender, frame[at:], rng.choice((0.003, 0.015, 0.03, 0.06, LATE_S)))


def truncate(rng, line, sender, frame, master):
    return passed(sender, frame[:rng.randrange(len(frame))])


def replay(rng, line, sender, frame, master):
    """A frame from before comes again, of either side."""
    old_sender, old = rng.choice(line.history)
    return passed(sender, frame) + passed(old_sender, old, rng.choice((0.0, 0.005, 0.05)))


def noise(rng, line, sender, frame, master):
    stray = rng.randbytes(rng.choice((1, 2, 5, 30, 300)))
    return passed(sender, rng.choice((stray + frame, frame + stray, frame[:3] + stray + frame[3:])))


def burst(rng, line, sender, frame, master):
    stray, at = rng.randbytes(rng.randint(2, 20)), rng.randrange(len(frame))
    return passed(sender, frame[:at] + stray + frame[at + len(stray):])


def echo(rng, line, sender, frame, master):
    return [Delivery(frame, sender, 0.0)] + passed(sender, frame)


def second_master(rng, line, sender, frame, master):
    return passed(sender, frame) + [Delivery(master(rng), UNIT, rng.choice((0.0, 0.0, 0.002, 0.05)))]


SERIAL_KINDS = {f.__name__: f for f in (drop, flip, mended_flip, repeat, late_repeat, swallow, delay, split, truncate, replay,
                                        noise, burst, echo, second_master)}
TCP_KINDS = {f.__name__: f for f in (repeat, late_repeat, swallow, delay, split, second_master)}
HOLDING = ("merge", "silence")  # kinds that reach over several frames


class SecondMaster:
    """What another host on the line might send, with a session of its own: armed, or not."""

    def __init__(self, host):
        self.host = host

    def __call__(self, rng):
        host = self.host
        axis_memory = modbus.long(rng.choice((0x100000, 0x200000)) + 234 * rng.randrange(4))
        window = modbus.sealed([rng.getrandbits(16)] + host.asker() + modbus.long(rng.randrange(1, 65536)) + axis_memory +
                               modbus.long(234) + modbus.long(rng.getrandbits(32)) + [rng.randrange(2)],
                               modbus.OF_WINDOW, host.secret_key)
        host.open_window = (rng.randrange(1, 65536), modbus.number(axis_memory), 234, rng.getrandbits(32))
        commit = modbus.commit(rng.randbytes(936), rng.getrandbits(32))
        commands = ((modbus.CHECK, [0x10, 0, 0, 240]), (modbus.ABANDON, modbus.long(rng.getrandbits(32))),
                    (modbus.BEGIN, [rng.randrange(3)]), (modbus.STOP, []), (modbus.OFF, []), (modbus.COMMIT, commit),
                    (modbus.CLEAR, []), (modbus.INTEGRATE, []))
        reads = (modbus.fc3(modbus.STATUS, 58), modbus.fc3(modbus.IDENTITY, 54), modbus.fc3(modbus.POINTERS, 77),
                 modbus.fc3(modbus.RESULT, modbus.RESULT_COUNT), modbus.fc3(modbus.ACK, modbus.ACK_COUNT),
                 modbus.fc3(modbus.MEMORY, 125),
                 modbus.fc16(modbus.ECHO, [rng.getrandbits(16)]), modbus.fc6(modbus.ECHO, rng.getrandbits(16)),
                 modbus.fc23(modbus.MEMORY, 125, modbus.SELECT, [rng.getrandbits(16), 0x10, 0, 240]),
                 modbus.fc23(modbus.STATUS, 58, modbus.ECHO, [rng.getrandbits(16)]))
        writes = (modbus.fc23(modbus.ACK, modbus.ACK_COUNT, modbus.WINDOW, window), modbus.fc16(modbus.WINDOW, window),
                  modbus.fc6(modbus.WINDOW + 1, rng.getrandbits(16)), modbus.fc6(modbus.COMMAND + 6, rng.getrandbits(16)),
                  host.window_block(rng.randrange(4), bytes(234)))
        code, arguments = rng.choice(commands)
        given = modbus.fc23(modbus.RESULT, modbus.RESULT_COUNT, modbus.COMMAND, host.block(code, arguments))
        return host.framed(rng.choice((rng.choice(reads), rng.choice(writes), given)))


class DrawnFaults(Faults):
    """A plan drawn by chance: one fault, a stretch of one kind, a mixture, a cut for some time, a closed line, an echo.

    @param frames  about this many pass in a clean transfer
    """

    def __init__(self, rng, tcp, frames, master, kinds=None, shape=None, likelihood=None):
        self.rng, self.master, self.frames = rng, master, frames
        self.functions = TCP_KINDS if tcp else SERIAL_KINDS
        self.kinds = kinds or list(self.functions) + list(HOLDING)
        self.counts = collections.Counter()
        self.held, self.silent_until = {HOST: b"", UNIT: b""}, 0.0
        shapes = ("one", "mixture", "cut", "stretch", "closed") + (() if tcp else ("every echo",))
        self.shape = shape or rng.choices(shapes, (40, 30, 12, 8, 7, 3)[:len(shapes)])[0]
        self.kind = "echo" if self.shape == "every echo" else rng.choice(self.kinds)
        self.some = rng.sample(self.kinds, min(len(self.kinds), rng.randint(1, 4)))
        self.likelihood = likelihood or rng.choice((0.01, 0.02, 0.05, 0.1, 0.2))
        self.first = rng.randrange(frames)
        self.last = self.first if self.shape == "one" else self.first + rng.randint(2, 12)
        self.bytes_left = rng.randrange(45 * frames)
        self.pause_s = rng.choice((0.2, 0.6, 1.5, 3.0, FOREVER))
        named = {"one": "one " + self.kind, "stretch": "stretch " + self.kind}
        self.label = named.get(self.shape, self.shape)

    def may_connect(self):
        return time.monotonic() >= self.silent_until

    def kind_now(self, line):
        if self.shape in ("one", "stretch"):
            return self.kind if self.first <= line.frames - 1 <= self.last else None
        if self.shape == "mixture":
            return self.rng.choice(self.some) if self.rng.random() < self.likelihood else None
        return "echo" if self.shape == "every echo" else None

    def cut(self, line, sender, frame):
        """What of the frame passes before the line is cut; None: all of it."""
        if self.bytes_left < 0:
            return None
        if len(frame) <= self.bytes_left:
            self.bytes_left -= len(frame)
            return None
        part, self.bytes_left = frame[:self.bytes_left], -1
        self.silent_until = time.monotonic() + self.pause_s
        self.counts[self.shape] += 1
        if self.shape == "closed":
            line.write(OTHER[sender], part)
            line.close(HOST)
        return part

    def deliveries(self, line, sender, frame):
        if self.shape in ("cut", "closed"):
            part = self.cut(line, sender, frame)
            if part is not None:
                return passed(sender, part)
        if time.monotonic() < self.silent_until:
            return []
        frame, self.held[sender] = self.held[sender] + frame, b""
        kind = self.kind_now(line)
        if kind is None:
            return passed(sender, frame)
        self.counts[kind] += 1
        if kind == "merge":
            self.held[sender] = frame
            return []
        if kind == "silence":
            self.silent_until = time.monotonic() + self.rng.choice((0.1, 0.4, 0.9, 2.0))
            return []
        return self.functions[kind](self.rng, line, sender, frame, self.master)


# ---------------------------------------------------------------- `ecs` at the host's end

class HostEnd:
    """Where `ecs` connects: a pseudo-terminal, or a port."""

    def __init__(self, tcp, baud):
        self.tcp, self.fd = tcp, None
        if tcp:
            self.listener = socket.create_server(("127.0.0.1", 0))
            self.listener.setblocking(False)
            self.link = "tcp:127.0.0.1:%d" % self.listener.getsockname()[1]
        else:
            self.fd, self.slave = pty.openpty()
            tty.setraw(self.slave)
            self.link = "rtu:%s:%d" % (os.ttyname(self.slave), baud or 921600)

    def accept(self, line, place):
        """Leads a new connection to the unit."""
        try:
            near, _ = self.listener.accept()
        except (BlockingIOError, OSError):
            return
        near.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        line.close(HOST)
        line.parts = {HOST: b"", UNIT: b""}
        try:
            line.lead_to(modbus.connected_to(place.port).detach())
            line.fd[HOST] = near.detach()
        except OSError:
            near.close()

    def close(self):
        if self.tcp:
            self.listener.close()
        else:
            os.close(self.slave)


Ending = collections.namedtuple("Ending", "code said out seconds line")


def through_line(place, words, faults, limit_s=60.0, baud=None, on_step=None):
    """Runs `ecs WORDS` over a spoilt line. on_step(line, process, seconds since the start) may act on either end.
    The exit code is "hang" where `ecs` still ran after the limit."""
    end = HostEnd(place.tcp, baud)
    out, errors = place.dir / "ecs.out", place.dir / "ecs.err"
    begun = time.monotonic()
    with open(out, "wb") as to, open(errors, "wb") as to_errors:
        process = place.ecs(*words, link=end.link, stdout=to, stderr=to_errors, text=False)
    line = Line(faults, end.fd, None if place.tcp else place.descriptor(), place.tcp, baud)
    hung = False
    try:
        while process.poll() is None:
            if place.tcp and line.fd[HOST] is None and faults.may_connect():
                end.accept(line, place)
            line.step(0.01)
            spent = time.monotonic() - begun
            if on_step:
                on_step(line, process, spent)
            if spent > limit_s:
                hung = True
                process.kill()
                process.wait()
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
        line.close(HOST)
        line.close(UNIT)
        end.close()
    said_out = out.read_text(errors="replace")
    said = said_out + errors.read_text(errors="replace")
    return Ending("hang" if hung else process.returncode, said, said_out, time.monotonic() - begun, line)


def interrupt(process):
    if process.poll() is None:
        process.send_signal(signal.SIGINT)
