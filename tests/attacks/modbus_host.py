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

import cpace

ECHO, SELECT, WINDOW, COMMAND, SESSION_OPEN, EVENT_SELECT, BLOCK = 0x00, 0x10, 0x20, 0x38, 0x50, 0x68, 0x80
CHECK_SELECT, RESULT_SELECT, ARM_SHARE, ARM_CONFIRM = 0x600, 0x610, 0x618, 0x630
IDENTITY, STATUS, POINTERS, RESULT, ACK, MEMORY, CHECKS, EVENTS, SESSION, ACTIVE_MAP, ARM_ANSWER = (
    0x0100, 0x0180, 0x0280, 0x0300, 0x0380, 0x0400, 0x0480, 0x0500, 0x0580, 0x05A0, 0x05D0)
OF_WINDOW, OF_BLOCK, OF_COMMAND, OF_ANSWER, OF_PIECE = range(1, 6)  # kinds of keyed checks
AT_CODE, RESULT_COUNT, ACK_COUNT, SESSION_COUNT = 7, 56, 18, 24
BANK = {1: 0x100000, 2: 0x200000}
RAM = 0x048000
WINDOW_BYTES, BLOCK_BYTES, READ_BYTES = 14976, 234, 240
INTEGRATE, COMPENSATE, POSITION, OUTPUT, OFF, BEGIN, COMMIT, ABANDON = range(1, 9)
DATUM, RECORD, RUN, RAM_TEST, CLEAR, RESET, CHECK, STOP, ARM = range(9, 18)
BUSY, DONE, REFUSED = 1, 2, 3
TIME_OUT, TOKEN_EXPIRED, SESSION_UNKNOWN, LATE, OVERTAKEN, NOT_ARMED, WRONG_CODE, TOO_MANY, WRONG_KEY, TOO_OFTEN = (
    14, 15, 17, 18, 19, 21, 22, 23, 24, 9)
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


def checked(words):
    """A request block, echo first, with the CRC-32 at its end."""
    return words + long(binascii.crc32(bytes_of(words[1:])))


def sealed(words, kind, key):
    """A request block, echo first, with the keyed check at its end."""
    return words + words_of(cpace.keyed_check(key, kind, bytes_of(words[1:])))


def short_digest(image):
    """The registers of the first 8 bytes of its SHA-256."""
    return words_of(hashlib.sha256(image).digest()[:8])


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


def commit(image, token):
    """Arguments of the command `commit staged image`."""
    return long(len(image)) + short_digest(image) + long(token)


def connected_to(port, origin="127.0.0.1"):
    connection = socket.create_connection(("127.0.0.1", port), timeout=10, source_address=(origin, 0))
    connection.settimeout(None)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return connection


class NoAnswer(RuntimeError):
    pass


class Host:
    """A host on a TCP connection or a serial descriptor; its key is by chance unless given."""

    def __init__(self, port=None, fd=None, key=None, version=3, tries=1, origin="127.0.0.1", secret=None):
        self.tcp, self.tries = fd is None, tries
        if self.tcp:
            self.socket = connected_to(port, origin)
            fd = self.socket.fileno()
        self.fd = fd
        self.key = key if key is not None else random.getrandbits(64)
        self.number, self.version = random.getrandbits(32), version
        self.session = self.sequence = self.stops = self.armed = self.wait = self.nonce = self.windows = self.asked = 0
        self.secret, self.open_window = secret, None
        self.clock = [0, 0]
        self.echo = random.getrandbits(16)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

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

    @property
    def secret_key(self):
        """Of the session; nothing: this host was never armed."""
        return cpace.session_key(self.secret, self.session, self.nonce) if self.secret else None

    def asker(self):
        self.asked += 1
        return long(self.session) + long(self.asked)

    def is_sealed(self, first, answer):
        """An answer to the last question carries the check of this host's key."""
        content = struct.pack(">HL", first, self.asked) + bytes_of(answer[:-4])
        return bytes_of(answer[-4:]) == cpace.keyed_check(self.secret_key, OF_ANSWER, content)

    def session_block(self):
        name = words_of(b"attacker".ljust(16, b"\0"))
        self.asked += 1
        return checked([0] + long(self.asked) + [self.version] + words_of(struct.pack(">Q", self.key)) +
                       long(self.number) + long(int(time.time())) + name)

    def look(self):
        """Opens the session, or reads it as it is now."""
        block = self.session_block()
        w = self.read(SESSION, SESSION_COUNT, SESSION_OPEN, block)
        self.session, self.sequence, self.windows = number(w[3:5]), number(w[5:7]), max(self.windows, number(w[7:9]))
        self.clock, self.stops, self.armed, self.wait = w[9:11], w[11], number(w[12:14]), w[14]
        self.nonce = struct.unpack(">Q", bytes_of(w[16:20]))[0]
        if not self.armed:
            self.secret = None
        return self

    def block(self, code, arguments=(), sequence=None, key=None):
        if sequence is None:
            self.sequence += 1
            sequence = self.sequence
        arguments = list(arguments) + [0] * (8 - len(arguments))
        return sealed([0] + self.asker() + long(sequence) + [code] + list(self.clock) + [self.stops] + arguments,
                      OF_COMMAND, key or self.secret_key)

    def give(self, block):
        """(state, error, value, token) of a command block."""
        w = self.read(RESULT, RESULT_COUNT, COMMAND, block)
        end = time.monotonic() + 60
        while w[5] == BUSY and time.monotonic() < end:
            time.sleep(0.005)
            w = self.result(block)
        return w[5], w[6], number(w[8:10]), number(w[10:12])

    def result(self, block):
        """The registers of the result of a command block that was given before."""
        return self.read(RESULT, RESULT_COUNT, RESULT_SELECT, [0] + self.asker() + block[5:7])

    def command(self, code, arguments=()):
        self.look()
        return self.give(self.block(code, arguments))

    def serial_number(self):
        return bytes_of(self.read(IDENTITY, 54)[4:12]).rstrip(b"\0").decode()

    def arm(self, code, minutes=30):
        """(state, error, s armed, 0), as of a command."""
        self.look()
        exchange = cpace.Exchange(code, self.serial_number(), self.session, minutes)
        for _ in range(20):
            w = self.read(ARM_ANSWER, 29, ARM_SHARE,
                          checked([0] + long(self.session) + [minutes] + words_of(exchange.share)))
            if w[1] != TOO_OFTEN:
                break
            time.sleep(0.1)
        if w[1] != 0:
            return REFUSED, w[1], 0, 0
        host, unit = exchange.confirms(bytes_of(w[3:19]))
        w = self.read(ARM_ANSWER, 29, ARM_CONFIRM, checked([0] + long(self.session) + words_of(host)))
        if w[1] != 0:
            return REFUSED, w[1], 0, 0
        if bytes_of(w[19:27]) != unit:
            raise RuntimeError("the unit does not know the code")
        self.secret = exchange.secret
        return DONE, 0, number(w[27:29]), 0

    def window(self, address, length, token, again=False):
        """The error with which a window is opened, the next one unless the same again."""
        if not again:
            self.windows += 1
        self.open_window = (self.windows, address, length, token)
        words = [0] + self.asker() + long(self.windows) + long(address) + long(length) + long(token) + [0]
        return self.read(ACK, ACK_COUNT, WINDOW, sealed(words, OF_WINDOW, self.secret_key))[3]

    def window_block(self, at, data, token=None, key=None):
        opened, address, length, of_window = self.open_window
        head = struct.pack(">LLLLLHH", self.session, opened, address, length, of_window if token is None else token, 0, at)
        check = cpace.keyed_check(key or self.secret_key, OF_BLOCK, head + data)
        return fc16(BLOCK, [opened & 0xFFFF, at] + words_of(check + data + b"\0" * (len(data) % 2)))

    def put(self, at, data, token=None, key=None):
        """Whether a block was taken."""
        return self.ask(self.window_block(at, data, token, key))[0] == 16

    def write(self, address, data, token=0):
        """Through windows; whether everything was taken."""
        for at in range(0, len(data), WINDOW_BYTES):
            part = data[at:at + WINDOW_BYTES]
            if self.look().window(address + at, len(part), token) != 0:
                return False
            for k in range(0, len(part), BLOCK_BYTES):
                if not self.put(k // BLOCK_BYTES, part[k:k + BLOCK_BYTES]):
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
        state, error, _, _ = self.command(COMMIT, commit(image, token))
        if state != DONE:
            raise RuntimeError("commit: state %d, error %d" % (state, error))

    def memory(self, address, length):
        out = b""
        while len(out) < length:
            n = min(READ_BYTES, length - len(out))
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
