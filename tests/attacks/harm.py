"""The run `harm` of `line_faults`: what any program may do to a unit without the code, and with it. One probe a trial."""
import json
import struct
import subprocess
import time

import modbus_host as modbus
from faulty_line import OTHER, UNIT, Delivery, Faults, through_line
from unit_runs import ending
from upload_runs import UploadRun
from workplace import CODE

PROBES = []


def probe(function):
    PROBES.append(function)
    return function


class Bench:
    """What a probe has at hand: a unit that holds small2, an armed and an unarmed stranger."""

    def __init__(self, run):
        self.run, self.place, self.maps = run, run.place, run.maps
        run.prepare("small2", "small1", "zeros")
        self.hosts = []

    def stranger(self, armed):
        host = self.place.host(tries=6)
        self.hosts.append(host)
        host.look()
        if armed:
            host.arm(CODE)
        return host

    def unchanged(self):
        return self.place.held() == self.maps.images["small2"]

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for host in self.hosts:
            if host.fd is not None:
                host.close()


class Harm(UploadRun):
    """What a program may do to the unit without the code, and with it."""

    def trial(self, rng):
        function = PROBES[self.options.number % len(PROBES)]
        with Bench(self) as bench:
            right, what = function(bench)
        yield function.__doc__.rstrip("."), "refused" if right else "WRONG done", ending(what), {}


@probe
def loopback_only(bench):
    """The port is open on loopback only."""
    listening = [line.split()[1] for line in open("/proc/net/tcp").readlines()[1:] if line.split()[3] == "0A"]
    wide = [a for a in listening if a.endswith(":%04X" % bench.place.port) and not a.startswith("0100007F")]
    return not wide, str(wide)


@probe
def relay_without_the_code(bench):
    """A stranger closes a relay."""
    host = bench.stranger(False)
    answer = host.command(modbus.OUTPUT, modbus.output(0, 20.0, True))
    return answer[1] == modbus.NOT_ARMED and host.relays() == [0, 0, 0], str(answer)


@probe
def relay_with_the_code_opens(bench):
    """A relay that an armed host closed opens 60 s later, whoever reads, and the event list has both."""
    host, reader = bench.stranger(True), bench.stranger(False)
    answer = host.command(modbus.OUTPUT, modbus.output(0, 5.0, True))
    closed = host.relays()
    for _ in range(7):
        reader.status()
        bench.place.workshop("wait", "10")
        reader.memory(0x400, 16)
    listed = reader.read(modbus.EVENTS, 96, modbus.EVENT_SELECT, [0] + modbus.long(max(1, reader_newest(reader) - 2)))
    events = [tuple(listed[3 + 31 * k + 8:][:2]) for k in range(3)]  # command, error
    told = (modbus.OUTPUT, 0) in events and (modbus.OUTPUT, modbus.TIME_OUT) in events
    return answer[0] == modbus.DONE and closed == [1, 0, 0] and reader.relays() == [0, 0, 0] and told, \
        "%s, then %s, events %s" % (closed, reader.relays(), events)


def reader_newest(host):
    return modbus.number(host.read(modbus.EVENTS, 96, 0x68, [0, 0, 1])[1:3])


@probe
def register_repeats_command(bench):
    """One register written repeats the last command."""
    host = bench.stranger(True)
    host.command(modbus.OUTPUT, modbus.output(0, 5.0, True))
    bench.stranger(False).command(modbus.OFF)
    for at in range(23):
        host.ask(modbus.fc6(modbus.COMMAND + at, 4711))
    return host.relays() == [0, 0, 0], str(host.relays())


def writes_into_active_bank(bench, armed):
    host = bench.stranger(armed)
    bank = host.active()[0]
    token = host.command(modbus.BEGIN, [0])[3] if armed else 0
    errors = [host.look().window(modbus.BANK[bank] + at, 2, token) for at in (0, 0x200)]
    taken = host.put(0, b"\xAA\x55")
    return all(errors) and not taken and bench.unchanged(), "errors %s" % errors


@probe
def active_map_without_the_code(bench):
    """A stranger writes into the active map."""
    return writes_into_active_bank(bench, False)


@probe
def active_map_with_the_code(bench):
    """An armed host writes into the active map."""
    return writes_into_active_bank(bench, True)


@probe
def window_over_both_banks(bench):
    """An armed host opens a window that begins in one region and ends in another."""
    host = bench.stranger(True)
    _, _, address, token = host.command(modbus.BEGIN, [0])
    errors = [host.look().window(start, modbus.WINDOW_BYTES, token) for start in (
        address - 240, address + 0x12000 - 240, modbus.BANK[1] - 240, 0x0F0000, 0x0EFFF0, 0xFFFFFF00)]
    return all(errors) and bench.unchanged(), "errors %s" % errors


def runs(host, code):
    wrote = host.write(0x041000, code)
    return wrote, host.command(modbus.RUN, modbus.long(0x041000) + [0, 0])


@probe
def code_without_the_code(bench):
    """A stranger runs machine code."""
    wrote, answer = runs(bench.stranger(False), bytes.fromhex("70074E75"))
    return not wrote and answer[1] == modbus.NOT_ARMED, str(answer)


@probe
def code_writes_axis_memory(bench):
    """Machine code of an armed host writes into axis memory and commit records."""
    host = bench.stranger(True)
    records = host.memory(0x0F0000, 128)
    answers = []
    for address in (modbus.BANK[1] + 0x200, modbus.BANK[2] + 0x200, 0x0F0002):
        answers.append(runs(host, bytes.fromhex("13FC00AA%08X4E75" % address))[1][:2])
        host.command(modbus.CLEAR)
        host.command(modbus.INTEGRATE)
    return bench.unchanged() and host.memory(0x0F0000, 128) == records, str(answers)


@probe
def code_without_end(bench):
    """Machine code of an armed host never ends; another host is served and can stop it."""
    host, other = bench.stranger(True), bench.stranger(False)
    wrote = host.write(0x041000, bytes.fromhex("60FE"))
    host.look()
    block = host.block(modbus.RUN, modbus.long(0x041000) + [0, 0])
    host.read(modbus.RESULT, modbus.RESULT_COUNT, modbus.COMMAND, block)
    served = other.status()[13] != 0
    other.command(modbus.STOP)
    end = time.monotonic() + 15
    while host.result(block)[5] == modbus.BUSY and time.monotonic() < end:
        time.sleep(0.05)
    return wrote and served and time.monotonic() < end and bench.unchanged(), "served %s" % served


@probe
def other_functions(bench):
    """Functions that the protocol does not use are carried out."""
    host, answers = bench.stranger(True), {}
    for function in set(range(1, 128)) - {3, 4, 6, 16, 22, 23}:
        answers[function] = host.ask(bytes([function, 0, 0, 0, 1]))
    wrong = {function: reply for function, reply in answers.items() if reply != bytes([function | 0x80, 1])}
    return not wrong and bench.unchanged(), str(wrong)


@probe
def idle_connections(bench):
    """Idle connections keep other hosts out."""
    idle = [modbus.connected_to(bench.place.port) for _ in range(12)]
    time.sleep(0.2)
    code, said = bench.place.run("utility", "status")
    for connection in idle:
        connection.close()
    return code == 0, said[-200:]


class LostReply(Faults):
    """The reply to the host's order to close the relay is lost once."""

    def __init__(self):
        self.lost = False

    def deliveries(self, line, sender, frame):
        if sender == UNIT and line.commands[modbus.OUTPUT] and not self.lost:
            self.lost = True
            return []
        return super().deliveries(line, sender, frame)


@probe
def retry_overrides_off(bench):
    """A host's retry of an order closes the relay again after another host's off."""
    faults, did = LostReply(), []

    def step(line, process, spent):
        if faults.lost and not did:
            did.append(bench.place.run("utility", "output", "--off")[0])

    end = through_line(bench.place, ["utility", "output", "X", "5", "--relay", "--yes"], faults, on_step=step)
    relays = bench.stranger(False).relays()
    return did == [0] and relays == [0, 0, 0], "off: %s, relays %s, %s" % (did, relays, end.said[-200:])


@probe
def power_up_with_a_reader(bench):
    """A reader at power-up keeps the unit from compensating."""
    place = bench.place
    place.end()
    place.mode = "auto"
    place.start()
    modes = []
    for reads in (False, True):
        place.workshop("power", "off")
        place.workshop("power", "on")
        host = bench.stranger(False) if reads else None
        end = time.monotonic() + 1.5
        while time.monotonic() < end:
            if reads:
                host.status()
            time.sleep(0.1)
        time.sleep(0.5)
        modes.append(place.state()["unit"]["mode"])
    place.end()
    place.mode = "integrate"
    place.start()
    return modes[0] == modes[1], str(modes)


class OtherBank(Faults):
    """The answer to begin staging names the bank of the active map."""

    def __init__(self):
        self.bent = False

    def deliveries(self, line, sender, frame):
        if sender == UNIT and line.commands[modbus.BEGIN] and not self.bent and frame[7] == 23 and len(frame) > 30:
            address = struct.unpack(">I", frame[25:29])[0]
            if address in modbus.BANK.values():
                self.bent = True
                frame = frame[:25] + struct.pack(">I", sum(modbus.BANK.values()) - address) + frame[29:]
        return [Delivery(frame, OTHER[sender], 0.0)]


@probe
def bent_address(bench):
    """The unit names the active bank to write to, and the host believes it."""
    faults = OtherBank()
    end = through_line(bench.place, bench.maps.send("small1"), faults)
    return faults.bent and end.code != 0 and "the old map is active" in end.said and bench.unchanged(), end.said[-300:]


@probe
def incomplete_parameters(bench):
    """A parameter file that lost its end is sent."""
    whole = open(bench.maps.parameters).read()
    codes = []
    for share in (0.0, 0.5, 0.9, 0.999):
        short = bench.place.dir / "short.toml"
        short.write_text(whole[:int(share * len(whole))])
        codes.append(bench.place.run("map", "send", str(bench.maps.path("small1")), "--params", str(short))[0])
        codes.append(bench.place.run("params", "send", str(short))[0])
    return 0 not in codes and bench.unchanged(), str(codes)


@probe
def deep_toml(bench):
    """Deeply nested TOML ends the program with a signal."""
    deep, codes = bench.place.dir / "deep.toml", []
    for text in ("a" + ".a" * 100000 + " = 1\n", "a = " + "[" * 100000 + "]" * 100000 + "\n"):
        deep.write_text(text)
        done = subprocess.run([bench.run.options.ecs, "batch", str(deep), "--dry-run"], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        codes.append(done.returncode)
    return codes == [3, 3], str(codes)
