"""A Modbus host of its own for the tests of the link (docs/protocol.md): nothing of the programs under test.

Frames of RTU and TCP, sessions, arming, windows, and a whole upload. Used by `attacks` and `line_faults`.
"""
import binascii
import errno
import hashlib
import os
import random
import select
import socket
import struct
import time

ECHO, SELECT, WINDOW, COMMAND, RESULT_SELECT, SESSION_OPEN, BLOCK = 0x00, 0x10, 0x20, 0x30, 0x48, 0x50, 0x80
IDENTITY, STATUS, POINTERS, RESULT, ACK, MEMORY, CHECKS, EVENTS, SESSION = (
    0x0100, 0x0180, 0x0280, 0x0300, 0x0380, 0x0400, 0x0480, 0x0500, 0x0580)
BANK = {1: 0x100000, 2: 0x200000}
RAM = 0x048000
WINDOW_BYTES, BLOCK_BYTES = 15360, 240
INTEGRATE, COMPENSATE, POSITION, OUTPUT, OFF, BEGIN, COMMIT, ABANDON = range(1, 9)
DATUM, RECORD, RUN, RAM_TEST, CLEAR, RESET, CHECK, STOP, ARM = range(9, 18)
BUSY, DONE, REFUSED = 1, 2, 3
TIME_OUT, TOKEN_EXPIRED, SESSION_UNKNOWN, LATE, OVERTAKEN, NOT_ARMED, WRONG_CODE, TOO_MANY = 14, 15, 17, 18, 19, 21, 22, 23
ZEROS, COPY, KEPT = 0, 1, 2  # what begin staging leaves in the bank


def crc_table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = byte >> 1 ^ (0xA001 if byte & 1 else 0)
        table.append(byte)
    return table


CRC_TABLE = crc_table()


def crc16(data):
    crc = 0xFFFF
    for byte in data:
        crc = crc >> 8 ^ CRC_TABLE[(crc ^ byte) & 0xFF]
    return crc


def words_of(data):
    return list(struct.unpack(">%dH" % (len(data) // 2), data))


def bytes_of(words):
    return struct.pack(">%dH" % len(words), *words)


def long(value):
    return [value >> 16 & 0xFFFF, value & 0xFFFF]


def double(value):
    return words_of(struct.pack(">d", value))


def number(words):
    return words[0] << 16 | words[1]


def sealed(words):
    """A request block, echo first, with the check at its end."""
    return words + long(binascii.crc32(bytes_of(words[1:])))


def fc3(first, count):
    return struct.pack(">BHH", 3, first, count)


def fc6(at, value):
    return struct.pack(">BHH", 6, at, value)


def fc16(first, words):
    return struct.pack(">BHHB", 16, first, len(words), 2 * len(words)) + bytes_of(words)


def fc22(at, keep, put):
    return struct.pack(">BHHH", 22, at, keep, put)


def fc23(read, count, write, words):
    return struct.pack(">BHHHHB", 23, read, count, write, len(words), 2 * len(words)) + bytes_of(words)


def rtu_frame(pdu, unit=1):
    body = bytes([unit]) + pdu
    return body + struct.pack("<H", crc16(body))


def tcp_frame(pdu, unit=1, transaction=1):
    return struct.pack(">HHHB", transaction & 0xFFFF, 0, len(pdu) + 1, unit) + pdu


def output(axis, micrometres, relay):
    """Arguments of the command `output compensation`."""
    return [axis] + double(micrometres) + [1 if relay else 0]


def connected_to(port):
    connection = socket.create_connection(("127.0.0.1", port), timeout=10)
    connection.settimeout(None)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return connection


class NoAnswer(RuntimeError):
    pass


class Host:
    """A host on a TCP connection or a serial descriptor; its key is by chance unless given."""

    def __init__(self, port=None, fd=None, key=None, version=2, tries=1):
        self.tcp, self.tries = fd is None, tries
        if self.tcp:
            self.socket = connected_to(port)
            fd = self.socket.fileno()
        self.fd = fd
        self.key = key if key is not None else random.getrandbits(64)
        self.number, self.version = random.getrandbits(32), version
        self.session = self.sequence = self.stops = self.armed = self.wait = 0
        self.clock = [0, 0]
        self.echo = random.getrandbits(16)

    def close(self):
        if self.tcp:
            self.socket.close()
        elif self.fd is not None:
            os.close(self.fd)
        self.fd = None

    def framed(self, pdu, unit=1):
        return tcp_frame(pdu, unit) if self.tcp else rtu_frame(pdu, unit)

    def send(self, pdu, unit=1):
        os.write(self.fd, self.framed(pdu, unit))

    def receive(self, wait=2.0):
        got, end = b"", time.monotonic() + wait
        while time.monotonic() < end:
            if not select.select([self.fd], [], [], max(0, end - time.monotonic()))[0]:
                break
            piece = os.read(self.fd, 4096)
            if not piece:
                raise OSError(errno.EPIPE, "the unit has closed the connection")
            got += piece
            if self.tcp and len(got) >= 6 and len(got) >= 6 + struct.unpack(">H", got[4:6])[0]:
                return got[7:]
            if not self.tcp and len(got) >= 5 and crc16(got[:-2]) == struct.unpack("<H", got[-2:])[0]:
                return got[1:-2]
        return None

    def drain(self, quiet=0.04):
        """Drops what is still under way on the link."""
        while select.select([self.fd], [], [], quiet)[0]:
            if not os.read(self.fd, 4096):
                return

    def ask(self, pdu, wait=2.0):
        """The reply. Every request of this host may come twice: sessions make it harmless."""
        for _ in range(self.tries):
            self.send(pdu)
            reply = self.receive(wait)
            if reply is not None and reply[0] & 0x7F == pdu[0]:
                return reply
            if self.tries > 1:
                self.drain()
        raise NoAnswer("the unit does not answer")

    def read(self, first, count, write=ECHO, words=None):
        request = list(words or [0])
        for _ in range(self.tries):
            self.echo = (self.echo + 1) & 0xFFFF
            request[0] = self.echo
            reply = self.ask(fc23(first, count, write, request))
            if reply[0] != 23:
                raise RuntimeError("exception %s" % reply.hex())
            answer = words_of(reply[2:2 + 2 * count])
            if len(answer) == count and answer[0] == self.echo:
                return answer
            self.drain()  # a late one: what was asked is still to come
        raise RuntimeError("an answer to something else")

    def look(self):
        """Opens the session, or reads it as it is now."""
        name = words_of(b"attacker".ljust(16, b"\0"))
        block = sealed([0, self.version] + words_of(struct.pack(">Q", self.key)) + long(self.number) +
                       long(int(time.time())) + name)
        w = self.read(SESSION, 12, SESSION_OPEN, block)
        self.session, self.sequence = number(w[3:5]), w[5]
        self.clock, self.stops, self.armed, self.wait = w[6:8], w[8], number(w[9:11]), w[11]
        return self

    def block(self, code, arguments=(), sequence=None):
        if sequence is None:
            self.sequence = self.sequence % 65535 + 1
            sequence = self.sequence
        arguments = list(arguments) + [0] * (8 - len(arguments))
        return sealed([0] + long(self.session) + [sequence, code] + list(self.clock) + [self.stops] + arguments)

    def give(self, block):
        """(state, error, value, token) of a command block."""
        w = self.read(RESULT, 51, COMMAND, block)
        end = time.monotonic() + 60
        while w[4] == BUSY and time.monotonic() < end:
            time.sleep(0.005)
            w = self.read(RESULT, 51, RESULT_SELECT, [0] + long(self.session) + [block[3]])
        return w[4], w[5], number(w[7:9]), number(w[9:11])

    def command(self, code, arguments=()):
        self.look()
        return self.give(self.block(code, arguments))

    def arm(self, code, minutes=30):
        self.look()
        digest = hashlib.sha256(("%08x:%s" % (self.session, code)).encode()).digest()
        return self.give(self.block(ARM, [minutes] + words_of(digest[:8])))

    def window(self, tag, address, length, token):
        """The error with which a window is opened."""
        words = sealed([0, tag] + long(address) + long(length) + long(token) + [0] + long(self.session))
        return self.read(ACK, 13, WINDOW, words)[2]

    def window_block(self, tag, at, token, data):
        check = crc16(struct.pack(">LLHH", self.session, token, tag, at) + data)
        return fc16(BLOCK, [tag, at, check] + words_of(data + b"\0" * (len(data) % 2)))

    def put(self, tag, at, token, data):
        """Whether a block was taken."""
        return self.ask(self.window_block(tag, at, token, data))[0] == 16

    def write(self, address, data, token=0):
        """Through windows; whether everything was taken."""
        for at in range(0, len(data), WINDOW_BYTES):
            part, tag = data[at:at + WINDOW_BYTES], 1 + at // WINDOW_BYTES
            if self.look().window(tag, address + at, len(part), token) != 0:
                return False
            for k in range(0, len(part), BLOCK_BYTES):
                if not self.put(tag, k // BLOCK_BYTES, token, part[k:k + BLOCK_BYTES]):
                    return False
        return True

    def stage(self, data, holds=ZEROS):
        """Begins a staging and writes into it: its token."""
        state, error, address, token = self.command(BEGIN, [holds])
        if state != DONE or not self.write(address, data, token):
            raise RuntimeError("staging: state %d, error %d" % (state, error))
        return token

    def upload(self, image):
        """Makes an image active, as plainly as the protocol allows."""
        token = self.stage(image)
        state, error, _, _ = self.command(COMMIT, long(len(image)) + long(binascii.crc32(image)) + long(token))
        if state != DONE:
            raise RuntimeError("commit: state %d, error %d" % (state, error))

    def memory(self, address, length):
        out = b""
        while len(out) < length:
            n = min(BLOCK_BYTES, length - len(out))
            at = address + len(out)
            w = self.read(MEMORY, 125, SELECT, [0] + long(at) + [n])
            data = bytes_of(w[5:])[:n]
            if number(w[3:5]) != binascii.crc32(data) or number(w[1:3]) != at:
                raise RuntimeError("memory does not agree with its CRC")
            out += data
        return out

    def status(self):
        return self.read(STATUS, 58)

    def relays(self):
        w = self.status()
        return [w[31 + 9 * axis + 8] for axis in range(3)]

    def active(self):
        """(bank, image); bank 0 and None without a map."""
        w = self.status()
        if w[13] == 0:
            return 0, None
        return w[13], self.memory(BANK[w[13]], number(w[16:18]))
