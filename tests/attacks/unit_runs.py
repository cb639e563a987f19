"""Runs of `line_faults` about the unit alone: its battery file, and frames by chance."""
import os
import struct
import time

import modbus_host as modbus
from faulty_line import Ending
from upload_runs import COMPENSATING, UploadRun
from workplace import CODE

MAGIC_BYTES, SLOT_BYTES = 14, 64  # of the battery file, of each of its two commit records
RECORD_BYTES = 24


def ending(said="", code=0, begun=0.0):
    return Ending(code, said, "", time.monotonic() - begun if begun else 0.0, None)


class Battery(UploadRun):
    """The battery file is cut, changed, or of another size while the unit is off: never an older map, never a damaged
    one, never silence."""

    battery = True
    kinds = ("cut", "longer", "empty", "flip anywhere", "flip in the active image", "flip in the record in force",
             "flip in the other slot", "zero page", "page by chance")

    def __init__(self, options, folder):
        super().__init__(options, folder)
        self.prepare("small1", "small3", "zeros")
        self.place.holds(self.maps.images["small2"])
        self.place.end()
        self.good = (folder / "battery").read_bytes()

    def spoilt(self, rng, kind):
        data = bytearray(self.good)
        sequences = [struct.unpack(">I", data[MAGIC_BYTES + SLOT_BYTES * k + 4:][:4])[0] for k in range(2)]
        in_force = MAGIC_BYTES + SLOT_BYTES * (sequences[1] > sequences[0])
        other = 2 * MAGIC_BYTES + SLOT_BYTES - in_force
        image = self.maps.images["small2"]

        def flip(at):
            data[at] ^= 1 << rng.randrange(8)

        if kind == "cut":
            del data[rng.randrange(len(data)):]
        elif kind == "longer":
            data += bytes(rng.randrange(1, 5000))
        elif kind == "empty":
            data.clear()
        elif kind == "flip anywhere":
            for _ in range(rng.choice((1, 10, 1000))):
                flip(rng.randrange(MAGIC_BYTES, len(data)))
        elif kind == "flip in the active image":
            flip(self.good.index(image) + rng.randrange(len(image)))
        elif kind == "flip in the record in force":
            flip(in_force + rng.randrange(RECORD_BYTES))
        elif kind == "flip in the other slot":
            flip(other + rng.randrange(SLOT_BYTES))
        else:
            size = 4096 if kind == "zero page" else 512
            at = rng.randrange(0, len(data) // size) * size
            part = len(data[at:at + size])
            data[at:at + size] = bytes(part) if kind == "zero page" else rng.randbytes(part)
        return bytes(data)

    def trial(self, rng):
        kind = rng.choice(self.kinds)
        self.place.end()
        (self.place.dir / "battery").write_bytes(self.spoilt(rng, kind))
        try:
            self.place.start()
        except RuntimeError as problem:
            yield kind, "refused to start", ending(str(problem)), {}
            return
        host = self.place.judge()
        fault = host.status()[2]
        now = self.maps.name_of(host.active()[1])
        state, _, _, _ = host.command(modbus.COMPENSATE)
        words = host.status()
        entered, fault = words[1] in COMPENSATING, fault or words[2]
        host.close()
        if now == "small2":
            verdict = "the map, taken" if entered else "the map, isolated: fault %d" % fault
        elif entered:
            verdict = "WRONG compensates with %s" % now
        elif not fault:
            verdict = "WRONG silent with %s" % now
        else:
            verdict = "no map, fault %d" % fault if now == "none" else "WRONG %s named as active" % now \
                if now in self.maps.names else "damaged map isolated, fault %d" % fault
        yield kind, verdict, ending("state %d, fault %d" % (state, fault)), {}
        self.place.end()


class Fuzz(UploadRun):
    """Bursts of frames by chance, changed before or after they were sealed, from a host that is armed or not."""

    frames = 1000

    def __init__(self, options, folder):
        super().__init__(options, folder)
        self.memory = self.resident()

    def resident(self):
        with open("/proc/%d/status" % self.place.process.pid) as lines:
            return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS"))

    def request(self, rng, host):
        """A block that is right but for what the fuzz draws: some are changed before their check is computed."""
        def changed(words):
            for _ in range(rng.choice((0, 1, 2, 4))):
                words[rng.randrange(len(words))] = rng.choice((0, 1, 0xFFFF, 0x7FFF, 0x8000, rng.getrandbits(16)))
            return words

        where = rng.choice((0x100000, 0x200000, 0x048000, 0x0F0000, 0x111F00))
        length, coded, key = rng.choice((2, 234, 468, 7680)), rng.randrange(2), host.secret_key
        host.windows = (host.windows + rng.randrange(2)) & 0xFFFFFFFF
        host.open_window = (host.windows, where + 234 * rng.randrange(4), length, self.token)
        window = [0] + host.asker() + modbus.long(host.windows) + modbus.long(host.open_window[1]) + modbus.long(
            length) + modbus.long(self.token) + [coded]
        code = rng.choice([c for c in range(0, 23) if c != modbus.RESET] + [modbus.BEGIN] * 4)
        arguments = [rng.choice((0, 1, 2, 0x10, 0x20, 240, rng.getrandbits(16))) for _ in range(8)]
        command = host.block(code, arguments)[:-4]
        number = rng.choice((0, 1, 0x0F00, rng.getrandbits(16)))
        payload = rng.randbytes(2 * rng.choice((1, 8, 60, 117)))
        return rng.choice((
            modbus.fc23(modbus.ACK, modbus.ACK_COUNT, modbus.WINDOW, modbus.sealed(changed(window), modbus.OF_WINDOW, key)),
            modbus.fc23(modbus.RESULT, modbus.RESULT_COUNT, modbus.COMMAND,
                        modbus.sealed(changed(command), modbus.OF_COMMAND, key)),
            host.window_block(number, payload),
            modbus.fc16(modbus.BLOCK, changed([host.windows & 0xFFFF, number, 0, 0, 0, 0] + modbus.words_of(payload))),
            modbus.fc23(modbus.CHECKS, 125, modbus.CHECK_SELECT, changed([0] + host.asker() + [0x10, 0, 0, 936, 480])),
            modbus.fc23(modbus.MEMORY, 125, modbus.SELECT, changed([0, 0x10, 0, 240])),
            modbus.fc23(modbus.MEMORY, 125, modbus.SELECT, changed([0, 0x10, 0, 232] + host.asker())),
            modbus.fc23(modbus.ARM_ANSWER, 29, modbus.ARM_SHARE, modbus.checked(
                changed([0] + modbus.long(host.session) + [1] + modbus.words_of(rng.randbytes(32))))),
            modbus.fc23(modbus.EVENTS, 96, modbus.EVENT_SELECT, changed([0, 0, 1])),
            modbus.fc23(modbus.SESSION, modbus.SESSION_COUNT, modbus.SESSION_OPEN, [rng.getrandbits(16) for _ in range(22)]),
            modbus.fc3(modbus.STATUS, 58), modbus.fc6(rng.randrange(0x100), rng.getrandbits(16)),
            modbus.fc22(rng.randrange(0x100), rng.getrandbits(16), rng.getrandbits(16)),
            bytes([43, 14, 1, 0]), bytes([17]), bytes([8, 0, 0, 1, 2]), bytes([1, 0, 0, 0, 8]), bytes([5, 0, 0, 0xFF, 0])))

    def frame(self, rng, host):
        kind = rng.choice(("sound", "sound", "sound", "pdu", "frame", "half", "long", "storm", "chance"))
        pdu = bytearray(self.request(rng, host))
        if kind == "chance":
            return rng.randbytes(rng.randrange(1, 300))
        if kind == "pdu":
            pdu[rng.randrange(len(pdu))] = rng.getrandbits(8)
            pdu = pdu[:rng.randrange(1, len(pdu) + 1)]
        data = bytearray(host.framed(bytes(pdu), rng.choice((1, 1, 1, 1, 0, 2, 255))))
        if kind == "frame":
            data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        if kind == "half":
            data = data[:rng.randrange(1, len(data))]
        if kind == "long":
            data += rng.randbytes(rng.choice((200, 1000, 5000)))
        return bytes(data) * (rng.choice((2, 10, 40)) if kind == "storm" else 1)

    def trial(self, rng):
        begun = time.monotonic()
        self.prepare("small2", "small1", "zeros")
        armed, self.token, verdict = rng.random() < 0.7, 0, "answers, map unchanged"
        host = self.place.host(tries=6)
        host.look()
        if armed:
            host.arm(CODE)
            self.token = host.command(modbus.BEGIN, [0])[3]
        for k in range(self.frames):
            try:
                if host.fd is None:
                    host = self.place.host(key=host.key, secret=host.secret, tries=6)
                if k % 100 == 99:
                    host.drain(0.05)
                    host.look()
                os.write(host.fd, self.frame(rng, host))
                host.drain(rng.choice((0.0, 0.0, 0.001, 0.004)))
            except (OSError, RuntimeError):
                host.close()
            if self.place.process.poll() is not None:
                yield "armed" if armed else "not armed", "crash, exit %d" % self.place.process.returncode, ending(), {}
                self.place.start()
                return
        if host.fd is not None:
            host.close()
        time.sleep(0.3)
        host = self.place.judge()
        host.command(modbus.STOP)  # a test or user software that a frame has begun
        now = host.active()[1]
        host.close()
        if now != self.maps.images["small2"]:
            verdict = "WRONG %s active" % self.maps.name_of(now)
        grown = self.resident() - self.memory
        if grown > 20_000:
            verdict = "WRONG memory has grown by %d KiB" % grown
        yield "armed" if armed else "not armed", verdict, ending(begun=begun), {"frame": self.frames}
